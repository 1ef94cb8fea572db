# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev pictures`: the pictures of README.md, docs/gallery.md and docs/tutorial.md."""

from __future__ import annotations

import argparse
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

from tools import host, setup
from tools.common import BUILD, ROOT, DevError, say

HERE = Path(__file__).parent
IMAGES = ROOT / "docs" / "images"
WORK = BUILD / "pictures"  # jobs, logs, the tutorial's scenes
BLENDS = ROOT / "blend_scenes"
TUTORIAL = ("glass", "pool", "shoe")
SETS = ("tutorial", "strip", "gallery")  # in the order in which they are made
CHILD_SECONDS = 30 * 60  # a child that hangs must not hold up a machine for ever
SCREEN = "1280x800x24"
DISPLAY = ("xvfb-run", "-a", "-s", f"-screen 0 {SCREEN}")

STRIP_SIDE = 320  # pixels
STRIP_SECONDS = 30.0
GALLERY_WIDTH = 360  # pixels
GALLERY_SAMPLES = 64


@dataclass(frozen=True)
class Part:
    """A square of a scene's picture for the strip; shares are from the left and from below."""

    scene: Path
    aspect: float = 1.0  # width over height of the whole picture
    left: float = 0.0
    bottom: float = 0.0
    side: float = 1.0  # of the square, as a share of the height

    def job(self) -> dict:
        height = round(STRIP_SIDE / self.side)
        width = round(height * self.aspect)
        left, bottom = round(self.left * width), round(self.bottom * height)
        border = [left, bottom, left + STRIP_SIDE, bottom + STRIP_SIDE]
        return {"scene": str(self.scene), "size": [width, height], "border": border}


STRIP = {
    "pool": Part(BLENDS / "swimming_pool.blend", 16 / 9, 0.06, 0.0),
    "glass": Part(WORK / "glass.blend", 16 / 9, 0.12, 0.0),
    "ring": Part(BLENDS / "ring.blend"),
    "glitter": Part(BLENDS / "shoes.blend", 1.0, 0.2, 0.18, 0.65),
}
ENGINES = ("CYCLES", "SPECULA")


def run(name: str, command: list[str], environment: dict[str, str]) -> None:
    """Run a child; its output goes to WORK/name.log. Raises DevError if it fails."""
    log = WORK / f"{name}.log"
    say(f"{name} ...")
    with open(log, "w") as output:
        try:
            code = subprocess.run(
                command,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                timeout=CHILD_SECONDS,
            ).returncode
        except subprocess.TimeoutExpired:
            code = None
    if code != 0:
        raise DevError(f"{name}: exit code {code}; its output is in {log}")


def render(name: str, job: dict) -> None:
    """Render in today's Blender what `job` says (_render_job.py)."""
    file = WORK / f"{name}.json"
    file.write_text(json.dumps(job))
    environment = host.bpy_environment(host.library_folder())
    run(name, host.bpy_command(str(HERE / "_render_job.py"), [str(file)]), environment)


def make_strip() -> None:
    """Each scene by Cycles and by Specula, in the same time."""
    for name, part in STRIP.items():
        if not part.scene.exists():
            raise DevError(f"there is no {part.scene}: make the tutorial's pictures first")
        for engine in ENGINES:
            picture = IMAGES / "strip" / f"{name}_{engine.lower()}.jpg"
            more = {"engine": engine, "seconds": STRIP_SECONDS, "picture": str(picture)}
            render(picture.stem, part.job() | more)


def make_gallery() -> None:
    """Each example scene by Specula, at its own shape."""
    for scene in sorted(BLENDS.glob("*.blend")):
        picture = IMAGES / "gallery" / f"{scene.stem}.jpg"
        job = {"scene": str(scene), "engine": "SPECULA", "samples": GALLERY_SAMPLES}
        render(f"gallery_{scene.stem}", job | {"width": GALLERY_WIDTH, "picture": str(picture)})


def make_tutorial() -> None:
    """Screenshots of Debian's Blender while it goes through the tutorial, and its scenes."""
    for name in TUTORIAL:
        script = ["--window-geometry", "0", "0", *SCREEN.split("x")[:2]]
        script += ["--python", str(HERE / "_tutorial_job.py"), "--", name]
        script += [str(IMAGES / "tutorial"), str(WORK)]
        environment = host.blender_environment(host.library_folder())
        run(f"tutorial_{name}", [*DISPLAY, *host.blender_command(script)], environment)


def main(argv: list[str]) -> int:
    """Entry of `./dev pictures`."""
    parser = argparse.ArgumentParser(prog="./dev pictures", description=__doc__)
    parser.add_argument("sets", nargs="*", metavar="SET", help=f"of: {' '.join(SETS)} (all)")
    wanted = parser.parse_args(argv).sets or SETS
    if unknown := set(wanted) - set(SETS):
        parser.error(f"no set {' '.join(sorted(unknown))}; there are: {' '.join(SETS)}")
    setup.ensure("pictures")
    WORK.mkdir(parents=True, exist_ok=True)
    makers = {"tutorial": make_tutorial, "strip": make_strip, "gallery": make_gallery}
    for name in SETS:
        if name in wanted:
            (IMAGES / name).mkdir(parents=True, exist_ok=True)
            makers[name]()
    return 0
