# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev package`: the addon as artists install it, with all libraries, as one zip file."""

from __future__ import annotations

import argparse
import ast
import zipfile
from pathlib import Path

from tools import bundle, setup
from tools.build import build
from tools.common import BUILD, ROOT, DevError

ADDON = ROOT / "addon"
MANIFEST = "blender_manifest.toml"
TIMESTAMP = (1980, 1, 1, 0, 0, 0)  # the first that a zip file can hold: same input, same bytes


def addon_version() -> str:
    """Version in bl_info, such as 0.1.0; the addon is parsed, not imported (that needs Blender)."""
    source = ADDON / "__init__.py"
    if not source.exists():
        raise DevError("there is no addon in addon/")
    for node in ast.parse(source.read_text()).body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        if any(isinstance(target, ast.Name) and target.id == "bl_info" for target in targets):
            return ".".join(str(part) for part in ast.literal_eval(node.value)["version"])
    raise DevError(f"no bl_info in {source.relative_to(ROOT)}")


def contents(libraries: Path) -> dict[str, bytes]:
    """Name in the zip file -> bytes."""
    files = {path.relative_to(ADDON).as_posix(): path for path in ADDON.rglob("*.py")}
    files[MANIFEST] = ADDON / MANIFEST
    files["LICENSE"] = ROOT / "LICENSE"
    found = sorted(libraries.glob("libspecula-*.so"))
    if not found:
        raise DevError(f"there are no libraries in {libraries}")
    shared = bundle.shared_libraries(found)
    files |= {f"lib/{path.name}": path for path in found}
    files |= {f"lib/{name}": path for name, path in shared.items()}
    read = {name: path.read_bytes() for name, path in files.items()}
    read["NOTICE"] = bundle.notice(shared).encode()
    return {f"specula/{name}": data for name, data in read.items()}


def write_zip(target: Path, files: dict[str, bytes]) -> None:
    """Write `files` sorted and without anything that differs between two runs."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, TIMESTAMP)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3  # Unix, which the permissions are written for
            entry.external_attr = (0o755 if name.startswith("specula/lib/") else 0o644) << 16
            archive.writestr(entry, files[name])


def main(argv: list[str]) -> int:
    """Entry of `./dev package`."""
    parser = argparse.ArgumentParser(
        prog="./dev package", description="Zip the addon with its libraries."
    )
    parser.add_argument(
        "--out", type=Path, default=BUILD / "package", metavar="DIR", help="default: build/package"
    )
    folder = parser.parse_args(argv).out
    version = addon_version()
    setup.ensure("package")
    target = folder.resolve() / f"specula-{version}.zip"
    partial = target.with_suffix(".partial")
    write_zip(partial, contents(build("portable")))
    bundle.check(partial)
    partial.replace(target)  # an earlier package stays until this one is known to be whole
    print(target)
    return 0
