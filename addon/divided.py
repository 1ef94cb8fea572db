# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders that are divided: some of a picture's samples, kept in a part file as the render goes.

    blender -b FILE -E SPECULA -f 1 -- --specula-part FILE [--specula-samples A:B]
                                       [--specula-checkpoint SECONDS]

The part file is written every minute, and in the end. If it is there already, the render goes on
where that ends. `{frame}` and `{layer}` in its name are the frame's number and the view layer.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import time
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path

import numpy as np

from . import cryptomatte, native
from .abi import RenderSettings
from .parts import Channels, Header, Part, PartError, read_part

# Fields of spc_render_settings that parts of one picture need not share, or that have their own
# place in a part's header.
_NOT_OF_THE_PICTURE = {"first_sample", "samples", "threads", "time_limit", "seed", "total_samples"}


@dataclass(frozen=True)
class Order:
    """What the command line asks for."""

    path: str
    samples: tuple[int, int] | None  # first and the one after the last; None: all
    checkpoint: float  # s

    def path_of(self, frame: int, layer: str) -> Path:
        name = self.path.replace("{frame}", f"{frame:04}").replace("{layer}", layer)
        return Path(name).absolute()


def order(arguments: list[str] | None = None) -> Order | None:
    """Of the arguments after `--`, by default those of the process; None if they ask for no part.

    Raises PartError for what makes no sense.
    """
    if arguments is None:
        arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    parser.add_argument("--specula-part")
    parser.add_argument("--specula-samples", type=_range)
    parser.add_argument("--specula-checkpoint", type=float, default=60.0)
    try:
        found, _ = parser.parse_known_args(arguments)
    except (argparse.ArgumentError, argparse.ArgumentTypeError) as error:
        raise PartError(str(error)) from None
    if found.specula_part is None:
        if found.specula_samples:
            raise PartError("--specula-samples needs --specula-part, the file for their sums")
        return None
    return Order(found.specula_part, found.specula_samples, found.specula_checkpoint)


def _range(text: str) -> tuple[int, int]:
    first, _, end = text.partition(":")
    if not (first.isdecimal() and end.isdecimal() and int(first) < int(end)):
        raise argparse.ArgumentTypeError(f"{text}: samples are FIRST:END, such as 0:64")
    return int(first), int(end)


def fingerprint(scene_desc, settings: RenderSettings) -> str:
    """A digest of all that the picture depends on, but for its seed and samples."""
    digest = hashlib.blake2b(digest_size=16)
    _digest(scene_desc, digest)
    values = native.struct_values(settings)
    _digest({k: v for k, v in values.items() if k not in _NOT_OF_THE_PICTURE}, digest)
    return digest.hexdigest()


def _digest(value, digest) -> None:
    if is_dataclass(value):
        for field in fields(value):
            item = getattr(value, field.name)
            if field.name == "path" and item is not None:
                item = Path(item).read_bytes() if Path(item).is_file() else item
            _digest(item, digest)
    elif isinstance(value, np.ndarray):
        digest.update(f"{value.dtype}{value.shape}".encode())
        digest.update(np.ascontiguousarray(value))
    elif isinstance(value, dict):
        for key in sorted(value):
            _digest(key, digest)
            _digest(value[key], digest)
    elif isinstance(value, set):
        _digest(sorted(value), digest)
    elif isinstance(value, (list, tuple)):
        digest.update(f"[{len(value)}".encode())
        for item in value:
            _digest(item, digest)
    else:
        digest.update(value if isinstance(value, bytes) else repr(value).encode())


class DividedRender:
    """One view layer's part under way."""

    def __init__(self, wanted: Order, path: Path, header: Header):
        """`header` has no ranges yet. Raises PartError if `path` holds another picture's part."""
        first, end = wanted.samples or (0, header.total_samples)
        if end > header.total_samples:
            raise PartError(f"samples {first}:{end} of {header.total_samples}")
        self._path, self._checkpoint = path, wanted.checkpoint
        self._header = header
        self._before: Part | None = None
        self._first, self._end = first, end
        self._kept = time.monotonic()
        if path.exists():
            self._go_on(read_part(path))

    def _go_on(self, part: Part) -> None:
        blank = Part(Header(**{**vars(self._header), "ranges": []}), bytearray())
        blank.check_same_picture(part)
        (first, end), *others = part.header.ranges
        if others or first != self._first or end > self._end:
            raise PartError(f"{self._path}: of other samples: {part.header.ranges}")
        self._before, self._first = part, end

    @property
    def before(self) -> Part | None:
        """What was there already."""
        return self._before

    def limit(self, settings: RenderSettings) -> None:
        """Sets the samples that are still to be taken; `samples` is 0 if there are none."""
        settings.total_samples = self._header.total_samples
        settings.first_sample, settings.samples = self._first, self._end - self._first

    def is_due(self) -> bool:
        return time.monotonic() - self._kept >= self._checkpoint

    def keep(self, session) -> Part:
        """Writes what there is by now. Raises PartError; the file is then as before."""
        self._kept = time.monotonic()
        sums, samples = session.export()
        ranges = [(self._first, self._first + samples)]
        part = Part(Header(**{**vars(self._header), "ranges": ranges}), sums, str(self._path))
        if self._before:
            part.add(self._before)
        part.write(self._path)
        return part


def header_of(scene_desc, settings, rows, view_layer, exposure: float) -> Header:
    """`rows`: the passes.RenderPass of the layer."""
    camera = scene_desc.camera
    return Header(
        version=native.version().split()[0],
        scene=fingerprint(scene_desc, settings),
        seed=settings.seed,
        total_samples=settings.samples,
        ranges=[],
        layer=view_layer.name,
        passes=[
            Channels(row.name, row.channels, row.source, exposure if row.is_light else 1.0)
            for row in rows
        ],
        frame=(camera.width, camera.height),
        corner=tuple(camera.crop[:2]),
        metadata=cryptomatte.metadata(view_layer.name, scene_desc.crypto_names),
    )
