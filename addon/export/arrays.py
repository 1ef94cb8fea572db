# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's collections as arrays."""

from __future__ import annotations

import numpy as np


def read(collection, attribute: str, shape: tuple[int, ...], dtype: type) -> np.ndarray:
    """`attribute` of every element; `shape` is that of one element's value, () for a scalar."""
    values = np.empty((len(collection), *shape), dtype)
    collection.foreach_get(attribute, values.ravel())
    return values
