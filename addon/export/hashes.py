# SPDX-License-Identifier: GPL-3.0-or-later
"""The hashes that Cycles' random numbers of objects come from: Bob Jenkins' lookup3 of one or two
words, and a string's by its characters."""

from __future__ import annotations

import numpy as np

_MASK = 0xFFFFFFFF
_ROUNDS = ((2, 1, 14), (0, 2, 11), (1, 0, 25), (2, 1, 16), (0, 2, 4), (1, 0, 14), (2, 1, 24))


def _mixed(words) -> np.ndarray:
    """Hash of (N,) words each, at most three, as uint32."""
    count = len(words)
    seed = (0xDEADBEEF + (count << 2) + 13) & _MASK
    state = [np.full_like(np.atleast_1d(words[0]), seed, dtype=np.uint32) for _ in range(3)]
    for i, word in enumerate(words):
        state[i] = state[i] + np.asarray(word, np.uint32)
    for to, by, turn in _ROUNDS:  # the last mixing of lookup3
        turned = (state[by] << np.uint32(turn)) | (state[by] >> np.uint32(32 - turn))
        state[to] = (state[to] ^ state[by]) - turned
    return state[2]


def hash_to_unit(values: np.ndarray) -> np.ndarray:
    """0 to 1, of uint32 values (N,)."""
    return _mixed((values,)) / np.float64(_MASK)


def hash_of_two(a: int, b: int) -> int:
    return int(_mixed((np.uint32(a), np.uint32(b)))[0])


def hash_with_to_unit(values: np.ndarray, word: int) -> np.ndarray:
    """0 to 1, of uint32 values (N,), each together with another one."""
    return _mixed((values, np.full_like(values, word))) / np.float64(_MASK)


def hash_of_text(text: str) -> int:
    value = 0
    for byte in text.encode():
        value = (37 * value + byte) & _MASK
    return value
