# SPDX-License-Identifier: GPL-3.0-or-later
"""Identifiers and metadata of Cryptomatte, against published values and Blender's."""

import struct

import pytest

from specula import cryptomatte
from specula.abi import Crypto


# From the Cryptomatte specification's and SMHasher's tables of MurmurHash3_x86_32 with seed 0.
@pytest.mark.parametrize(
    ("text", "expected"),
    [(b"", 0), (b"hello", 0x248BFA47), (b"hello, world", 0x149BBB7F)],
)
def test_murmur3(text, expected):
    assert cryptomatte.murmur3(text) == expected


def test_identifiers_are_numbers():
    bits = struct.unpack("<I", struct.pack("<f", cryptomatte.identifier("Cube")))[0]
    assert bits == 0xA8FCE865  # as Blender's Cycles writes it
    for i in range(2000):
        value = cryptomatte.identifier(f"object {i}")
        assert value == value and 1.1754943508222875e-38 <= abs(value) < float("inf")


def test_metadata_is_what_blender_looks_for():
    found = cryptomatte.metadata("ViewLayer", {Crypto.OBJECT: {"Cube"}, Crypto.ASSET: {"Cube"}})
    assert found["cryptomatte/542cafa/name"] == "ViewLayer.CryptoObject"
    assert found["cryptomatte/aa21542/name"] == "ViewLayer.CryptoAsset"
    assert found["cryptomatte/542cafa/manifest"] == '{"Cube":"a8fce865"}'
