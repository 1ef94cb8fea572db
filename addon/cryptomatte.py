# SPDX-License-Identifier: GPL-3.0-or-later
"""Cryptomatte: identifiers of names, and the metadata by which programs find names again.

As in "Cryptomatte Specification", version 1.2: MurmurHash3 of the name, its bits as a float.
"""

from __future__ import annotations

import functools
import json
import struct

from .abi import Crypto

PASS_NAMES = {
    Crypto.OBJECT: "CryptoObject",
    Crypto.MATERIAL: "CryptoMaterial",
    Crypto.ASSET: "CryptoAsset",
}
MOST_RANKS = 16
_WORD = 0xFFFFFFFF


def _rotated(x: int, bits: int) -> int:
    return (x << bits | x >> (32 - bits)) & _WORD


def murmur3(data: bytes) -> int:
    """MurmurHash3, x86, 32 bits, seed 0."""

    def mixed(block: int) -> int:
        return _rotated(block * 0xCC9E2D51 & _WORD, 15) * 0x1B873593 & _WORD

    state, whole = 0, len(data) // 4 * 4
    for (block,) in struct.iter_unpack("<I", data[:whole]):
        state = (_rotated(state ^ mixed(block), 13) * 5 + 0xE6546B64) & _WORD
    if whole < len(data):
        state ^= mixed(int.from_bytes(data[whole:], "little"))
    state ^= len(data)
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35)):
        state = (state ^ state >> shift) * factor & _WORD
    return state ^ state >> 16


@functools.lru_cache(maxsize=1 << 16)
def identifier(name: str) -> float:
    """The hash as a float whose bits it is, but for exponents that mean no number."""
    bits = murmur3(name.encode())
    exponent = min(max(bits >> 23 & 255, 1), 254)
    bits = bits & 0x807FFFFF | exponent << 23
    return struct.unpack("<f", struct.pack("<I", bits))[0]


def _hex(value: float) -> str:
    return struct.pack(">f", value).hex()


def asset_name(obj) -> str:
    """Of an object: the name of the ancestor that has no parent."""
    while obj.parent:
        obj = obj.parent
    return obj.name


def kinds(view_layer) -> list[Crypto]:
    """Those that a view layer asks for."""
    return [
        kind
        for kind in PASS_NAMES
        if getattr(view_layer, f"use_pass_cryptomatte_{kind.name.lower()}")
    ]


def ranks(view_layer) -> int:
    """How many identifiers a pixel shows: an even number, since a pass has two."""
    return (min(MOST_RANKS, view_layer.pass_cryptomatte_depth) + 1) // 2 * 2


def metadata(layer: str, names: dict[Crypto, set[str]]) -> dict[str, str]:
    """Of a file that has the view layer's passes; `names` are those that may show in each."""
    found = {}
    for kind, shown in names.items():
        name = f"{layer}.{PASS_NAMES[kind]}"
        key = f"cryptomatte/{murmur3(name.encode()):08x}"[: len("cryptomatte/") + 7]
        manifest = {item: _hex(identifier(item)) for item in sorted(shown)}
        found |= {
            f"{key}/name": name,
            f"{key}/hash": "MurmurHash3_32",
            f"{key}/conversion": "uint32_to_float32",
            f"{key}/manifest": json.dumps(manifest, ensure_ascii=False, separators=(",", ":")),
        }
    return found
