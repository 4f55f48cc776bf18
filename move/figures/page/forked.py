"""A kernel that is a fork of this process: what is imported and read here need not be imported and read again."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from typing import Any

from jupyter_client.connect import KernelConnectionInfo
from jupyter_client.manager import AsyncKernelManager
from jupyter_client.provisioning.local_provisioner import LocalProvisioner

POSSIBLE = sys.platform == "linux"
"""Elsewhere a forked process may not use the system's libraries."""


class ForkedProcess:
    """A process that runs a kernel, with what its manager asks of a `subprocess.Popen`."""

    stdin = stdout = stderr = None

    def __init__(self, connection_file: str, folder: str) -> None:
        self.returncode: int | None = None
        self.pid = os.fork()
        if not self.pid:
            _run_kernel(connection_file, folder)

    def poll(self) -> int | None:
        """The exit code, or None while it runs."""
        return self._ended(os.WNOHANG)

    def wait(self) -> int | None:
        """The exit code, once it has ended."""
        return self._ended(0)

    def send_signal(self, number: int) -> None:
        """Send a signal, if it runs."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def terminate(self) -> None:
        """Ask it to end."""
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        """End it."""
        self.send_signal(signal.SIGKILL)

    def _ended(self, options: int) -> int | None:
        if self.returncode is None:
            found, status = os.waitpid(self.pid, options)
            if found:
                self.returncode = os.waitstatus_to_exitcode(status)
        return self.returncode


def _run_kernel(connection_file: str, folder: str) -> None:
    """In the fork: be a kernel until it is shut down, and never come back."""
    from ipykernel.kernelapp import IPKernelApp

    try:
        os.setsid()  # what interrupts the command is its manager's to pass on
        os.chdir(folder)
        asyncio.set_event_loop(asyncio.new_event_loop())
        parent = f"--IPKernelApp.parent_handle={os.getppid()}"  # with which it ends
        IPKernelApp.launch_instance(argv=["-f", connection_file, "--log-level=ERROR", parent])
    finally:
        os._exit(0)


class ForkedProvisioner(LocalProvisioner):
    """Starts a kernel by forking."""

    async def launch_kernel(self, cmd: list[str], **kwargs: Any) -> KernelConnectionInfo:
        """Start it; of the command line only the connection file is of use."""
        assert isinstance(self.parent, AsyncKernelManager)
        process = ForkedProcess(self.parent.connection_file, kwargs.get("cwd") or os.getcwd())
        self.process: Any = process
        self.pid, self.pgid = process.pid, None
        return self.connection_info


class ForkedKernel(AsyncKernelManager):
    """Manages a kernel that is a fork of this process."""

    async def _async_pre_start_kernel(self, **kw: Any) -> tuple[list[str], dict[str, Any]]:
        self.provisioner = ForkedProvisioner(kernel_id=self.kernel_id or "", kernel_spec=self.kernel_spec, parent=self)
        return await super()._async_pre_start_kernel(**kw)
