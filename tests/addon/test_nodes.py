# SPDX-License-Identifier: GPL-3.0-or-later
"""The addon's table of nodes and the core's list of kinds name the same things."""

import re

import pytest

from specula import native
from specula.export.nodes import NODES

ROWS = {row.kind: row for row in NODES.values()}
# Set by functions of the table rather than by its columns.
CONSTANT_INPUTS = {
    "rgb": {"Color"},
    "value": {"Value"},
    "normal": {"Direction"},
    "object_info": {"Material Index"},
    "image_texture": {"Blend"},
}
CONSTANT_ARRAYS = {"image_texture": {"Tiles"}, "texture_coordinate": {"Object"}}


def listed(line: str) -> dict[str, set[str]]:
    """'in', 'out', 'option' and 'array' -> names in a line of native.node_kinds().

    A line reads `in Socket:type ... out Socket:type ... option name=A|B ... array name:COLUMNS
    ...`; sockets have spaces.
    """
    names = {"in": set(), "out": set(), "option": set(), "array": set()}
    sections = r"\b(in|out|option|array) (.*?)(?= in | out | option | array |$)"
    for section, text in re.findall(sections, line):
        pattern = r"(\w+)=" if section == "option" else r"([^:]+?):\w+\s*"
        names[section] |= {name.strip() for name in re.findall(pattern, text)}
    return names


def test_kinds():
    outputs = {"output", "aov_output"}  # which the export begins with
    assert set(native.node_kinds()) == set(ROWS) | outputs


@pytest.mark.parametrize("kind", sorted(ROWS))
def test_sockets_and_options(kind):
    row = ROWS[kind]
    names = listed(native.node_kinds()[kind])
    assert names["in"] == set(row.inputs) | CONSTANT_INPUTS.get(kind, set())
    assert names["out"] == set(row.outputs)
    assert names["option"] == {
        *(path.split(".")[-1] for path in row.options),
        *row.fixed_options,
    }
    assert names["array"] == set(row.arrays) | CONSTANT_ARRAYS.get(kind, set())
