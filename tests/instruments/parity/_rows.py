# SPDX-License-Identifier: GPL-3.0-or-later
"""All rows, by name."""

from __future__ import annotations

from itertools import chain

from tests.instruments.parity import (
    _rows_closures,
    _rows_passes,
    _rows_scene,
    _rows_textures,
    _rows_values,
    _rows_zones,
)

ROWS = {
    row.name: row
    for row in chain(
        _rows_values.rows(),
        _rows_textures.rows(),
        _rows_closures.rows(),
        _rows_scene.rows(),
        _rows_passes.rows(),
        _rows_zones.rows(),
    )
}
