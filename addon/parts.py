# SPDX-License-Identifier: GPL-3.0-or-later
"""Part files: sums of some samples of a picture, which add up with those of others to the bit.

Knows nothing of Blender. A file is MAGIC, the length of a header in JSON, the header, the core's
sums, and a checksum of all before it. It is written whole or not at all.
"""

from __future__ import annotations

import hashlib
import json
import os
import struct
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from . import native
from .exr import write_exr

MAGIC = b"SPCPART1"
_LENGTH = struct.Struct("<Q")
_DIGEST_BYTES = 32

# What parts of one picture have in common, and what it is called where it differs.
COMMON = {
    "version": "version of Specula",
    "scene": "scene",
    "seed": "seed",
    "total_samples": "number of samples",
}


class PartError(Exception):
    """A part file cannot be used; the message names it, and says why."""


@dataclass
class Channels:
    """A pass of the picture that the parts are of."""

    name: str
    channels: str
    source: int | list[int]  # abi.Pass, or the kind and the level of Cryptomatte
    scale: float = 1.0  # of its colours


@dataclass
class Header:
    """What is known of the sums of a part."""

    version: str
    scene: str  # fingerprint of the scene and of the settings
    seed: int
    total_samples: int
    ranges: list[tuple[int, int]]  # first sample and the one after the last, ascending
    layer: str  # view layer
    passes: list[Channels] = field(default_factory=list)
    frame: tuple[int, int] = (0, 0)  # width and height of the full frame
    corner: tuple[int, int] = (0, 0)  # of the crop, from the bottom left
    metadata: dict[str, str] = field(default_factory=dict)  # for the picture's file

    @property
    def samples(self) -> int:
        return sum(end - first for first, end in self.ranges)

    def is_complete(self) -> bool:
        return self.samples == self.total_samples


@dataclass
class Part:
    header: Header
    sums: bytearray
    path: str = ""

    # As native.Session has them, for whoever reads passes.
    @property
    def samples(self) -> int:
        return self.header.samples

    def read(self, source: int, width: int, height: int) -> np.ndarray:
        """(height * width, channels) float32, bottom row first."""
        return native.read_sums(self.sums, source, width, height)

    def check_same_picture(self, other: Part) -> None:
        """Raises PartError, naming `other`, if it is of another picture or of the same samples."""
        for name, called in COMMON.items():
            mine, theirs = getattr(self.header, name), getattr(other.header, name)
            if mine != theirs:
                raise PartError(f"{other.path}: of another {called}: {theirs}, not {mine}")
        ranges = sorted([*self.header.ranges, *other.header.ranges])
        for (_, end), (first, _) in pairwise(ranges):
            if first < end:
                raise PartError(f"{other.path}: sample {first} is there already")

    def add(self, other: Part) -> None:
        """Adds other samples of the same picture. Raises PartError."""
        self.check_same_picture(other)
        ranges = sorted([*self.header.ranges, *other.header.ranges])
        try:
            native.add_sums(self.sums, other.sums, other.header.ranges[0] < self.header.ranges[0])
        except native.NativeError as error:
            raise PartError(f"{other.path}: {error}") from None
        joined = [ranges[0]]
        for first, end in ranges[1:]:
            if first == joined[-1][1]:
                joined[-1] = (joined[-1][0], end)
            else:
                joined.append((first, end))
        self.header.ranges = joined

    def write(self, path: Path) -> None:
        """Replaces `path` at once, so that a reader sees the old file or the new one."""
        header = json.dumps(asdict(self.header)).encode()
        fresh = path.with_name(f".{path.name}.{os.getpid()}")
        digest = hashlib.blake2b(digest_size=_DIGEST_BYTES)
        try:
            with open(fresh, "wb") as file:
                for piece in (MAGIC, _LENGTH.pack(len(header)), header, self.sums):
                    digest.update(piece)
                    file.write(piece)
                file.write(digest.digest())
                file.flush()
                os.fsync(file.fileno())
            os.replace(fresh, path)
        except OSError as error:
            fresh.unlink(missing_ok=True)
            raise PartError(f"{path}: {error.strerror}") from error
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def read_part(path: Path) -> Part:
    """Raises PartError if the file is missing, damaged, or no part."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise PartError(f"{path}: {error.strerror}") from error
    start = len(MAGIC) + _LENGTH.size
    if not content.startswith(MAGIC) or len(content) < start + _DIGEST_BYTES:
        raise PartError(f"{path}: this is no part of a render")
    body, digest = content[:-_DIGEST_BYTES], content[-_DIGEST_BYTES:]
    if hashlib.blake2b(body, digest_size=_DIGEST_BYTES).digest() != digest:
        raise PartError(f"{path}: damaged, its checksum differs")
    (length,) = _LENGTH.unpack_from(body, len(MAGIC))
    fields = json.loads(body[start : start + length])
    fields["passes"] = [Channels(**row) for row in fields["passes"]]
    fields["ranges"] = [tuple(pair) for pair in fields["ranges"]]
    return Part(Header(**fields), bytearray(body[start + length :]), str(path))


def merge(paths: list[Path]) -> Part:
    """The sum of part files, in the order of their samples. Raises PartError."""
    parts = sorted(map(read_part, paths), key=lambda part: part.header.ranges[0])
    whole = parts[0]
    for part in parts[1:]:
        whole.add(part)
    return whole


def write_picture(part: Part, path: Path) -> None:
    """All passes as a multilayer EXR, the crop in its place in the full frame."""
    width, height = native.sums_extent(part.sums)
    frame_width, frame_height = part.header.frame
    x, y = part.header.corner
    layers = {}
    for row in part.header.passes:
        pixels = part.read(row.source, width, height).reshape(height, width, -1)
        if row.scale != 1.0:
            pixels[..., :3] *= np.float32(row.scale)
        full = np.zeros((frame_height, frame_width, len(row.channels)), np.float32)
        full[y : y + height, x : x + width] = pixels
        for index, letter in enumerate(row.channels):
            layers[f"{part.header.layer}.{row.name}.{letter}"] = full[::-1, :, index]
    metadata = {
        "specula.version": part.header.version,
        "specula.samples": str(part.header.samples),
        **part.header.metadata,
    }
    write_exr(path, layers, metadata)
