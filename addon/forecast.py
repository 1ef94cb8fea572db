# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render would make of a material or object in caustics, for the panels.

The core decides that, so the core is asked: by a scene of one triangle for each material.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .export import desc
from .export.image import COLOR_SPACES
from .export.log import ExportLog
from .export.material import default_material, export_material
from .export.visibility import object_role, object_visibility
from .upload import upload

_NAME = "forecast"  # of the instance; the core's lines about it begin so
_TRIANGLE = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], np.float32)  # m
_IDENTITY = np.eye(3, 4, dtype=np.float32)


@dataclass(frozen=True)
class Forecast:
    """The part in caustics."""

    casts: bool
    receives: bool
    reason: str  # why it casts, or why it cannot although it is asked to; else ''
    glints: str  # in which of its lobes there are glints, or why not if asked for


class _NoImages:
    """In place of `image.Images`: that there is a texture matters here, what it shows does not."""

    def __init__(self):
        white = np.full((1, 1, 4), 255, np.uint8)
        self.descs = [
            desc.ImageDesc("(any image)", pixels=white, color_space=space)
            for space in desc.ColorSpace
        ]

    def add(self, image, image_user, user: str) -> int:
        name = image.colorspace_settings.name if image else "sRGB"
        return int(COLOR_SPACES.get(name, desc.ColorSpace.SRGB))


def of_material(material) -> Forecast:
    """Of an object that has only `material` and is to cast and receive."""
    return _ask([material], desc.CausticsRole.BOTH, desc.Visibility.ALL)


def of_object(obj) -> Forecast:
    """Of `obj` with its materials, its role and its ray visibility."""
    materials = [slot.material for slot in obj.material_slots] or [None]
    return _ask(materials, object_role(obj), object_visibility(obj))


def _ask(materials: list, role: desc.CausticsRole, visibility: desc.Visibility) -> Forecast:
    with upload(_scene(materials, role, visibility)) as scene:
        scene.commit(1)
        stats, report = scene.stats(), scene.report()
    return Forecast(
        bool(stats["casters"]), bool(stats["receivers"]), _reason(report), _glints(report)
    )


def _scene(materials: list, role, visibility) -> desc.SceneDesc:
    images, log = _NoImages(), ExportLog()
    slots = np.arange(len(materials), dtype=np.uint32)
    return desc.SceneDesc(
        images=images.descs,
        materials=[
            export_material(material, images, log)[0] if material else default_material()
            for material in materials
        ],
        meshes=[
            desc.MeshDesc(
                _NAME,
                _TRIANGLE,
                np.tile(np.arange(3, dtype=np.uint32), (len(materials), 1)),
                material_slots=slots,
                slot_count=len(materials),
            )
        ],
        instances=[desc.InstanceDesc(_NAME, 0, _IDENTITY, slots.tolist(), visibility, role)],
        camera=desc.CameraDesc(_IDENTITY, 1, 1, (0, 0, 1, 1), (-1, 1, -1, 1), 0.1),
    )


def _reason(report: list[str]) -> str:
    """From the core's "NAME: caster, HOW (REASON)" or "NAME: marked as caster, ...: REASON"."""
    for line in report:
        if line.startswith(f"{_NAME}: caster,"):
            return line.partition("(")[2].removesuffix(")")
        if line.startswith(f"{_NAME}: marked as caster,"):
            return line.partition("path traced: ")[2]
    return ""


def _glints(report: list[str]) -> str:
    """From the core's "MATERIAL: glints (LOBES; image ...)" or "MATERIAL: no glints: REASON"."""
    for line in report:
        _, found, lobes = line.partition(": glints (")
        if found:
            return lobes.partition("; image")[0]
        _, found, reason = line.partition(": no glints: ")
        if found:
            return f"None: {reason}"
    return "None"
