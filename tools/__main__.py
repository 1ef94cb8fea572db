# SPDX-License-Identifier: GPL-3.0-or-later
"""Entry of `./dev`: picks the sub-command and turns errors into one line and an exit code."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path

# Run as a file, not with -m: the user's working directory must neither change nor be on the path.
sys.path[0] = str(Path(__file__).resolve().parent.parent)

from tools.common import DevError  # noqa: E402

# name -> (module, function taking the arguments after the name, what --help says)
COMMANDS = {
    "demo": ("demo", "main", "render blend_scenes/swimming_pool.blend to build/demo/"),
    "test": ("testing", "main", "[--quick | --nightly] [SUITE...]: the tests, and a summary"),
    "coverage": ("coverage", "main", "[SUITE...]: which lines of native/ and addon/ tests run"),
    "bench": (
        "studies",
        "bench",
        "[NAME] ARGS: error against time, or the benchmark tests/instruments/bench/NAME.py",
    ),
    "fuzz": (
        "fuzz",
        "main",
        "[--scenes] [--minutes N]: mutated scenes, or every method on random ones",
    ),
    "stability": ("studies", "stability", "every method in the scenes in which methods fail"),
    "field": (
        "studies",
        "field",
        "DIR...: render every .blend in folders, beside Cycles; --make DIR makes some",
    ),
    "pictures": (
        "pictures",
        "main",
        "[tutorial] [strip] [gallery]: render the pictures of the documentation anew",
    ),
    "parity": (
        "studies",
        "parity",
        "small scenes of each node and setting, beside Cycles; --only PATTERNS, --list",
    ),
    "package": ("package", "main", "zip the addon as artists install it"),
    "blender": ("host", "blender", "ARGS: Debian's Blender with the addon enabled from the tree"),
    "bpy": ("host", "bpy", "[--version V] SCRIPT ARGS: a script in today's Blender, addon enabled"),
    "build": ("build", "main", "[--preset NAME]: compile into build/PRESET"),
    "format": (
        "quality",
        "format_sources",
        "rewrite the sources with clang-format and ruff, and addon/abi.py",
    ),
    "lint": ("quality", "lint", "check the format, clang-tidy, ruff"),
}


def usage() -> str:
    """The text of `./dev --help`."""
    lines = ["usage: ./dev COMMAND [ARGS]   (./dev COMMAND --help tells more)", ""]
    lines += [f"  {name:<10} {text}" for name, (_, _, text) in COMMANDS.items()]
    lines += [
        "",
        "Every command first installs what it needs and is missing: Debian 12's packages, and",
        "Python packages in virtual environments under ${XDG_CACHE_HOME:-~/.cache}/specula.",
        "",
        "Environment:",
        "  SPECULA_LIBRARY_DIR  use the libraries in this folder instead of building build/release",
    ]
    return "\n".join(lines)


def main(argv: list[str]) -> int:
    """Run one sub-command; returns the process's exit code."""
    if not argv or argv[0] in ("-h", "--help", "help"):
        print(usage())
        return 0 if argv else 2
    if argv[0] not in COMMANDS:
        raise DevError(f"unknown command '{argv[0]}'; ./dev --help lists them")
    module, function, _ = COMMANDS[argv[0]]
    return getattr(import_module(f"tools.{module}"), function)(argv[1:])


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except DevError as error:
        print(f"dev: error: {error}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        sys.exit(130)
