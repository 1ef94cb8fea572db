# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender images -> `ImageDesc`: the file where there is one and the core reads it, else pixels."""

from __future__ import annotations

import os
import re

import bpy
import numpy as np

from . import compat
from .desc import (
    NONE,
    AlphaMode,
    ColorSpace,
    ExportError,
    ImageDesc,
    MaterialDesc,
    missing_image,
)
from .log import ExportLog

CHUNK = 1 << 20  # floats that become bytes at a time
FIRST_TILE = 1001  # of a UDIM; ten in a row

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

    def __init__(self, log: ExportLog, as_pixels: bool = False, frame: int = 1, cache=None):
        """`as_pixels`: Blender decodes every image, for a core that reads no files.

        `frame` is the scene's, `cache` an `ExportCache` or None.
        """
        self.descs: list[ImageDesc] = []
        self._log = log
        self._as_pixels = as_pixels
        self._frame = frame
        self._cache = cache
        self._indices: dict = {}  # image and number -> index
        self._places: dict[int, int] = {}  # id of a description -> index
        self._states: dict[int, tuple | None] = {}  # index -> as `state_of`; not of made pixels

    def add(self, image, image_user, user: str) -> int:
        """Index of `image`; of a magenta pixel if there is nothing to see.

        `image_user` is Blender's, which tells what a sequence shows; `user` is who reads it.
        """
        if image is None:
            self._log.warn(user, "has no image, shown in magenta")
        number = sequence_number(image, image_user, self._frame)
        tile = _tile(image) if image and image.source == "TILED" else None
        return self._add((image, number, tile))

    def _add(self, key: tuple) -> int:
        """Index of an image, the number of its file in a sequence, and that of its tile."""
        image = key[0]
        if key not in self._indices:
            state = state_of(*key) if image and self._cache else None
            desc = self._cache.image(state, self._log) if state else None
            try:
                desc = desc or self._kept(state, *key) if image else missing_image()
            except MemoryError as error:
                raise ExportError(f"image {image.name}: out of memory ({error})") from error
            self._indices[key] = self.place(desc)
            self._states[self._indices[key]] = state
        return self._indices[key]

    def tiles(self, image) -> list[tuple[int, int]]:
        """Of a picture in several tiles: each one's number, counted from 0 in rows of ten, and the
        index of its image; empty for others."""
        if image is None or image.source != "TILED" or len(image.tiles) < 2 or _is_in_memory(image):
            return []
        return [
            (tile.number - FIRST_TILE, self._add((image, None, tile.number)))
            for tile in image.tiles
        ]

    def add_pixels(self, name: str, pixels: np.ndarray) -> int:
        """Index of an image of linear `pixels`, (H, W, 3) float32, bottom row first."""
        return self.place(ImageDesc(name, pixels=pixels, color_space=ColorSpace.LINEAR))

    def place(self, desc: ImageDesc) -> int:
        """Index of a description, which is added if it is new."""
        index = self._places.setdefault(id(desc), len(self.descs))
        if index == len(self.descs):
            self.descs.append(desc)
        return index

    def used_by(self, material: MaterialDesc) -> dict[int, tuple[ImageDesc, tuple | None]]:
        """The images that a material's nodes refer to, by index, and the state of each: None where
        it may be another one the next time, () of pixels that the material itself has made."""
        indices = {node.image for node in material.nodes if node.image != NONE}
        return {index: (self.descs[index], self._states.get(index, ())) for index in indices}

    def are_as(self, states) -> bool:
        """Whether images are in the states that `used_by` gave."""
        images = None
        for state in states:
            if state is None or (state and state[1] is not None):  # of a sequence
                return False
            if state:
                images = images or {compat.identity(image): image for image in bpy.data.images}
                image = images.get(state[0])
                if image is None or state_of(image, None) != state:
                    return False
        return True

    def _kept(self, state: tuple | None, image, number: int | None, tile: int | None) -> ImageDesc:
        with self._log.recording() as warnings:
            desc = self._export(image, number, tile)
        if state:
            self._cache.keep_image(state, desc, warnings)
        return desc

    def _export(self, image, number: int | None, tile: int | None) -> ImageDesc:
        path = _path(image, number, tile)
        in_memory = _is_in_memory(image)
        if not (in_memory or image.packed_file or os.path.isfile(path)):
            return self._missing(image, f"{path} is missing")
        desc = ImageDesc(
            name=image.name,
            color_space=self._color_space(image),
            alpha_mode=ALPHA_MODES[image.alpha_mode],
        )
        if image.source == "TILED" and len(image.tiles) > 1 and in_memory:
            self._log.warn(f"image {image.name}", f"of its tiles only {tile} is shown: not saved")
        if image.source == "MOVIE":
            self._log.warn(f"image {image.name}", "of a movie only the first frame is shown")
        if self._as_pixels or in_memory or image.source == "MOVIE":
            is_whole = number is None and (tile is None or in_memory)
            desc.pixels = _pixels(image) if is_whole else _pixels_of_file(image, path)
            desc.color_space, desc.alpha_mode = _as_in_memory(image, desc)
            if not desc.pixels.size:
                return self._missing(image, "has no pixels")
        elif image.packed_file:
            desc.encoded = image.packed_file.data
        else:
            desc.path = path
        return desc

    def _missing(self, image, why: str) -> ImageDesc:
        self._log.warn(f"image {image.name}", f"{why}, shown in magenta")
        return missing_image()

    def _color_space(self, image) -> ColorSpace:
        name = image.colorspace_settings.name
        if name not in COLOR_SPACES:
            self._log.warn(
                f"image {image.name}", f"colour space {name} is not supported, sRGB is used"
            )
        return COLOR_SPACES.get(name, ColorSpace.SRGB)


def state_of(image, number: int | None, tile: int | None = None) -> tuple | None:
    """Tells an image and its content (of the file `number` of a sequence, of a tile) from others;
    None where only its pixels would."""
    path = _path(image, number, tile)
    is_file = os.path.isfile(path)
    if image.is_dirty or not (is_file or image.packed_file or image.source == "GENERATED"):
        return None
    file = os.stat(path) if is_file else None
    return (
        compat.identity(image),
        number,
        image.name_full,
        image.source,
        path,
        file and (file.st_mtime_ns, file.st_size),
        image.packed_file.size if image.packed_file else None,
        image.colorspace_settings.name,
        image.alpha_mode,
        image.generated_type,
        image.generated_width,
        image.generated_height,
        image.use_generated_float,
        tuple(image.generated_color),
    )


def sequence_number(image, image_user, frame: int) -> int | None:
    """Which file of a sequence is shown in the scene's `frame`; None for other images.

    As in Cycles, which does not ask for *Auto Refresh*.
    """
    if image is None or image.source != "SEQUENCE":
        return None
    count = image_user.frame_duration
    place = frame - image_user.frame_start + 1  # the first is 1
    if image_user.use_cyclic and count:
        place = (place - 1) % count + 1
    return max(min(place, count), 0) + image_user.frame_offset


def _tile(image) -> int:
    """The tile that stands for all of a UDIM."""
    return image.tiles[0].number if len(image.tiles) else FIRST_TILE


def _path(image, number: int | None = None, tile: int | None = None) -> str:
    """Absolute path of the image's file; of the file `number` of a sequence, of a UDIM's `tile`."""
    path = image.filepath
    if image.source == "TILED":
        tile = tile or _tile(image)
        v, u = divmod(tile - FIRST_TILE, 10)
        path = path.replace("<UDIM>", str(tile)).replace("<UVTILE>", f"u{u + 1}_v{v + 1}")
    if number is not None:
        path = _of_sequence(path, number)
    return os.path.normpath(bpy.path.abspath(path, library=image.library))


def _of_sequence(path: str, number: int) -> str:
    """Puts `number` in the place of the last digits of the file's name."""
    stem, extension = os.path.splitext(path)
    head, digits, tail = re.fullmatch(r"(.*?)(\d*)([^\d/\\]*)", stem, re.DOTALL).groups()
    return f"{head}{number:0{len(digits)}}{tail}{extension}" if digits else path


def _is_in_memory(image) -> bool:
    """Whether Blender alone has the pixels."""
    if image.source in ("GENERATED", "VIEWER") or image.is_dirty:
        return True
    has_file = image.packed_file or os.path.isfile(_path(image))
    return image.source == "TILED" and image.has_data and not has_file


def _pixels(image) -> np.ndarray:
    """(H, W, C) as Blender holds them, bottom row first: uint8, or float32 if it holds floats."""
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    if not image.is_float:
        pixels = _into_bytes(pixels)
    return pixels.reshape(height, width, image.channels)


def _into_bytes(values: np.ndarray) -> np.ndarray:
    """0 to 1 as bytes, in the memory of `values`, which is given up: large images fit but once."""
    count = values.size
    target = values.view(np.uint8)
    for start in range(0, count, CHUNK):
        part = 255.0 * values[start : start + CHUNK]
        target[start : start + part.size] = np.rint(part, out=part)
    del target
    values.resize(-(-count // 4), refcheck=False)
    return values.view(np.uint8)[:count]


def _pixels_of_file(image, path: str) -> np.ndarray:
    """`_pixels` of one file of the sequence `image`, loaded anew: Blender has no other access."""
    file = bpy.data.images.load(path)
    try:
        file.colorspace_settings.name = image.colorspace_settings.name
        file.alpha_mode = image.alpha_mode
        return _pixels(file)
    finally:
        bpy.data.images.remove(file)


def _as_in_memory(image, desc: ImageDesc) -> tuple[ColorSpace, AlphaMode]:
    """Colour space and alpha of `image.pixels`: float buffers are linear and premultiplied, those
    of bytes are not, whatever their file is."""
    if desc.pixels.dtype == np.float32 and desc.color_space != ColorSpace.DATA:
        alpha = AlphaMode.PREMULTIPLIED if desc.alpha_mode != AlphaMode.NONE else AlphaMode.NONE
        return ColorSpace.LINEAR, alpha
    if desc.alpha_mode == AlphaMode.PREMULTIPLIED:
        return desc.color_space, AlphaMode.STRAIGHT
    return desc.color_space, desc.alpha_mode
