# SPDX-License-Identifier: GPL-3.0-or-later
"""Denoising by Open Image Denoise, with the library that comes with Blender (4.1 and later).

Knows nothing of Blender: arrays in, arrays out.
"""

from __future__ import annotations

import atexit
import ctypes
import functools
from collections.abc import Callable, Generator
from ctypes import POINTER, byref, c_bool, c_char_p, c_int, c_size_t, c_ulong, c_void_p
from dataclasses import dataclass
from enum import Enum, IntEnum
from pathlib import Path
from typing import ClassVar

import numpy as np

from .abi import Pass

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
        filters = self.filters(color, albedo, normal, prefilter, quality)
        while True:
            try:
                handle = next(filters)
            except StopIteration as end:
                return end.value
            self._library.oidnExecuteFilter(handle)

    def filters(
        self,
        color: np.ndarray,
        albedo: np.ndarray | None,
        normal: np.ndarray | None,
        prefilter: Prefilter,
        quality: Quality,
    ) -> Generator[int, None, np.ndarray]:
        """The filters by which `denoise` makes its picture, which comes at the end. Each must have
        been executed when the next is asked for."""
        guides = {"albedo": albedo} if albedo is not None else {}
        if albedo is not None and normal is not None:
            guides["normal"] = normal
        if prefilter == Prefilter.ACCURATE:
            for name, image in guides.items():
                guides[name] = yield from self._filter({name: image})
        settings = {"hdr": True}
        if guides:
            settings["cleanAux"] = prefilter != Prefilter.FAST
        return (yield from self._filter({"color": color, **guides}, quality, **settings))

    def _filter(
        self, images: dict, quality: Quality = Quality.HIGH, **settings
    ) -> Generator[int, None, np.ndarray]:
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
            yield handle
            self._check()
        finally:
            library.oidnReleaseFilter(handle)
        return output

    def _check(self) -> None:
        message = c_char_p()
        if self._library.oidnGetDeviceError(self._device, ctypes.byref(message)):
            raise DenoisingError((message.value or b"Open Image Denoise failed").decode())


class _Thread:
    """A thread that calls one function of C.

    One of Python's own would not do: while Blender evaluates a scene it gives up the interpreter's
    lock, whoever has it.
    """

    def __init__(self, function, argument: int):
        self._libc = ctypes.CDLL(None)
        self._thread = c_ulong()
        start = ctypes.cast(function, c_void_p)
        if self._libc.pthread_create(byref(self._thread), None, start, c_void_p(argument)):
            raise DenoisingError("there is no thread to be had for denoising")
        self._has_ended = False

    def has_ended(self, waits: bool = False) -> bool:
        """Whether the function has returned, for which it may be waited."""
        join = self._libc.pthread_join if waits else self._libc.pthread_tryjoin_np
        self._has_ended = self._has_ended or join(self._thread, None) == 0
        return self._has_ended


class DenoisingTask:
    """A picture that is denoised while other things go on."""

    left: ClassVar[list[DenoisingTask]] = []  # closed, but under way

    def __init__(self, denoising: Denoising, picture: np.ndarray, guides: list[np.ndarray]):
        albedo, normal = (*guides, None, None)[:2]
        self._library, self._result = denoising.library, picture.copy()
        self._denoiser = Denoiser(denoising.library)
        color, how = picture[..., :3], (denoising.prefilter, denoising.quality)
        self._filters = self._denoiser.filters(color, albedo, normal, *how)
        self._thread: _Thread | None = None
        self.result()

    def result(self) -> np.ndarray | None:
        """The picture once it is denoised, else None. Raises DenoisingError."""
        if self._thread is not None and not self._thread.has_ended():
            return None
        try:
            handle = next(self._filters)
        except StopIteration as end:
            self._result[..., :3] = end.value
            self._release()
            return self._result
        except DenoisingError:
            self._release()
            raise
        self._thread = _Thread(self._library.oidnExecuteFilter, handle)
        return None

    def close(self) -> None:
        """Gives the picture up; the filter under way cannot be stopped."""
        self.left.append(self)
        self.left[:] = [task for task in self.left if not task._has_left()]

    def _has_left(self, waits: bool = False) -> bool:
        if self._thread is not None and not self._thread.has_ended(waits):
            return False
        self._filters.close()
        self._release()
        return True

    def _release(self) -> None:
        if self._denoiser is not None:
            self._denoiser.__exit__()
            self._denoiser = None

    @classmethod
    def wait_for_all(cls) -> None:
        """Returns when what has been closed is no longer under way."""
        cls.left[:] = [task for task in cls.left if not task._has_left(waits=True)]


atexit.register(DenoisingTask.wait_for_all)


@dataclass(frozen=True)
class Denoising:
    """How pictures are denoised: the library, and what Cycles' settings say."""

    library: ctypes.CDLL
    guides: tuple[Pass, ...]  # albedo, or albedo and normal, or none
    prefilter: Prefilter = Prefilter.ACCURATE
    quality: Quality = Quality.HIGH
    first_sample: int = 1  # of a viewport: a picture of fewer is shown as it is

    def denoised(self, picture: np.ndarray, read: Callable[[Pass], np.ndarray]) -> np.ndarray:
        """A new picture (H, W, C) float32 with the alpha of `picture`, if it has one; `read` gives
        the guides, (H, W, 3). Raises DenoisingError."""
        result = picture.copy()
        with Denoiser(self.library) as denoiser:
            result[..., :3] = denoiser.denoise(
                picture[..., :3],
                *map(read, self.guides),
                prefilter=self.prefilter,
                quality=self.quality,
            )
        return result

    def begin(self, picture: np.ndarray, read: Callable[[Pass], np.ndarray]) -> DenoisingTask:
        """Begins what `denoised` does."""
        return DenoisingTask(self, picture, list(map(read, self.guides)))
