"""What this machine has and how it is used: GL, device, precision, threads, memory, processor.

torch is imported only by the functions that need it, so that importing the package stays quick.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import importlib
import importlib.util
import os
import platform
import resource
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

THREAD_VARIABLES = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "LP_NUM_THREADS")
NO_GL = ("disable", "disabled", "off", "false", "0")  # values of MUJOCO_GL that turn images off in MuJoCo
SCREEN_GL = ("glfw", "glx", "enable", "enabled", "on", "true", "1", "")  # those that need a screen, on Linux
GL_LIBRARIES = {"egl": ("EGL", "OpenGL GLESv2"), "osmesa": ("OSMesa",)}  # what PyOpenGL opens; one of two does
DEBIAN = "apt-get install libegl1 libopengl0 (Debian)"
REFUSED_GL = "MOVE_REFUSED_GL"  # why images are off that were asked for, to this process and those it starts
M_TRIM_THRESHOLD, M_MMAP_MAX = -1, -4  # of glibc's malloc.h
PR_SET_PDEATHSIG = 1  # of Linux's prctl.h


# GL ------------------------------------------------------------------------------------------------------------------


def choose_gl() -> None:
    """Choose a way to render without a screen; an explicit MUJOCO_GL is left alone, unless it cannot work.

    MuJoCo reads the choice when it is imported, so if it was imported before, it is made to read it again. With one
    that cannot work the import itself fails, so images are off then, and `gl_problem` says why.
    """
    if problem := _refused_gl():
        os.environ |= {REFUSED_GL: problem, "MUJOCO_GL": "disable"}
    if sys.platform == "linux" and "MUJOCO_GL" not in os.environ:
        os.environ["MUJOCO_GL"] = next((name for name in GL_LIBRARIES if not _missing(name)), "disable")
        load_gl()
    if _chosen_gl() == "egl":
        os.environ.setdefault("PYOPENGL_PLATFORM", "egl")


@contextmanager
def without_gl() -> Iterator[None]:
    """While modules are imported whose process will be forked: MuJoCo's import opens a display that no fork can use."""
    chosen = os.environ.get("MUJOCO_GL")
    os.environ["MUJOCO_GL"] = "disable"
    try:
        yield
    finally:
        os.environ.pop("MUJOCO_GL")
        if chosen is not None:
            os.environ["MUJOCO_GL"] = chosen


def load_gl() -> None:
    """Open, in a fork, what was left out there."""
    if "mujoco.gl_context" in sys.modules:
        importlib.reload(sys.modules["mujoco.gl_context"])


def gl_problem() -> str | None:
    """One line that says why images cannot be rendered and which package mends it; None when they can."""
    if sys.platform != "linux" or _chosen_gl() not in NO_GL:
        return None
    if refused := os.environ.get(REFUSED_GL):
        return refused
    found = "no GL library found" if len(_missing("egl")) != 1 else f"GL library lib{_missing('egl')[0]} not found"
    return f"{found}: {DEBIAN} or use macOS's own; keypoint work goes on without"


def _refused_gl() -> str:
    """Why the GL that the environment asks for cannot be had; empty where it can, or none is asked for."""
    chosen, platform = _chosen_gl(), os.environ.get("PYOPENGL_PLATFORM", "")
    if sys.platform != "linux" or chosen in NO_GL:
        return ""
    if chosen not in (*GL_LIBRARIES, *SCREEN_GL):
        return f"MUJOCO_GL: {chosen[:60]!r} given; allowed are egl, osmesa, glfw and disable"
    if missing := _missing(chosen):
        return (f"MUJOCO_GL: {chosen} given, whose library is not installed (lib{missing[0]}); "
                "allowed is another, or none")
    if "MUJOCO_GL" in os.environ and chosen in SCREEN_GL and not os.environ.keys() & {"DISPLAY", "WAYLAND_DISPLAY"}:
        return f"MUJOCO_GL: {chosen!r} given, which needs a screen; allowed without one are egl and osmesa"
    there = chosen or next((name for name in GL_LIBRARIES if not _missing(name)), "")
    if platform and there in GL_LIBRARIES and platform != there:
        return f"PYOPENGL_PLATFORM: {platform[:60]!r} given; allowed is {there}, or none"
    return ""


def _missing(gl: str) -> list[str]:
    """The libraries that a way to render lacks on this machine; those of a screen are not looked for."""
    wanted = [names.split() for names in GL_LIBRARIES.get(gl, ())]
    return [names[0] for names in wanted if not any(map(ctypes.util.find_library, names))]


def _chosen_gl() -> str:
    """MUJOCO_GL as MuJoCo reads it."""
    return os.environ.get("MUJOCO_GL", "").lower().strip()


@cache
def before_drawing() -> None:
    """Import triton, which CUDA builds of torch bring: once Mesa has loaded its own LLVM that import would crash."""
    if importlib.util.find_spec("triton"):
        importlib.import_module("triton")


def gl_renderer() -> str:
    """The GL renderer's own name, for provenance ("none" without GL); llvmpipe means rendered in software."""
    if gl_problem():
        return "none"
    from mujoco import gl_context
    from OpenGL import GL

    before_drawing()
    context = gl_context.GLContext(16, 16)
    context.make_current()
    try:
        return GL.glGetString(GL.GL_RENDERER).decode()
    finally:
        context.free()


# what computes -------------------------------------------------------------------------------------------------------


def best_device() -> str:
    """"cuda" where torch finds a GPU, else "cpu"."""
    import torch

    return "cuda" if torch.cuda.is_available() else "cpu"


def precision_used(wanted: str, device: str = "cpu") -> str:
    """bfloat16 only if it is wanted and the processor multiplies it itself; else float32."""
    import torch

    if device == "cpu":
        able = torch.cpu.get_capabilities()
        native = able.get("avx512_bf16", False) or able.get("amx_bf16", False)
    else:
        native = torch.cuda.is_bf16_supported(including_emulation=False)
    return "bfloat16" if wanted == "bfloat16" and native else "float32"


@cache
def processor() -> str:
    """The processor's name."""
    try:
        with open("/proc/cpuinfo") as lines:
            return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def cpu_capability() -> str:
    """The instructions that torch computes with on this processor, such as AVX512; others round differently."""
    import torch

    return torch.backends.cpu.get_cpu_capability()


def accelerator() -> str:
    """The name of the GPU that training uses, or "none"."""
    import torch

    return torch.cuda.get_device_name() if torch.cuda.is_available() else "none"


def default_workers() -> int:
    """One a core; on a machine with GPUs one a GPU."""
    import torch

    return torch.cuda.device_count() or os.cpu_count() or 1


# standard streams ----------------------------------------------------------------------------------------------------


def fill_closed_streams() -> None:
    """Open /dev/null in the place of each standard stream that was closed by whoever started this process.

    A file opened later would get its number, and whatever is written to that; glfw fails to import without them.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # the lowest number that is free


# processes -----------------------------------------------------------------------------------------------------------


def end_with(parent: int) -> None:
    """End this process as soon as the one that started it is gone, however it went; Ctrl-C is that one's to handle.

    On Linux the kernel kills it at once, when the thread that started it ends; everywhere a thread looks once a second.

    Args:
        parent: the process id of the one that started it, which may be gone already.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    if os.getppid() != parent:
        os._exit(1)
    threading.Thread(target=watch, daemon=True).start()


# threads and memory --------------------------------------------------------------------------------------------------


def one_thread_in_children() -> None:
    """Let processes started from here compute on one thread each, unless the environment says otherwise."""
    for name in THREAD_VARIABLES:
        os.environ.setdefault(name, "1")


def one_thread() -> None:
    """Compute on one thread: with networks this small several wait for each other, on a busy machine for minutes."""
    import torch

    torch.set_num_threads(1)


def keep_freed_memory() -> None:
    """Ask glibc to hold on to what tensors free: else each step fetches it anew, a quarter of the time with images."""
    try:
        library = ctypes.CDLL(None)
        library.mallopt(M_MMAP_MAX, 0)
        library.mallopt(M_TRIM_THRESHOLD, 2**31 - 1)
    except (OSError, AttributeError, TypeError):  # another C library: slower, nothing else
        return


def peak_memory_mb() -> float:
    """The largest resident size of this process so far, in megabytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3)
