# SPDX-License-Identifier: GPL-3.0-or-later
"""Set-up: Debian packages that a command needs are installed, and versions verified."""

from __future__ import annotations

import os
import shutil
import subprocess

from tools.common import DevError, run, say

# Package lists by purpose; COMMAND_NEEDS says which command needs which.
PACKAGES = {
    "build": [
        *("g++", "cmake", "ninja-build", "ccache"),
        "make",  # GCC runs the link-time optimiser in parallel through it
        *("libembree-dev", "libopenimageio-dev", "libimath-dev", "libopenexr-dev"),
        "libfmt-dev",
        "openimageio-tools",  # libopenimageio-dev's CMake files insist on its programs
    ],
    # libgl1-mesa-dri: software OpenGL, for machines without a graphics card.
    "blender": ["blender", "python3-numpy", "libgl1-mesa-dri"],
    # The system libraries that PyPI's bpy links but does not bring (found with ldd).
    "bpy": [
        *("python3-venv", "libx11-6", "libxext6", "libxrender1", "libxfixes3", "libxi6"),
        *("libxkbcommon0", "libsm6", "libice6", "libgl1", "libegl1", "libgl1-mesa-dri"),
    ],
    "native tests": ["libgtest-dev", "libgmock-dev"],
    "kernels": ["libbenchmark-dev"],
    # python3-openimageio: reading EXR files in tests that run outside Blender.
    "python tests": [
        *("python3-pytest", "python3-numpy", "python3-openimageio", "openimageio-tools"),
    ],
    "display": ["xvfb", "xauth"],
    "quality": ["python3-venv", "clang-tidy"],
    "header": ["gcc", "python3-pycparser"],  # what reads specula.h
}

COMMAND_NEEDS = {
    "build": ["build"],
    "demo": ["build", "blender"],
    "package": ["build"],
    "blender": ["build", "blender"],
    "bpy": ["build", "bpy"],
    "test native": ["build", "native tests"],
    "test asan": ["build", "native tests"],
    "test tsan": ["build", "native tests"],
    "test fuzz": ["build", "native tests"],
    "test parity": ["build", "blender", "bpy", "python tests"],
    "test addon": ["header", "python tests"],
    "test blender": ["build", "blender", "python tests", "display"],
    "test bpy": ["build", "bpy"],
    "test images": ["build", "blender", "bpy", "python tests"],
    "test instruments": ["build", "blender", "bpy", "python tests", "display"],
    "bench": ["build", "blender", "bpy", "display"],
    "pictures": ["build", "blender", "bpy", "python tests", "display"],
    "stability": ["build", "python tests"],
    "field": ["build", "blender", "bpy", "python tests"],
    "parity": ["build", "blender", "bpy", "python tests"],
    "bench kernels": ["build", "kernels"],
    "coverage": [
        *("build", "header", "native tests", "blender", "python tests", "display", "quality"),
    ],
    "format": ["header", "quality"],
    "lint": ["build", "native tests", "kernels", "quality"],
}

# Results (images, reference values, what an API does) depend on these versions.
VERSIONS = {
    "blender": "3.4.1",
    "libembree-dev": "3.13.5",
    "libopenimageio-dev": "2.4.7",
}

APT_OPTIONS = ["-o", "DPkg::Lock::Timeout=600", "-o", "Acquire::Retries=3"]


def installed_versions(packages: list[str]) -> dict[str, str]:
    """Version of each of `packages` that is installed; the others are left out."""
    query = ["dpkg-query", "-W", "-f", "${db:Status-Status} ${Package} ${Version}\\n", *packages]
    try:
        output = subprocess.run(query, capture_output=True, text=True).stdout
    except FileNotFoundError:
        raise DevError("no dpkg-query: ./dev sets up Debian 12 only") from None
    rows = (line.split() for line in output.splitlines())
    return {row[1]: row[2] for row in rows if row[0] == "installed"}


def install(packages: list[str]) -> None:
    """Install Debian packages with apt-get, as root or through sudo."""
    prefix = ["env", "DEBIAN_FRONTEND=noninteractive"]
    if os.geteuid() != 0:
        if not shutil.which("sudo"):
            raise DevError(
                f"not root and no sudo; run as root: apt-get install {' '.join(packages)}"
            )
        prefix.insert(0, "sudo")
    apt_get = [*prefix, "apt-get", *APT_OPTIONS, "-q"]
    say(f"installing Debian packages: {' '.join(packages)}")
    run([*apt_get, "update"], "apt-get update", quiet=True)
    run(
        [*apt_get, "install", "-y", "--no-install-recommends", *packages],
        "apt-get install",
        quiet=True,
    )


def check_versions(versions: dict[str, str]) -> None:
    """Raise DevError if a package on which results depend has a version that was not tested."""
    for name, wanted in VERSIONS.items():
        # Debian's versions look like [epoch:]upstream[+dfsg]-revision.
        upstream = versions.get(name, wanted).split(":")[-1]
        if not (
            upstream == wanted or upstream.startswith((wanted + ".", wanted + "+", wanted + "-"))
        ):
            raise DevError(f"{name} is {upstream}, but Specula is tested with {wanted} (Debian 12)")


def ensure(*commands: str) -> None:
    """Make sure that all Debian packages that `commands` (keys of COMMAND_NEEDS) need are there."""
    needs = {need for command in commands for need in COMMAND_NEEDS[command]}
    packages = sorted({name for need in needs for name in PACKAGES[need]})
    versions = installed_versions(packages)
    missing = [name for name in packages if name not in versions]
    if missing:
        install(missing)
        versions = installed_versions(packages)
        still = [name for name in missing if name not in versions]
        if still:
            raise DevError(f"apt-get installed no {', '.join(still)}")
    check_versions(versions)
