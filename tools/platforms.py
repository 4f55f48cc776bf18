"""Check that every package of environment.lock has a wheel on each platform (run by `make lock`; needs `uv`).

What was found is written to environment-platforms.json, with the digest of the lock that it was found for.
"""

import hashlib
import json
import os
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LOCK = ROOT / "environment.lock"
FOUND = ROOT / "environment-platforms.json"
PLATFORMS = {
    "Linux x86-64, glibc 2.28": ("x86_64-manylinux_2_28", {}),
    "Linux arm64, glibc 2.28": ("aarch64-manylinux_2_28", {}),
    "macOS 14 arm64": ("aarch64-apple-darwin", {"MACOSX_DEPLOYMENT_TARGET": "14.0"}),
}


def digest() -> str:
    """The sha256 of environment.lock."""
    return hashlib.sha256(LOCK.read_bytes()).hexdigest()


def problem(platform: str, variables: dict[str, str]) -> str:
    """Why the lock cannot be installed from wheels on a platform; empty where it can."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["uv", "pip", "install", "--dry-run", "--quiet", "--no-deps", "--require-hashes", "--only-binary",
                   ":all:", "--python-version", "3.11", "--python-platform", platform, "--target", folder, "-r", LOCK]
        done = subprocess.run(command, env=os.environ | variables, capture_output=True, text=True)
    return " ".join(done.stderr.split()) if done.returncode else ""


def main() -> None:
    """Write environment-platforms.json: platform -> "installs", or what is missing."""
    found = {name: problem(*how) or "installs" for name, how in PLATFORMS.items()}
    FOUND.write_text(json.dumps({"lock": digest(), "platforms": found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
