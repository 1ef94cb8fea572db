# SPDX-License-Identifier: GPL-3.0-or-later
"""The shared libraries that a package brings along, and their licences."""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
import zipfile
from collections.abc import Iterable
from pathlib import Path

from tools.common import DevError

# On every Linux desktop, and in Blender's process already: GCC's and the C library's. Sonames.
BASE = re.compile(r"(linux-vdso|ld-linux-x86-64|lib(c|m|dl|rt|pthread|gcc_s|stdc\+\+))\.so\.\d+")
LDD_LINE = re.compile(r"\s*(?P<name>\S+) (=> (?P<path>.+) )?(\(0x[0-9a-f]+\)|=> not found)")

# Packages whose headers are compiled into the core.
HEADERS_FROM = ("libimath-dev",)
COPYRIGHT = "/usr/share/doc/{package}/copyright"
LICENCES = Path("/usr/share/common-licenses")

NOTICE = """Specula is free software under the terms in LICENSE. This package also contains,
unchanged from Debian 12 (x86-64), in the folder lib, or compiled into the core:

{contents}

Their sources and build instructions are Debian's source packages of these versions. What Debian
says of their authors and licences follows.
"""


def needed(library: Path) -> dict[str, Path | None]:
    """What `library` needs beyond BASE, directly or not: soname -> where it is found, or None."""
    env = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
    result = subprocess.run(["ldd", library], env=env, capture_output=True, text=True)
    if result.returncode != 0:
        raise DevError(f"ldd {library}: {result.stderr.strip()}")
    found = {}
    for line in result.stdout.splitlines():
        match = LDD_LINE.fullmatch(line)
        if not match:
            raise DevError(f"ldd {library}: cannot read '{line.strip()}'")
        name = Path(match["name"]).name
        if not BASE.fullmatch(name):
            found[name] = Path(match["path"]) if match["path"] else None
    return found


def shared_libraries(libraries: Iterable[Path]) -> dict[str, Path]:
    """All that `libraries` need beyond BASE: soname -> file."""
    found = {}
    for library in libraries:
        for name, path in needed(library).items():
            if path is None:
                raise DevError(f"{library.name} needs {name}, which is not installed")
            found[name] = path.resolve()
    return found


def _dpkg_query(*arguments: str) -> str:
    result = subprocess.run(["dpkg-query", *arguments], capture_output=True, text=True)
    if result.returncode != 0:
        raise DevError(f"dpkg-query {' '.join(arguments)}: {result.stderr.strip()}")
    return result.stdout


def notice(shared: dict[str, Path]) -> str:
    """Packages, versions and licences of bundled files (soname -> file) and of HEADERS_FROM."""
    contents, copyrights = [], []
    for name, path in [*sorted(shared.items()), *((None, package) for package in HEADERS_FROM)]:
        package = _dpkg_query("-S", str(path)).split(":")[0] if name else path
        version = _dpkg_query("-W", "-f", "${source:Package} ${source:Version}", package)
        contents.append(f"  {name or 'headers of ' + package}: source package {version}")
        copyrights.append((package, Path(COPYRIGHT.format(package=package)).read_text()))
    parts = [NOTICE.format(contents="\n".join(contents))]
    parts += [f"{'=' * 78}\n{package}\n{'=' * 78}\n{text}" for package, text in copyrights]
    # Debian's texts refer to the licences that it keeps in one place.
    referred = set(re.findall(rf"{LICENCES}/([\w.-]*\w)", "".join(parts)))
    parts += [
        f"{'=' * 78}\n{name}\n{'=' * 78}\n{(LICENCES / name).read_text()}"
        for name in sorted(referred)
    ]
    return "\n".join(parts)


def check(archive: Path) -> None:
    """Raise DevError if a library in the zip file needs one that is neither there nor in BASE."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder).resolve()
        with zipfile.ZipFile(archive) as content:
            content.extractall(root)
        for library in sorted(root.glob("*/lib/libspecula-*.so")):
            for name, path in needed(library).items():
                if path is None or not path.resolve().is_relative_to(root):
                    raise DevError(f"{archive.name}: {library.name} finds {name} at {path}")
