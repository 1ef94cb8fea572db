# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev blender` and `./dev bpy`: Blender with the addon enabled from the tree.

The user's own Blender configuration is neither read nor written: each Blender gets private folders
in build/.
"""

from __future__ import annotations

import importlib
import os
import sys
from pathlib import Path

from tools import setup, venvs
from tools.build import build
from tools.common import BUILD, ROOT, DevError

BLENDER = "/usr/bin/blender"
TOOLS = ROOT / "tools"


def scripts_folder(home: Path) -> Path:
    """A Blender scripts folder below `home`, in which the module specula is the tree's addon/."""
    link = home / "scripts" / "addons" / "specula"
    link.parent.mkdir(parents=True, exist_ok=True)
    target = ROOT / "addon"
    if not link.is_symlink() or link.readlink() != target:
        # Renamed into place: another ./dev may be starting Blender at the same moment.
        fresh = link.with_name(f"specula.{os.getpid()}")
        fresh.symlink_to(target)
        fresh.replace(link)
    return home / "scripts"


def given_library_folder() -> Path | None:
    """What SPECULA_LIBRARY_DIR says."""
    given = os.environ.get("SPECULA_LIBRARY_DIR")
    return Path(given) if given else None


def library_folder(quiet: bool = True) -> Path:
    """The native library's folder: the one that is given, or the release build's."""
    return given_library_folder() or build("release", quiet)


def instruction_level() -> str:
    """The instruction level whose library the addon loads on this machine."""
    addons = str(scripts_folder(BUILD / "python") / "addons")
    if addons not in sys.path:
        sys.path.append(addons)
    native = importlib.import_module("specula.native")
    try:
        return native.supported_levels(native.processor_flags(native.CPUINFO.read_text()))[0]
    except native.NativeError as error:
        raise DevError(str(error)) from None


def environment(name: str, libraries: Path) -> dict[str, str]:
    """Environment for a Blender whose private folders are build/`name`/."""
    if not (ROOT / "addon" / "__init__.py").exists():
        raise DevError("there is no addon in addon/")
    home = BUILD / name
    env = dict(os.environ)
    # Each by its own variable: one that the user has set would win over BLENDER_USER_RESOURCES.
    env["BLENDER_USER_RESOURCES"] = str(home)
    env["BLENDER_USER_SCRIPTS"] = str(scripts_folder(home))
    for kind in ("config", "datafiles", "extensions"):
        (home / kind).mkdir(parents=True, exist_ok=True)
        env[f"BLENDER_USER_{kind.upper()}"] = str(home / kind)
    env["SPECULA_LIBRARY_DIR"] = str(libraries)
    return env


def blender_command(arguments: list[str]) -> list[str]:
    """Command line of Debian's Blender, which works through it in order: first the addon."""
    return [BLENDER, "--python", str(TOOLS / "enable_addon.py"), *arguments]


def blender_environment(libraries: Path) -> dict[str, str]:
    """Environment for Debian's Blender."""
    return environment("blender-3.4", libraries)


def bpy_command(script: str, arguments: list[str], version: str = venvs.BPY_VERSION) -> list[str]:
    """Command line that runs `script` with bpy and the addon."""
    return [str(venvs.bpy_python(version)), str(TOOLS / "bpy_bootstrap.py"), script, *arguments]


def bpy_environment(libraries: Path, version: str = venvs.BPY_VERSION) -> dict[str, str]:
    """Environment for PyPI's bpy."""
    return environment(f"bpy-{version}", libraries)


def blender(argv: list[str]) -> int:
    """Entry of `./dev blender`: becomes Blender, so signals and the exit code are Blender's own."""
    setup.ensure("blender")
    command = blender_command(argv)
    os.execve(command[0], command, blender_environment(library_folder()))


def bpy(argv: list[str]) -> int:
    """Entry of `./dev bpy`: becomes the Python that runs the script."""
    version = venvs.BPY_VERSION
    if len(argv) >= 2 and argv[0] == "--version":
        version, argv = argv[1], argv[2:]
    if not argv or argv[0].startswith("-"):
        print("usage: ./dev bpy [--version V] SCRIPT ARGS...")
        return 0 if argv and argv[0] in ("-h", "--help") else 2
    if not Path(argv[0]).is_file():
        raise DevError(f"no script '{argv[0]}'")
    setup.ensure("bpy")
    command = bpy_command(argv[0], argv[1:], version)
    os.execve(command[0], command, bpy_environment(library_folder(), version))
