"""Write environment.lock and environment-cuda.lock from pyproject.toml (run by `make lock`; needs `uv` and `pip`).

And, with the same versions, tests/environments/requirements.txt: what its requirements.in needs besides the lock.

environment.lock pins every package with hashes and is installed with `pip install --no-deps --require-hashes`.
It accepts both builds of torch: the one on the ordinary index (CUDA on Linux) and the CPU build that pip finds
here. The CUDA libraries, several gigabytes, stand alone in environment-cuda.lock, which `make` installs only
next to a CUDA build of torch.
"""

import hashlib
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CUDA = re.compile(r"^(nvidia-|cuda-|triton==)")
HEADER = "# Written by `make lock` from pyproject.toml; do not edit.\n"
ENVIRONMENTS = "tests/environments/requirements"
UNUSED = re.compile(r"^(daqp|evdev|imageio-ffmpeg|mink|pynput|pyobjc\S*|python-xlib|qpsolvers)==")
"""What robosuite names for keyboards and whole-body control, and gym-aloha for films, which no test needs."""


def resolve(source: str = "pyproject.toml", *options: str) -> list[str]:
    """Resolve a file of requirements on the ordinary index: one text block a package, pin and hashes."""
    with tempfile.NamedTemporaryFile(suffix=".txt") as out:
        command = ["uv", "pip", "compile", source, "--universal", "--python-version", "3.11", "--no-header",
                   "--generate-hashes", "--no-annotate", "--upgrade", "--quiet", "--output-file", out.name, *options]
        subprocess.run(command, cwd=ROOT, check=True)
        return re.split(r"\n(?=\S)", Path(out.name).read_text().strip())


def local_torch_hash(pin: str) -> str:
    """Hash of the torch wheel that pip would take on this machine (the CPU build where one is configured)."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--only-binary", ":all:", "-d",
                        folder, pin], check=True)
        wheel = next(Path(folder).iterdir())
        return "sha256:" + hashlib.sha256(wheel.read_bytes()).hexdigest()


def main() -> None:
    """Write the two lock files next to pyproject.toml."""
    blocks = resolve()
    for number, block in enumerate(blocks):
        if block.startswith("torch=="):
            extra = local_torch_hash(block.split()[0])
            if extra not in block:
                blocks[number] = f"{block} \\\n    --hash={extra}"
    for name, wanted in (("environment.lock", False), ("environment-cuda.lock", True)):
        kept = [block for block in blocks if bool(CUDA.match(block)) is wanted]
        (ROOT / name).write_text(HEADER + "\n".join(kept) + "\n")
    write_environments()


def write_environments() -> None:
    """Write what the environments of other packages need besides environment.lock."""
    locked = {line.split("==")[0] for line in (ROOT / "environment.lock").read_text().splitlines() if "==" in line}
    more = [block for block in resolve(f"{ENVIRONMENTS}.in", "--constraint", "environment.lock")
            if block.split("==")[0] not in locked and not UNUSED.match(block)]
    header = HEADER.replace("pyproject.toml", "requirements.in")
    (ROOT / f"{ENVIRONMENTS}.txt").write_text(header + "\n".join(more) + "\n")


if __name__ == "__main__":
    main()
