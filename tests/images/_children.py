# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders in a child process: Debian's Blender or today's."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.images._cases import Case
from tools.common import ROOT

SCRIPT = ROOT / "tests" / "images" / "_render.py"
COMMANDS = {
    "blender": ["blender", "--background", "--python-exit-code", "1", "--python", str(SCRIPT)],
    "bpy": ["bpy", str(SCRIPT)],
}
CHILD_SECONDS = 20 * 60  # a child that hangs must not hold up a machine for ever
SHOWN_LINES = 8  # of the log of a child that failed


@dataclass(frozen=True)
class Image:
    """A render: (H, W, 3) float64 arrays, bottom row first."""

    mean: np.ndarray
    variance: np.ndarray  # of the mean
    caustics: np.ndarray | None  # share of `mean`, as the pass has it; None from Cycles
    stats: dict  # of the session; `seconds`

    @property
    def samples(self) -> float:
        """Per pixel."""
        height, width, _ = self.mean.shape
        return self.stats["samples"] / (height * width)


@dataclass(frozen=True)
class Result:
    images: dict[str, Image]
    scene_arrays: dict[str, np.ndarray]


def render(
    host: str,
    case: Case,
    renders: dict[str, dict],
    folder: Path,
    scene_arrays: bool = False,
    show: bool = False,
) -> Result:
    """Renders of one scene in the Blender `host` (of COMMANDS); see _render.py for `renders`.

    The child's files are left in `folder`; `show` lets its output through. Raises RuntimeError
    with the end of its output if it fails.
    """
    result = folder / f"{host}-{case.name}.npz"
    job_file = result.with_suffix(".json")
    job = {
        "scene": str(ROOT / "blend_scenes" / f"{case.name}.blend"),
        "size": case.size,
        "light_factor": case.light_factor,
        "sun": case.sun,
        "texels": case.texels,
        "glints": case.glints,
        "renders": renders,
        "scene_arrays": scene_arrays,
        "result": str(result),
    }
    job_file.write_text(json.dumps(job))
    command = [str(ROOT / "dev"), *COMMANDS[host]]
    command += ["--", str(job_file)] if host == "blender" else [str(job_file)]
    child = subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        stdout=None if show else subprocess.PIPE,
        stderr=None if show else subprocess.STDOUT,
        text=True,
        errors="replace",
        timeout=CHILD_SECONDS,
    )
    if child.returncode != 0 or not result.exists():
        end = "\n".join((child.stdout or "").strip().splitlines()[-SHOWN_LINES:])
        raise RuntimeError(f"{case.name} in {host}: exit code {child.returncode}\n{end}")
    return load(result)


def load(path: Path) -> Result:
    with np.load(path) as file:
        arrays = dict(file)
    scene_arrays = {key: arrays.pop(key) for key in list(arrays) if key.startswith("SCENE/")}
    images = {}
    for name in dict.fromkeys(key.rpartition("/")[0] for key in arrays):
        images[name] = Image(
            arrays[f"{name}/mean"],
            arrays[f"{name}/variance"],
            arrays.get(f"{name}/caustics"),
            json.loads(str(arrays[f"{name}/stats"])),
        )
    return Result(images, scene_arrays)
