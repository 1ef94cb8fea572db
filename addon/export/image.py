# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender images -> `ImageDesc`: the file where there is one and the core reads it, else pixels."""

from __future__ import annotations

import os

import bpy
import numpy as np

from .desc import AlphaMode, ColorSpace, ImageDesc
from .log import ExportLog

MAGENTA = np.array([[[255, 0, 255, 255]]], np.uint8)  # what Cycles shows for a missing image

# Colour spaces by name: 3.4's and 5.0's names for what the core can read.
COLOR_SPACES = {
    "sRGB": ColorSpace.SRGB,
    "Linear": ColorSpace.LINEAR,
    "Linear Rec.709": ColorSpace.LINEAR,
    "Non-Color": ColorSpace.DATA,
    "Raw": ColorSpace.DATA,
}

ALPHA_MODES = {
    "STRAIGHT": AlphaMode.STRAIGHT,
    "PREMUL": AlphaMode.PREMULTIPLIED,
    "CHANNEL_PACKED": AlphaMode.PACKED,
    "NONE": AlphaMode.NONE,
}


class Images:
    """The images of a scene, each exported once."""

    def __init__(self, log: ExportLog, as_pixels: bool = False):
        """`as_pixels`: Blender decodes every image, for a core that reads no files."""
        self.descs: list[ImageDesc] = []
        self._log = log
        self._as_pixels = as_pixels
        self._indices: dict = {}

    def add(self, image, user: str) -> int:
        """Index of `image`; of a magenta pixel if it is None or its file is missing."""
        if image is None:
            self._log.warn(user, "has no image, shown in magenta")
        elif not _has_data(image):
            self._log.warn(f"image {image.name}", f"{_path(image)} is missing, shown in magenta")
            image = None
        if image not in self._indices:
            self._indices[image] = len(self.descs)
            self.descs.append(self._export(image) if image else _magenta())
        return self._indices[image]

    def _export(self, image) -> ImageDesc:
        desc = ImageDesc(
            name=image.name,
            color_space=self._color_space(image),
            alpha_mode=ALPHA_MODES[image.alpha_mode],
        )
        if image.source in ("SEQUENCE", "MOVIE", "TILED"):
            self._log.warn(
                f"image {image.name}", f"{image.source.lower()} images are shown as a single image"
            )
        if self._as_pixels or image.is_dirty or image.source in ("GENERATED", "VIEWER", "MOVIE"):
            desc.pixels = _pixels(image)
            desc.color_space, desc.alpha_mode = _as_in_memory(image, desc)
        elif image.packed_file:
            desc.encoded = image.packed_file.data
        else:
            desc.path = _path(image)
        return desc

    def _color_space(self, image) -> ColorSpace:
        name = image.colorspace_settings.name
        if name not in COLOR_SPACES:
            self._log.warn(
                f"image {image.name}", f"colour space {name} is not supported, sRGB is used"
            )
        return COLOR_SPACES.get(name, ColorSpace.SRGB)


def _path(image) -> str:
    """Absolute path of the image's file; of the first tile of a UDIM."""
    path = image.filepath.replace("<UDIM>", "1001").replace("<UVTILE>", "u1_v1")
    return os.path.normpath(bpy.path.abspath(path, library=image.library))


def _has_data(image) -> bool:
    if image.source in ("GENERATED", "VIEWER") or image.is_dirty or image.packed_file:
        return True
    return os.path.isfile(_path(image))


def _pixels(image) -> np.ndarray:
    """(H, W, C) as Blender holds them, bottom row first: uint8, or float32 if it holds floats."""
    width, height = image.size
    pixels = np.empty((height, width, image.channels), np.float32)
    image.pixels.foreach_get(pixels.ravel())
    return pixels if image.is_float else np.rint(255.0 * pixels).astype(np.uint8)


def _as_in_memory(image, desc: ImageDesc) -> tuple[ColorSpace, AlphaMode]:
    """Colour space and alpha of `image.pixels`: float buffers are linear and premultiplied."""
    if image.is_float and desc.color_space != ColorSpace.DATA:
        alpha = AlphaMode.PREMULTIPLIED if desc.alpha_mode != AlphaMode.NONE else AlphaMode.NONE
        return ColorSpace.LINEAR, alpha
    return desc.color_space, desc.alpha_mode


def _magenta() -> ImageDesc:
    return ImageDesc("(missing image)", pixels=MAGENTA, color_space=ColorSpace.LINEAR)
