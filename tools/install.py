"""Fill the virtual environment that runs this file from the lock files (run by `make`; standard library only).

torch comes first and by itself: pip's own choice among the builds it can see, so that a configured CPU build wins
over the CUDA build of the ordinary index, and is refused unless its hash is one that environment.lock gives torch. A
CUDA build then gets its libraries from environment-cuda.lock. Wheels alone are fetched: a source distribution's code
would run before its hash is looked at.
"""

import hashlib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LOCK = ROOT / "environment.lock"
PIP = [sys.executable, "-m", "pip"]
WHEELS = ["--only-binary", ":all:"]
LOCKED = [*PIP, "install", "--quiet", "--no-deps", *WHEELS, "--require-hashes", "-r"]


def locked_torch() -> tuple[str, set[str]]:
    """The pin of torch and the sha256 hashes that are its own, from environment.lock."""
    pin, block = re.search(r"^(torch==\S+)((?:.*\\\n)*.*)", LOCK.read_text(), re.MULTILINE).groups()
    return pin, set(re.findall(r"--hash=sha256:([0-9a-f]{64})", block))


def install_torch(index: str | None) -> bool:
    """Install the pinned torch, from `index` besides the configured ones; return whether it is a CUDA build."""
    pin, allowed = locked_torch()
    with tempfile.TemporaryDirectory() as folder:
        extra = ["--extra-index-url", index] if index else []
        subprocess.run([*PIP, "download", "--quiet", "--no-deps", *WHEELS, "-d", folder, *extra, pin], check=True)
        wheel = next(Path(folder).iterdir())
        digest = hashlib.sha256(wheel.read_bytes()).hexdigest()
        if digest not in allowed:
            sys.exit(f"torch: {wheel.name} has hash {digest}, which is none of torch's in environment.lock")
        subprocess.run([*PIP, "install", "--quiet", "--no-deps", str(wheel)], check=True)
        return sys.platform == "linux" and "+cpu" not in wheel.name


def main() -> None:
    """Install torch, the rest of the lock, and this package itself in place."""
    print("setting up .venv from environment.lock (once; a few minutes)", flush=True)
    cuda = install_torch(os.environ.get("TORCH_INDEX"))
    subprocess.run([*LOCKED, str(LOCK)], check=True)
    if cuda:
        subprocess.run([*LOCKED, str(ROOT / "environment-cuda.lock")], check=True)
    subprocess.run([*PIP, "install", "--quiet", "--no-deps", "--no-build-isolation", "-e", str(ROOT)], check=True)


if __name__ == "__main__":
    main()
