# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render would make of a material or object in caustics, for the panels.

The core decides that, so the core is asked, once for each state of the materials: panels ask
again whenever they are drawn.
"""

from __future__ import annotations

import functools
import pickle

from .abi import CausticsRole, Visibility
from .export import desc
from .export.image import COLOR_SPACES
from .export.log import ExportLog
from .export.material import default_material, export_material
from .export.visibility import object_role, object_visibility
from .inquiry import Forecast, Inquiry


class _AnyImage:
    """In place of `image.Images`: one stands for all of a colour space, and no pixel is read."""

    def __init__(self):
        self.descs = [desc.ImageDesc("(any image)", color_space=s) for s in desc.ColorSpace]

    def add(self, image, image_user, user: str) -> int:
        name = image.colorspace_settings.name if image else "sRGB"
        return int(COLOR_SPACES.get(name, desc.ColorSpace.SRGB))

    def tiles(self, image) -> list[tuple[int, int]]:
        """None: the first stands for all."""
        return []


def of_material(material) -> Forecast:
    """Of an object that has only `material` and is to cast and receive."""
    return _of([material], CausticsRole.BOTH, Visibility.ALL)


def of_object(obj) -> Forecast:
    """Of `obj` with its materials, its role and its ray visibility."""
    materials = [slot.material for slot in obj.material_slots] or [None]
    return _of(materials, object_role(obj), object_visibility(obj))


def _of(materials: list, role: CausticsRole, visibility: Visibility) -> Forecast:
    images, log = _AnyImage(), ExportLog()
    described = [
        export_material(material, images, log) if material else default_material()
        for material in materials
    ]
    return _ask(pickle.dumps(described), role, visibility)


@functools.lru_cache(maxsize=256)
def _ask(described: bytes, role: CausticsRole, visibility: Visibility) -> Forecast:
    """The core's answer about pickled `MaterialDesc`, which tell one state from another."""
    images = _AnyImage().descs
    with Inquiry() as core:
        materials = [core.add(material, images) for material in pickle.loads(described)]
        return core.forecast(materials, role, visibility)


def forget() -> None:
    """Forgets all answers, as if nobody had asked."""
    _ask.cache_clear()
