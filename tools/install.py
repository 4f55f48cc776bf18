"""Fill the virtual environment that runs this file from the lock files (run by `make`; standard library only).

torch comes first and by itself: pip's own choice among the builds it can see, so that a configured CPU build wins
over the CUDA build of the ordinary index, and is refused unless its hash stands in environment.lock. A CUDA build
then gets its libraries from environment-cuda.lock.
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
LOCKED = [*PIP, "install", "--quiet", "--no-deps", "--require-hashes", "-r"]


def install_torch(index: str | None) -> bool:
    """Install the pinned torch, from `index` besides the configured ones; return whether it is a CUDA build."""
    pin = re.search(r"^torch==\S+", LOCK.read_text(), re.MULTILINE).group()
    with tempfile.TemporaryDirectory() as folder:
        extra = ["--extra-index-url", index] if index else []
        subprocess.run([*PIP, "download", "--quiet", "--no-deps", "-d", folder, *extra, pin], check=True)
        wheel = next(Path(folder).iterdir())
        digest = hashlib.sha256(wheel.read_bytes()).hexdigest()
        if f"sha256:{digest}" not in LOCK.read_text():
            sys.exit(f"torch: {wheel.name} has hash {digest}, which environment.lock does not allow")
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
