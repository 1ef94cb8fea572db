# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenEXR files of single-precision channels, for where there is no Blender to write them.

The format is that of "OpenEXR File Layout", version 2: one part of scan lines, ZIP-compressed.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np

_MAGIC, _VERSION = 20000630, 2
_LONG_NAMES = 0x400  # names of more than 31 bytes
_FLOAT, _ZIP, _LINES = 2, 3, 16  # rows in a block of ZIP


def write_exr(path: Path, channels: dict[str, np.ndarray], metadata: dict[str, str]) -> None:
    """Writes `channels`, each (H, W) float32, top row first."""
    names = sorted(channels)
    height, width = channels[names[0]].shape
    header = _header(names, width, height, metadata)
    blocks = []
    for y in range(0, height, _LINES):
        rows = [
            np.ascontiguousarray(channels[name][row], "<f4").tobytes()
            for row in range(y, min(y + _LINES, height))
            for name in names
        ]
        data = _zip(b"".join(rows))
        blocks.append(struct.pack("<ii", y, len(data)) + data)
    position = len(header) + 8 * len(blocks)
    offsets = []
    for block in blocks:
        offsets.append(struct.pack("<Q", position))
        position += len(block)
    path.write_bytes(b"".join([header, *offsets, *blocks]))


def _header(names: list[str], width: int, height: int, metadata: dict[str, str]) -> bytes:
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    listed = b"".join(
        name.encode() + b"\0" + struct.pack("<iB3xii", _FLOAT, 0, 1, 1) for name in names
    )
    attributes = {
        "channels": ("chlist", listed + b"\0"),
        "compression": ("compression", bytes([_ZIP])),
        "dataWindow": ("box2i", window),
        "displayWindow": ("box2i", window),
        "lineOrder": ("lineOrder", b"\0"),
        "pixelAspectRatio": ("float", struct.pack("<f", 1.0)),
        "screenWindowCenter": ("v2f", struct.pack("<ff", 0.0, 0.0)),
        "screenWindowWidth": ("float", struct.pack("<f", 1.0)),
        # By this Blender knows that channels are layers.
        "BlenderMultiChannel": ("string", b"Specula"),
        **{name: ("string", value.encode()) for name, value in metadata.items()},
    }
    packed = b"".join(
        name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
        for name, (kind, value) in attributes.items()
    )
    return struct.pack("<ii", _MAGIC, _VERSION | _LONG_NAMES) + packed + b"\0"


def _zip(data: bytes) -> bytes:
    """OpenEXR's ZIP: even bytes before odd ones, differences of neighbours, then deflate."""
    raw = np.frombuffer(data, np.uint8)
    ordered = np.concatenate([raw[0::2], raw[1::2]])
    difference = ordered.copy()
    difference[1:] = ordered[1:] - ordered[:-1] + np.uint8(128)
    packed = zlib.compress(difference.tobytes(), 6)
    return packed if len(packed) < len(data) else data
