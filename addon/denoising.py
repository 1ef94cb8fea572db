# SPDX-License-Identifier: GPL-3.0-or-later
"""Denoising by Open Image Denoise, with the library that comes with Blender (4.1 and later).

Knows nothing of Blender: arrays in, arrays out.
"""

from __future__ import annotations

import ctypes
import functools
from ctypes import POINTER, c_bool, c_char_p, c_int, c_size_t, c_void_p
from enum import Enum, IntEnum
from pathlib import Path

import numpy as np

LIBRARY_NAME = "libOpenImageDenoise.so.2"

# From OpenImageDenoise/oidn.h.
_DEVICE_CPU = 1
_FORMAT_FLOAT3 = 3
_PROTOTYPES = {
    "oidnNewDevice": (c_void_p, (c_int,)),
    "oidnCommitDevice": (None, (c_void_p,)),
    "oidnGetDeviceError": (c_int, (c_void_p, POINTER(c_char_p))),
    "oidnReleaseDevice": (None, (c_void_p,)),
    "oidnNewFilter": (c_void_p, (c_void_p, c_char_p)),
    "oidnSetSharedFilterImage": (
        None,
        (c_void_p, c_char_p, c_void_p, c_int, *[c_size_t] * 5),
    ),
    "oidnSetFilterBool": (None, (c_void_p, c_char_p, c_bool)),
    "oidnSetFilterInt": (None, (c_void_p, c_char_p, c_int)),
    "oidnCommitFilter": (None, (c_void_p,)),
    "oidnExecuteFilter": (None, (c_void_p,)),
    "oidnReleaseFilter": (None, (c_void_p,)),
}


class Quality(IntEnum):
    """As Cycles names them, with the library's numbers."""

    FAST = 4
    BALANCED = 5
    HIGH = 6


class Prefilter(Enum):
    """What is known of the guides' noise, as Cycles names it."""

    NONE = "NONE"  # they have none
    FAST = "FAST"  # they are denoised with the picture
    ACCURATE = "ACCURATE"  # they are denoised before it


class DenoisingError(Exception):
    """The library is missing, or has failed; the message is for the user."""


@functools.cache
def load(folders: tuple[Path, ...]) -> ctypes.CDLL:
    """The library in the first folder that has it, else the system's. Raises DenoisingError."""
    paths = [folder / LIBRARY_NAME for folder in folders]
    for path in [*(str(path) for path in paths if path.is_file()), LIBRARY_NAME]:
        try:
            library = ctypes.CDLL(path)
            for name, (result, arguments) in _PROTOTYPES.items():
                function = getattr(library, name)
                function.restype, function.argtypes = result, arguments
            return library
        except (OSError, AttributeError):
            continue
    raise DenoisingError("there is no Open Image Denoise in this Blender")


class Denoiser:
    """A device of the library, for the with-statement."""

    def __init__(self, library: ctypes.CDLL):
        self._library = library
        self._device = library.oidnNewDevice(_DEVICE_CPU)
        library.oidnCommitDevice(self._device)
        self._check()

    def __enter__(self) -> Denoiser:
        return self

    def __exit__(self, *_) -> None:
        self._library.oidnReleaseDevice(self._device)

    def denoise(
        self,
        color: np.ndarray,
        albedo: np.ndarray | None = None,
        normal: np.ndarray | None = None,
        prefilter: Prefilter = Prefilter.ACCURATE,
        quality: Quality = Quality.HIGH,
    ) -> np.ndarray:
        """A new picture (H, W, 3) float32 of linear radiance.

        The guides have the picture's shape: albedo within [0, 1], normals of any space. Normals
        help only together with the albedo. Raises DenoisingError.
        """
        guides = {"albedo": albedo} if albedo is not None else {}
        if albedo is not None and normal is not None:
            guides["normal"] = normal
        if prefilter == Prefilter.ACCURATE:
            guides = {name: self._filter({name: image}) for name, image in guides.items()}
        settings = {"hdr": True}
        if guides:
            settings["cleanAux"] = prefilter != Prefilter.FAST
        return self._filter({"color": color, **guides}, quality, **settings)

    def _filter(self, images: dict, quality: Quality = Quality.HIGH, **settings) -> np.ndarray:
        library = self._library
        images = {name: np.ascontiguousarray(image, np.float32) for name, image in images.items()}
        output = np.empty_like(next(iter(images.values())))
        height, width, _ = output.shape
        handle = library.oidnNewFilter(self._device, b"RT")
        try:
            for name, image in [*images.items(), ("output", output)]:
                library.oidnSetSharedFilterImage(
                    handle, name.encode(), image.ctypes.data, _FORMAT_FLOAT3, width, height, 0, 0, 0
                )
            for name, value in settings.items():
                library.oidnSetFilterBool(handle, name.encode(), value)
            library.oidnSetFilterInt(handle, b"quality", quality)
            library.oidnCommitFilter(handle)
            library.oidnExecuteFilter(handle)
            self._check()
        finally:
            library.oidnReleaseFilter(handle)
        return output

    def _check(self) -> None:
        message = c_char_p()
        if self._library.oidnGetDeviceError(self._device, ctypes.byref(message)):
            raise DenoisingError((message.value or b"Open Image Denoise failed").decode())
