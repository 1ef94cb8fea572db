# SPDX-License-Identifier: GPL-3.0-or-later
"""The core library: finding and loading it, and its scene and session as Python objects.

Knows nothing of Blender. Every failure is a `NativeError` with the library's own message.
"""

from __future__ import annotations

import ctypes
import functools
import os
import struct
from ctypes import byref, c_float, c_uint32, c_void_p
from enum import IntEnum
from pathlib import Path

from . import abi

LIBRARY_DIR_VARIABLE = "SPECULA_LIBRARY_DIR"
CPUINFO = Path("/proc/cpuinfo")

# Instruction levels in order of preference: flags of /proc/cpuinfo that a processor must have.
LEVELS = {
    "x86-64-v3": {"avx2", "fma", "bmi1", "bmi2", "f16c", "movbe", "abm"},
    "x86-64-v2": {"cx16", "lahf_lm", "popcnt", "sse4_1", "sse4_2", "ssse3"},
}


# Official Blenders hold an Embree 4 whose functions bear the names of our Embree 3's and, as the
# program's own libraries are, come first: DEEPBIND makes the core find those that it was linked
# with. Without it nothing fails, but rays hit nothing.
LOAD_MODE = os.RTLD_LOCAL | os.RTLD_NOW | os.RTLD_DEEPBIND


# A bitmap of one black pixel: headers of 14 and 40 bytes, a row of 4.
PROBE_IMAGE = b"BM" + struct.pack("<IIIIiiHHIIiiIII", 58, 0, 54, 40, 1, 1, 1, 24, *[0] * 6, 0)


class NativeError(Exception):
    """A call into the core failed, with a status, or the core cannot be loaded."""

    def __init__(self, message: str, status: int | None = None):
        super().__init__(message)
        self.status = status


def processor_flags(cpuinfo: str) -> set[str]:
    """Flags of the first processor in the text of /proc/cpuinfo."""
    for line in cpuinfo.splitlines():
        key, _, value = line.partition(":")
        if key.strip() == "flags":
            return set(value.split())
    return set()


def library_directories() -> list[Path]:
    """Where libraries are looked for, first match first."""
    override = os.environ.get(LIBRARY_DIR_VARIABLE)
    package = Path(__file__).resolve().parent / "lib"
    return [Path(override), package] if override else [package]


def supported_levels(flags: set[str]) -> list[str]:
    """The levels that the processor has, the highest first."""
    levels = [level for level, needed in LEVELS.items() if needed <= flags]
    if not levels:
        raise NativeError("Specula needs a processor with SSE4.2 (x86-64-v2) on Linux")
    return levels


def library_path(flags: set[str], directories: list[Path]) -> Path:
    """The library of the highest level that the processor has."""
    levels = supported_levels(flags)
    for directory in directories:
        for level in levels:
            path = directory / f"libspecula-{level}.so"
            if path.is_file():
                return path
    searched = ", ".join(str(directory) for directory in directories)
    raise NativeError(
        f"the core library is missing: no libspecula-{levels[0]}.so in {searched}; "
        f"install a packaged build of Specula or set {LIBRARY_DIR_VARIABLE}"
    )


@functools.cache
def load(path: Path) -> ctypes.CDLL:
    """The library at `path` with typed functions, if it speaks this addon's API version."""
    try:
        library = ctypes.CDLL(str(path), mode=LOAD_MODE)
        for name, (result, arguments) in abi.PROTOTYPES.items():
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
    except (OSError, AttributeError) as error:
        raise NativeError(f"the core library {path} cannot be loaded: {error}") from None
    version = library.spc_api_version()
    if version != abi.API_VERSION:
        raise NativeError(
            f"the core library {path} has API version {version}, "
            f"this addon needs {abi.API_VERSION}: install addon and library from one package"
        )
    return library


@functools.cache
def machine_flags() -> frozenset[str]:
    """Of this machine's processor."""
    return frozenset(processor_flags(CPUINFO.read_text()) if CPUINFO.exists() else ())


def library() -> ctypes.CDLL:
    """The library for this machine."""
    return load(library_path(set(machine_flags()), library_directories()))


def _check(status: int, what: str = "the core") -> None:
    """Raises NativeError for a failure; `what` is being made, should memory run out."""
    if status == abi.Status.OK:
        return
    if status == abi.Status.OUT_OF_MEMORY:
        raise NativeError(f"{what}: out of memory", status)
    message = library().spc_last_error().decode(errors="replace")
    raise NativeError(message or f"the core failed without a message (status {status})", status)


def version() -> str:
    """Versions of the core and of Embree, and the instruction level."""
    return library().spc_version_string().decode()


def node_kinds() -> dict[str, str]:
    """Node kinds that the core knows: kind -> its sockets and options, as the core lists them."""
    lines = library().spc_node_kinds().decode().splitlines()
    return {kind.strip(): sockets.strip() for kind, _, sockets in (s.partition(":") for s in lines)}


@functools.cache
def passes() -> list[tuple[str, str]]:
    """Of each `abi.Pass`: its channels, a letter each, and its name in Blender 5."""
    lines = library().spc_passes().decode().splitlines()
    return [tuple(line.split(" ", 1)) for line in lines]


def reads_image_files() -> bool:
    """Whether the core decodes image files. A packaged one does not: Blender does it instead."""
    image = abi.ImageDesc(name=b"probe", encoded_size=len(PROBE_IMAGE))
    image.encoded = ctypes.cast(PROBE_IMAGE, c_void_p)
    with Scene() as scene:
        try:
            scene.add("image", image)
        except NativeError:
            return False
    return True


def struct_fields(struct: abi.SizedStructure) -> dict:
    """A struct's fields by name, without its size, as ctypes has them."""
    return {name: getattr(struct, name) for name, *_ in struct._fields_[1:]}


def struct_values(struct: abi.SizedStructure) -> dict[str, int | float | list[int]]:
    """A struct's fields by name, without its size; arrays as lists."""
    values = struct_fields(struct)
    return {n: list(v) if isinstance(v, ctypes.Array) else v for n, v in values.items()}


def enumeration(field: str) -> type[IntEnum] | None:
    """The enumeration that a field bears the name of: of `method` Method; else None."""
    return getattr(abi, "".join(part.capitalize() for part in field.split("_")), None)


def changed(struct: abi.SizedStructure, **values) -> abi.SizedStructure:
    """A copy with other values in some fields; enumerators by name or number, text as str."""
    for name, value in values.items():
        if isinstance(value, str):
            choices = enumeration(name)
            values[name] = choices[value] if choices else value.encode()
    return type(struct)(**struct_fields(struct) | values)


def render_settings(**values) -> abi.RenderSettings:
    """The core's defaults but for `values`, given as to `changed`."""
    settings = abi.RenderSettings()
    library().spc_render_settings_init(byref(settings))
    return changed(settings, **values)


def _bytes(sums: bytearray):
    return (ctypes.c_char * len(sums)).from_buffer(sums)


def add_sums(sums: bytearray, other: bytearray, earlier: bool) -> None:
    """Adds those of other samples of the same picture; `earlier`: of samples before these."""
    add = library().spc_sums_add
    if len(sums) != len(other):
        raise NativeError("the sums are those of another picture")
    _check(add(_bytes(sums), _bytes(other), len(sums), earlier), "adding films")


def sums_extent(sums: bytearray) -> tuple[int, int]:
    """Width and height."""
    extent = (c_uint32 * 2)()
    _check(library().spc_sums_extent(_bytes(sums), len(sums), extent))
    return tuple(extent)


def read_sums(sums: bytearray, source, width: int, height: int):
    """As `Session.read`."""
    return _read_pass("sums", (_bytes(sums), len(sums)), source, width, height)


def _read_pass(owner: str, of: tuple, source, width: int, height: int):
    import numpy as np

    is_crypto = not isinstance(source, int)
    name = f"spc_{owner}_read_crypto" if is_crypto else f"spc_{owner}_read"
    channels = 4 if is_crypto else library().spc_pass_channels(source)
    pixels = np.zeros((height * width, channels), np.float32)
    pointer = pixels.ctypes.data_as(ctypes.POINTER(c_float))
    which = source if is_crypto else (source,)
    _check(getattr(library(), name)(*of, *which, pointer, pixels.size))
    return pixels


class Scene:
    """A scene of the core. Mutable until `commit`; free it with `close` or a with-statement."""

    def __init__(self):
        self.handle = c_void_p()
        _check(library().spc_scene_create(byref(self.handle)))

    @classmethod
    def edited(cls, before: Scene | None) -> Scene:
        """A scene that can keep parts of `before`, which is committed; None begins a series."""
        scene = cls.__new__(cls)
        scene.handle = c_void_p()
        _check(library().spc_scene_edit(before.handle if before else None, byref(scene.handle)))
        return scene

    def keep(self, kind: str, index: int) -> int:
        """Calls spc_scene_keep_<kind> for a part of the scene before; returns its index here."""
        kept = c_uint32()
        _check(getattr(library(), f"spc_scene_keep_{kind}")(self.handle, index, byref(kept)))
        return kept.value

    def add(self, kind: str, struct: abi.SizedStructure) -> int:
        """Calls spc_scene_add_<kind>; returns the new index."""
        index = c_uint32()
        add = getattr(library(), f"spc_scene_add_{kind}")
        what = f'{kind} "{struct.name.decode(errors="replace")}"'
        _check(add(self.handle, byref(struct), byref(index)), what)
        return index.value

    def set(self, kind: str, struct: abi.SizedStructure) -> None:
        """Calls spc_scene_set_<kind>."""
        _check(getattr(library(), f"spc_scene_set_{kind}")(self.handle, byref(struct)))

    def material_needs(self, material: int) -> list[tuple[abi.AttributeKind, str, bool]]:
        """Attributes that the material at that index reads: kind, name, whether with tangents."""
        needs = abi.MaterialNeeds()
        _check(library().spc_scene_material_needs(self.handle, material, byref(needs)))
        return [
            (abi.AttributeKind(need.kind), need.name.decode(), bool(need.tangents))
            for need in needs.attributes[: needs.attribute_count]
        ]

    def material_emission(self, material: int) -> tuple[tuple[float, float, float], bool]:
        """Mean of what the material at that index emits, and whether it varies."""
        mean, varies = (c_float * 3)(), c_uint32()
        call = library().spc_scene_material_emission
        _check(call(self.handle, material, mean, byref(varies)))
        return tuple(mean), bool(varies.value)

    def forecast(self, materials: list[int], role: int, visibility: int) -> dict:
        """spc_forecast by name, of an object with these materials."""
        forecast, count = abi.Forecast(), len(materials)
        indices = (c_uint32 * count)(*materials)
        ask = library().spc_scene_forecast
        _check(ask(self.handle, indices, count, visibility, role, byref(forecast)))
        return {
            "receives": bool(forecast.receives),
            "search": abi.CausticsSearch(forecast.search),
            "reason": forecast.reason.decode(),
            "glints": forecast.glints.decode(),
            "no_glints": forecast.no_glints.decode(),
        }

    def commit(self, threads: int = 0) -> None:
        """Ends the changes and builds what rendering needs, with `threads` threads (0: all)."""
        _check(library().spc_scene_commit(self.handle, threads), "building the scene")

    def begin_commit(self, threads: int = 0) -> None:
        """As `commit`, but on a thread of the core. Until `ends_commit` has told the end, the scene
        can only be closed, or cancelled."""
        _check(library().spc_scene_commit_start(self.handle, threads), "building the scene")

    def ends_commit(self, milliseconds: int) -> bool:
        """Whether the commit that has begun ends within that time, which is told once. Raises what
        has ended it."""
        ended = c_uint32()
        wait = library().spc_scene_commit_wait
        _check(wait(self.handle, milliseconds, byref(ended)), "building the scene")
        return bool(ended.value)

    def cancel_commit(self) -> None:
        """Asks a commit that has begun to stop; `close` waits until it has."""
        _check(library().spc_scene_commit_cancel(self.handle))

    def stats(self) -> dict[str, int | float]:
        """spc_scene_stats of a committed scene."""
        stats = abi.SceneStats()
        _check(library().spc_scene_get_stats(self.handle, byref(stats)))
        return struct_values(stats)

    def report(self) -> list[str]:
        """Lines about casters and fallbacks; empty before commit."""
        text = library().spc_scene_report(self.handle)
        return text.decode().splitlines() if text else []

    def close(self) -> None:
        library().spc_scene_destroy(self.handle)
        self.handle = c_void_p()

    def __enter__(self) -> Scene:
        return self

    def __exit__(self, *_) -> None:
        self.close()


class Session:
    """A running render of a committed scene, which must outlive it."""

    def __init__(self, scene: Scene, settings: abi.RenderSettings):
        """Starts rendering; returns at once."""
        self.handle = c_void_p()
        self.samples = settings.samples
        start = library().spc_render_start
        _check(start(scene.handle, byref(settings), byref(self.handle)), "starting the render")

    def wait(self, milliseconds: int) -> abi.RenderProgress:
        """Progress when the render ends or the time is over. Raises if the render failed."""
        progress = abi.RenderProgress()
        _check(library().spc_render_wait(self.handle, milliseconds, byref(progress)))
        if progress.state == abi.RenderState.FAILED:
            message = library().spc_last_error().decode(errors="replace")
            raise NativeError(message or "the render failed without a message")
        return progress

    def cancel(self) -> None:
        """Asks the workers to stop; `wait` tells when they have."""
        _check(library().spc_render_cancel(self.handle))

    def pause(self, paused: bool) -> None:
        """Holds the samples back, or lets them go on."""
        _check(library().spc_render_pause(self.handle, paused))

    def read(self, source, width: int, height: int):
        """A pass as it stands: (height * width, channels) float32, bottom row first.

        `source` is a pass, or the kind and the level of Cryptomatte.
        """
        return _read_pass("film", (self.handle,), source, width, height)

    def export(self) -> tuple[bytearray, int]:
        """The film's sums so far, and of how many samples of each pixel they are."""
        sums = abi.Sums()
        _check(library().spc_film_export(self.handle, byref(sums)), "keeping the film")
        return bytearray(ctypes.string_at(sums.data, sums.size)), sums.samples

    def stats(self) -> dict[str, int | float | list[int]]:
        """spc_render_stats of what is done so far."""
        stats = abi.RenderStats()
        _check(library().spc_render_get_stats(self.handle, byref(stats)))
        return struct_values(stats)

    def report(self) -> list[str]:
        """What the method has chosen, a line each; complete once samples are taken."""
        text = library().spc_render_report(self.handle)
        return text.decode().splitlines() if text else []

    def close(self) -> None:
        library().spc_session_destroy(self.handle)
        self.handle = c_void_p()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_) -> None:
        self.close()
