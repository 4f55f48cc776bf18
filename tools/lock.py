"""Write environment.lock and environment-cuda.lock from pyproject.toml (run by `make lock`; needs `uv` and `pip`).

And, with the same versions, tests/environments/requirements.txt: what its requirements.in needs besides the lock.

environment.lock pins every package with hashes and is installed with `pip install --no-deps --require-hashes`.
It accepts both builds of torch: the one on the ordinary index (CUDA on Linux) and the CPU build that pip finds
here. The CUDA libraries, several gigabytes, stand alone in environment-cuda.lock, which `make` installs only
next to a CUDA build of torch. One version of a package holds for every Python, unless it has no wheel for one of them.

pip's format has hashes without the names of the files, so the names of the wheels that fit the supported Pythons and
platforms stand below each package's hashes as comments: a test selects one of every package from them.
"""

import hashlib
import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CUDA = re.compile(r"^(nvidia-|cuda-|triton==)")
FITTING = re.compile(r"-(py2\.py3|py3|cp3\d+-abi3|cp31[123]-cp31[123])\b.*-(any|.*manylinux\S*_(x86_64|aarch64)\S*|"
                     r"macosx\S*_(arm64|universal2))\.whl$")
"""Names of wheels for Python 3.11 to 3.13 on Linux (x86_64, aarch64) and macOS (arm64)."""
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


def wheel_names(blocks: list[str]) -> dict[str, str]:
    """File name of each wheel of these pins on the ordinary index, by "sha256:" and its hash."""
    with tempfile.TemporaryDirectory() as folder:
        pins, out = Path(folder, "pins.txt"), Path(folder, "pylock.toml")
        pins.write_text("\n".join(blocks))
        command = ["uv", "pip", "compile", str(pins), "--no-deps", "--universal", "--python-version", "3.11", "--quiet",
                   "--output-file", str(out)]
        subprocess.run(command, cwd=ROOT, check=True)
        packages = tomllib.loads(out.read_text())["packages"]
        wheels = [wheel for package in packages for wheel in package.get("wheels", [])]
    return {f"sha256:{wheel['hashes']['sha256']}": wheel["url"].rpartition("/")[2] for wheel in wheels}


def with_names(block: str, names: dict[str, str]) -> str:
    """A block with the names of its fitting wheels below, as comments."""
    own = sorted(names.get(digest, "") for digest in re.findall(r"sha256:[0-9a-f]{64}", block))
    return "\n".join([block, *(f"    # {name}" for name in own if FITTING.search(name))])


def local_torch(pin: str) -> tuple[str, str]:
    """Hash and name of the torch wheel that pip would take on this machine (the CPU build where one is configured)."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--only-binary", ":all:", "-d",
                        folder, pin], check=True)
        wheel = next(Path(folder).iterdir())
        return "sha256:" + hashlib.sha256(wheel.read_bytes()).hexdigest(), wheel.name


def main() -> None:
    """Write the two lock files next to pyproject.toml."""
    blocks = resolve()
    names = wheel_names(blocks)
    for number, block in enumerate(blocks):
        if block.startswith("torch=="):
            extra, name = local_torch(block.split()[0])
            if extra not in names:
                blocks[number] = f"{block} \\\n    --hash={extra}"
                names[extra] = name
    for name, wanted in (("environment.lock", False), ("environment-cuda.lock", True)):
        kept = [with_names(block, names) for block in blocks if bool(CUDA.match(block)) is wanted]
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
