# SPDX-License-Identifier: GPL-3.0-or-later
"""What every part of `./dev` shares: paths, the error type, running programs."""

from __future__ import annotations

import fcntl
import os
import shlex
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build"
CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "specula"

# Debian's, never the first on PATH: Blender, NumPy and pytest are the packages of this one.
PYTHON = "/usr/bin/python3"


class DevError(Exception):
    """A failure that the user can act on; its text is the one line that is printed."""


def say(text: str) -> None:
    """Tell the user what goes on; standard error, so that output can be piped."""
    print(f"dev: {text}", file=sys.stderr, flush=True)


def run(
    command: Sequence[str | Path],
    what: str,
    env: Mapping[str, str] | None = None,
    quiet: bool = False,
) -> None:
    """Run a program in the project's root, or raise DevError that says `what` failed.

    Its output goes to standard error; with `quiet` it is shown only when the program fails.
    """
    output = (
        {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        if quiet
        else {"stdout": sys.stderr}
    )
    try:
        result = subprocess.run(
            [str(part) for part in command], cwd=ROOT, env=env, text=True, **output
        )
    except FileNotFoundError:
        raise DevError(f"{what}: no program '{command[0]}'") from None
    if result.returncode != 0:
        if quiet:
            sys.stderr.write(result.stdout)
        shown = shlex.join(str(part) for part in command)
        raise DevError(f"{what} failed with exit code {result.returncode}: {shown}")


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold an exclusive lock on `path`: two runs of ./dev must not write to one folder at once."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say(f"waiting for another ./dev that holds {path}")
            fcntl.flock(file, fcntl.LOCK_EX)
        yield
