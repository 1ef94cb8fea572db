# SPDX-License-Identifier: GPL-3.0-or-later
"""What the core says of materials before there is a scene: their needs, their part in caustics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import native
from .abi import CausticsRole, CausticsSearch, Visibility
from .export import desc
from .upload import image_struct, material_struct

_WHITE = np.full((1, 1, 4), 255, np.uint8)


@dataclass(frozen=True)
class Forecast:
    """The part of an object in caustics, as spc_forecast."""

    receives: bool
    search: CausticsSearch
    reason: str  # why it casts, or why not; '' if its role rules casting out
    glints: str  # the closures that glint, else ''
    no_glints: str  # why none do although a material asks for it, else ''

    @property
    def casts(self) -> bool:
        return self.search != CausticsSearch.NONE


class Inquiry:
    """A scene of the core that is never built; free it with a with-statement.

    Of images it matters only how their numbers are meant: white pixels stand for them.
    """

    def __init__(self):
        self._scene = native.Scene()
        self._image_count = 0

    def add(self, material: desc.MaterialDesc, images: list[desc.ImageDesc]) -> int:
        """Index of a material whose nodes refer to `images`, which only grow from call to call."""
        for image in images[self._image_count :]:
            white = desc.ImageDesc(image.name, pixels=_WHITE, color_space=image.color_space)
            self._scene.add("image", image_struct(white))
        self._image_count = len(images)
        return self._scene.add("material", material_struct(material))

    def needs(self, material: int) -> frozenset[desc.AttributeNeed]:
        """What surfaces of the material at that index read from a mesh and an object."""
        return frozenset(
            desc.AttributeNeed(kind, name, tangents)
            for kind, name, tangents in self._scene.material_needs(material)
        )

    def emission(self, material: int) -> tuple[tuple[float, float, float], bool]:
        """What the material at that index emits, on average, and whether that varies."""
        return self._scene.material_emission(material)

    def forecast(
        self, materials: list[int], role: CausticsRole, visibility: Visibility
    ) -> Forecast:
        """What a scene would make of an object with the materials at these indices."""
        return Forecast(**self._scene.forecast(materials, role, visibility))

    def __enter__(self) -> Inquiry:
        return self

    def __exit__(self, *_) -> None:
        self._scene.close()
