# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of Cycles that Specula does not have: whoever uses one is told once.

What every new scene has set is not here (clamping, glossy filter, light threshold, the shadow
terminator's offset of 0.1): docs/supported.md tells what is done instead.
"""

from __future__ import annotations

from dataclasses import dataclass

from . import compat
from .log import ExportLog


@dataclass(frozen=True)
class Ignored:
    """A number or switch, and the largest value at which Cycles' picture is Specula's."""

    setting: str
    neutral: float
    message: str


SCENE = (Ignored("use_fast_gi", False, "fast GI is not supported, all light is followed"),)
OBJECT = (
    Ignored(
        "shadow_terminator_geometry_offset",
        0.1,
        "an offset of the shadow terminator is not supported, shadows start at the surface",
    ),
)
ADAPTIVE_MESSAGE = "adaptive subdivision is not supported, its modifier's own levels are used"
SHADOW_MESSAGE = "shadows of what is looked through are always transparent"
# Bounces after which the light of the world counts no more.
BOUNCES = 1024
BOUNCES_MESSAGE = "a limit of its bounces is not supported, it lights all of them"


def warn_of_scene(scene, log: ExportLog) -> None:
    _warn(scene, "scene", SCENE, log)


def warn_of_object(obj, log: ExportLog) -> None:
    _warn(obj, f"object {obj.name}", OBJECT, log)


def warn_of_subdivision(scene, obj, log: ExportLog) -> None:
    """Where Cycles would subdivide by what a pixel shows; until 5.0 an experimental feature."""
    of_object = compat.cycles_value(obj, "use_adaptive_subdivision", False)
    experimental = compat.cycles_value(scene, "feature_set", "SUPPORTED") in ("EXPERIMENTAL", 1)
    if (of_object and experimental) or any(
        getattr(modifier, "use_adaptive_subdivision", False) for modifier in obj.modifiers
    ):
        log.warn(f"object {obj.name}", ADAPTIVE_MESSAGE)


def warn_of_material(material, log: ExportLog) -> None:
    """Cycles' own switch until 4.1, since then Blender's."""
    own = getattr(material, "use_transparent_shadow", True)
    if not compat.cycles_value(material, "use_transparent_shadow", own):
        log.warn(f"material {material.name}", SHADOW_MESSAGE)


def warn_of_world(world, log: ExportLog) -> None:
    if compat.cycles_value(world, "max_bounces", BOUNCES) < BOUNCES:
        log.warn(f"world {world.name}", BOUNCES_MESSAGE)


def _warn(owner, label: str, rows: tuple[Ignored, ...], log: ExportLog) -> None:
    for row in rows:
        value = compat.cycles_value(owner, row.setting, row.neutral)
        if value > row.neutral * (1.0 + 1e-6):  # stored in single precision
            log.warn(label, row.message)
