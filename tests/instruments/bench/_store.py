# SPDX-License-Identifier: GPL-3.0-or-later
"""What was rendered already: a report and an image for each run, found by what went into it."""

from __future__ import annotations

import functools
import hashlib
import json
import os
from collections.abc import Iterable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Protocol

import numpy as np

from tests.instruments.bench import _children, _machine
from tests.instruments.bench._luxcore_textures import UntranslatedError
from tests.instruments.bench._machine import CpuTimes
from tests.instruments.bench._methods import FAMILIES, METHODS
from tests.instruments.bench._ratios import MeasurementError
from tests.instruments.bench._scenes import Scene
from tools import venvs
from tools.common import BUILD, ROOT

FOLDER = BUILD / "bench" / "error"
EXPORT_SCRIPT = "_export_job.py"
# A child that takes so many seconds beside so many times its budget has failed.
PATIENCE, PATIENCE_FACTOR = 300.0, 4.0


class Image(Protocol):
    """What the store can render."""

    @property
    def name(self) -> str:
        """Of files."""

    @property
    def scene(self) -> Scene: ...

    @property
    def family(self) -> str:
        """Of FAMILIES."""

    @property
    def budget(self) -> float:
        """Seconds of rendering."""

    @property
    def job(self) -> dict:
        """What the child is told, but for the files that it writes."""


@dataclass(frozen=True)
class Task:
    """An image of the bench."""

    scene: Scene
    method: str  # of _methods.METHODS
    budget: float  # s of rendering
    seed: int
    threads: int

    @property
    def name(self) -> str:
        return f"{self.scene.name}_{self.method}_{self.budget:g}s_{self.seed}"

    @property
    def family(self) -> str:
        return METHODS[self.method].family

    @property
    def job(self) -> dict:
        return METHODS[self.method].job | {
            "scene": str(self.scene.blend),
            "size": self.scene.size,
            "threads": self.threads,
            "seconds": self.budget,
            "seed": self.seed,
        }


@dataclass(frozen=True)
class Record:
    """What came of rendering; the image is read when it is asked for."""

    report: dict  # of the child: load_seconds, render_seconds, samples, peak_memory, stats
    wall_seconds: float
    others_share: float  # of the processors' time that other programs took meanwhile
    processor: str  # what it was rendered on
    image_path: Path  # not stored

    def image(self) -> np.ndarray:
        """(H, W, 3) float64."""
        return np.load(self.image_path).astype(np.float64)


STORED = {field.name for field in fields(Record)} - {"image_path"}


def find(wanted: Image) -> Record | None:
    """What an earlier run of this version of the bench left."""
    path = _path(wanted)
    image = path.with_suffix(".npy")
    if not path.exists() or not image.exists():
        return None
    stored = json.loads(path.read_text())
    if stored.keys() != STORED:
        return None
    return Record(**stored, image_path=image)


def render(wanted: Image) -> Record:
    """Renders in a child process; raises MeasurementError, and UntranslatedError if the renderer
    cannot show this scene."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    family = FAMILIES[wanted.family]
    path = _path(wanted)
    image = path.with_suffix(".npy")
    job = wanted.job | {"image": str(image)}
    if family.described:
        job |= _description(wanted.scene)
    before = CpuTimes.now()
    path.unlink(missing_ok=True)  # what it tells of is written over from here on
    limit = PATIENCE + PATIENCE_FACTOR * wanted.budget
    run = _children.run(path.stem, family.where, family.script, job, FOLDER, limit)
    if "untranslated" in run.report:
        raise UntranslatedError(run.report["untranslated"])
    if wrong := int(np.count_nonzero(~np.isfinite(np.load(image)))):
        raise MeasurementError(f"{path.stem}: {wrong} values of the image are not finite")
    stored = {
        "report": run.report,
        "wall_seconds": run.wall_seconds,
        "others_share": before.others_share(CpuTimes.now()),
        "processor": _machine.processor(),
    }
    fresh = path.with_suffix(".new")
    fresh.write_text(json.dumps(stored))
    fresh.replace(path)  # only what is complete counts
    return Record(**stored, image_path=image)


def _path(wanted: Image) -> Path:
    key = {
        "scene": wanted.scene.digest,
        "job": wanted.job,
        "program": program_digest(wanted.family),
    }
    digest = hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()[:16]
    return FOLDER / f"{wanted.name}_{digest}.json"


@functools.cache
def program_digest(family: str) -> str:
    """Of all that an image of this family depends on beside the scene and the job."""
    scripts = [_children.HERE / FAMILIES[family].script, _children.HERE / "_render_job.py"]
    scripts.append(ROOT / "tests" / "images" / "_render.py")
    if family == "specula":
        return specula_digest(scripts)
    if family == "luxcore":
        scripts = [_children.HERE / name for name in (EXPORT_SCRIPT, "_description.py")]
        scripts += sorted(_children.HERE.glob("_luxcore*.py"))
        exported = sorted((ROOT / "addon" / "export").glob("*.py"))
        return _digest([*scripts, *sorted(venvs.REQUIREMENTS.glob("luxcore*.txt")), *exported])
    return f"{venvs.BPY_VERSION} {_digest(scripts)}"


def specula_digest(scripts: Iterable[Path]) -> str:
    """Of the native libraries, the addon and the scripts that drive them."""
    libraries = sorted(Path(os.environ["SPECULA_LIBRARY_DIR"]).glob("*.so"))
    return _digest([*scripts, *libraries, *sorted((ROOT / "addon").rglob("*.py"))])


def _digest(paths: Iterable[Path]) -> str:
    whole = hashlib.sha256()
    for path in paths:
        whole.update(hashlib.sha256(path.read_bytes()).digest())
    return whole.hexdigest()


def _description(scene: Scene) -> dict:
    """For renderers that read no .blend, as parts of their job: `description`, the pickle of what
    Specula exports of the scene, and `settings`."""
    width, height = scene.size
    program = program_digest("luxcore")[:8]
    stem = f"{scene.name}_{width}x{height}_{scene.digest[:8]}_{program}"
    path = FOLDER / f"{stem}.pickle"
    settings = path.with_suffix(".settings")
    if not path.exists():
        fresh = path.with_suffix(".new")
        job = {"scene": str(scene.blend), "size": scene.size, "description": str(fresh)}
        run = _children.run(f"export_{stem}", "specula in bpy", EXPORT_SCRIPT, job, FOLDER)
        settings.write_text(json.dumps(run.report["settings"]))
        fresh.replace(path)
    return {"description": str(path), "settings": json.loads(settings.read_text())}
