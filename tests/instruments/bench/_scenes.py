# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes that are measured, and the references that they are held against."""

from __future__ import annotations

import functools
import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.images import _reference
from tests.instruments.bench import _metrics
from tools.common import ROOT, DevError

BLENDS = ROOT / "blend_scenes"
REFERENCES = ROOT / "tests" / "instruments" / "bench" / "references"
QUICK = ("cornell", "ring", "swimming_pool")
# Columns and rows, from the bottom left, of the insets that are looked at for their glints, and the
# longer side of the picture that they are of.
GLINTS_SIDE = 256
GLINTS = {"shoes": (57, 108, 68, 160), "kettle": (84, 186, 100, 150)}
# Of the pixels: smaller caustics are not looked at by themselves.
LEAST_CAUSTICS = 0.002


@dataclass(frozen=True)
class Scene:
    """A .blend file and its reference, whose size is that of every image of the scene."""

    name: str
    blend: Path
    reference_path: Path

    @functools.cached_property
    def digest(self) -> str:
        return hashlib.sha256(self.blend.read_bytes()).hexdigest()

    @functools.cached_property
    def reference(self) -> _reference.Reference:
        try:
            return _reference.read(self.reference_path)
        except OSError as error:
            raise DevError(f"no reference of ./dev bench reference: {error}") from error

    @property
    def is_example(self) -> bool:
        """Whether the file is one of blend_scenes/, not one of the user's by the same name."""
        return self.blend.resolve().parent == BLENDS.resolve()

    @property
    def size(self) -> tuple[int, int]:
        """Width, height."""
        height, width, _ = self.reference.mean.shape
        return width, height

    @property
    def caustics_known(self) -> bool:
        """Whether the reference tells where there are some. Path tracing alone has no manifold,
        whose share that is; the example that is rendered so has no caustics."""
        if self.reference.caustics is None:
            return False
        return self.is_example or self.reference.about.get("method") != "PT"

    @functools.cached_property
    def caustics(self) -> np.ndarray | None:
        """(H, W) mask of the pixels with caustics; None if there are next to none."""
        if self.reference.caustics is None:
            return None
        mask = _metrics.caustics_mask(self.reference.mean, self.reference.caustics)
        return mask if mask.mean() >= LEAST_CAUSTICS else None

    @functools.cached_property
    def regions(self) -> dict[str, np.ndarray | None]:
        """Name -> mask, None for all pixels."""
        masks = {"image": None}
        if self.caustics is not None:
            masks |= {"caustics": self.caustics, "rest": ~self.caustics}
            if self.reference.direct is not None:
                masks["direct"] = self.caustics & self.reference.direct
        width, height = self.size
        if self.is_example and self.name in GLINTS and max(width, height) == GLINTS_SIDE:
            left, right, bottom, top = GLINTS[self.name]
            masks["glints"] = np.zeros((height, width), bool)
            masks["glints"][bottom:top, left:right] = True
        return {name: mask for name, mask in masks.items() if mask is None or mask.any()}


@functools.cache
def example(name: str) -> Scene:
    """One of blend_scenes/, whether or not it has a reference."""
    scene = Scene(name, BLENDS / f"{name}.blend", REFERENCES / f"{name}.exr")
    if not scene.blend.exists():
        raise DevError(f"there is no {scene.blend.relative_to(ROOT)}")
    return scene


def named(name: str) -> Scene:
    """One of blend_scenes/ that has a reference."""
    scene = example(name)
    if not scene.reference_path.exists():
        raise DevError(
            f"'{name}' has no reference; make it with: ./dev bench reference {name} --seconds 600"
        )
    return scene


def with_references() -> list[str]:
    """Names of the scenes of blend_scenes/ that have one."""
    return sorted(p.stem for p in BLENDS.glob("*.blend") if (REFERENCES / f"{p.stem}.exr").exists())
