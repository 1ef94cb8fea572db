# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev demo`: from a fresh checkout to a picture."""

from __future__ import annotations

import argparse
import math
import os
import re
import subprocess
import sys
import time
from pathlib import Path

from tools import build, host, setup
from tools.common import BUILD, ROOT, DevError, say

SCENE = ROOT / "blend_scenes" / "swimming_pool.blend"
FOLDER = BUILD / "demo"
PICTURE = FOLDER / "swimming_pool_0001.png"
LOG = FOLDER / "swimming_pool.log"
# The picture is small so that two cores, too, take many samples of each pixel while the whole
# stays under a minute. A machine that takes all samples is done sooner.
RENDER_SECONDS = 45
RESOLUTION = 67  # % of the scene's 960 x 540
SAMPLES = 1024
# Of a processor, for each command that compiles or links the core: a little more than its mean on a
# small virtual machine (118 s for 152 of them on two).
COMPILE_SECONDS = 2.0
SECONDS_BETWEEN_LINES = 5.0  # where standard error is no terminal


SETTINGS = f"""
import bpy
scene = bpy.context.scene
scene.specula.time_limit, scene.specula.samples = {RENDER_SECONDS}, {SAMPLES}
scene.render.resolution_percentage = {RESOLUTION}
"""


class Progress:
    """Blender's "Fra:1 Mem:... | Time:... | text" lines as one line that changes.

    Where standard error is no terminal, a line now and then.
    """

    def __init__(self) -> None:
        self.terminal = sys.stderr.isatty()
        self.start = time.monotonic()
        self.printed = -SECONDS_BETWEEN_LINES

    def show(self, line: str) -> None:
        """Take in one line of Blender's output."""
        match = re.match(r"Fra:\d+ .*?\| (?:Time:\S+ \| )?(?P<text>.*)", line)
        if not match:
            return
        elapsed = time.monotonic() - self.start
        text = match["text"].strip()
        if self.terminal:
            sys.stderr.write(f"\r\x1b[K{text[:100]}")
            sys.stderr.flush()
        elif elapsed - self.printed >= SECONDS_BETWEEN_LINES:
            self.printed = elapsed
            say(text)

    def end(self) -> None:
        """Leave the changing line."""
        if self.terminal:
            sys.stderr.write("\r\x1b[K")
        say(f"Blender ran for {time.monotonic() - self.start:.1f} s")


def render(scene: Path, libraries: Path) -> int:
    """Render frame 1 of `scene` to PICTURE, Blender's output to LOG; returns the exit code."""
    arguments = ["--background", str(scene), "-E", "SPECULA", "--python-expr", SETTINGS]
    arguments += ["-o", str(FOLDER / "swimming_pool_"), "-F", "PNG", "-f", "1"]
    progress = Progress()
    with (
        open(LOG, "w") as log,
        subprocess.Popen(
            host.blender_command(arguments),
            env=host.blender_environment(libraries),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
        ) as process,
    ):
        for line in process.stdout:
            log.write(line)
            progress.show(line)
    progress.end()
    return process.returncode


def compile_core() -> Path:
    """The core for this machine's processor alone; returns the library's folder."""
    level = host.instruction_level()
    target = f"specula-{level}"
    steps, processors = build.steps("release", target), os.cpu_count() or 1
    if steps:
        minutes = math.ceil(steps * COMPILE_SECONDS / processors / 60)
        say(
            f"step 2 of 3: compiling the core for this processor ({level}), {steps} commands, "
            f"about {minutes} min on {processors} processors, once"
        )
    else:
        say(f"step 2 of 3: the core for this processor ({level}) is compiled")
    return build.build("release", target=target)


def main(argv: list[str]) -> int:
    """Entry of `./dev demo`."""
    description = (
        "Render a swimming pool with Specula; the last line printed is the picture's path."
    )
    argparse.ArgumentParser(prog="./dev demo", description=description).parse_args(argv)
    if not SCENE.exists():
        raise DevError(f"there is no {SCENE.relative_to(ROOT)}")
    say("step 1 of 3: Debian's packages, Blender among them; a few minutes the first time")
    setup.ensure("demo")
    libraries = host.given_library_folder() or compile_core()
    say(f"step 3 of 3: rendering {SCENE.name} for {RENDER_SECONDS} s")
    FOLDER.mkdir(parents=True, exist_ok=True)
    PICTURE.unlink(missing_ok=True)  # an old picture must not pass for a new one
    code = render(SCENE, libraries)
    if code != 0 or not PICTURE.exists():
        sys.stderr.writelines(LOG.read_text().splitlines(keepends=True)[-25:])
        wrote = "a" if PICTURE.exists() else "no"
        raise DevError(
            f"Blender wrote {wrote} picture, exit code {code}; all of its output is in {LOG}"
        )
    print(PICTURE)
    return 0
