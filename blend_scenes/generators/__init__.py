# SPDX-License-Identifier: GPL-3.0-or-later
"""Generators of the example scenes: one module each, with a `build()` that fills an empty file."""

SCENES = (
    "reflective_plane",
    "refractive_sphere",
    "swimming_pool",
    "ring",
    "cornell",
    "shoes",
    "kettle",
    "displaced",
    "slab",
    "shop_window",
)
