# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows that differ, by pattern of their names (fnmatch), and why.

A row that is no longer different is told on the page: its line can go.
"""

from __future__ import annotations

from fnmatch import fnmatchcase

# What Specula does otherwise on purpose; docs/nodes.md and docs/supported.md say more.
BY_DESIGN: dict[str, str] = {
    "setting/clamp_*": "nothing is clamped: what the setting takes away stays",
    "setting/filter_glossy": "no filter for glossy paths",
    "setting/light_threshold": "no threshold: faint light is not left out at random",
    "bump/object_coordinates": "from behind, the front's relief is seen, whatever places it;"
    " Cycles turns it over where coordinates do, and not where an attribute does",
    "bump/on_bump": "as bump/object_coordinates",
    "displacement/image/both": "as bump/object_coordinates: here Cycles turns over what any"
    " coordinate places",
    "geometry/hair_curves": "straight tubes of four sides, which shade each other where Cycles'"
    " ribbons, round by their normals alone, do not",
    "closure/glass/*ggx/roughness=1.0": "directions that no facet joins by refraction are black;"
    " Cycles has light there where it looks for lamps, more than comes in",
    "closure/glass/*=ggx/roughness=0.6": "as with a roughness of 1",
    "closure/principled/subsurface_half": "Blender 3.4 has a retroreflection over what is below",
    "closure/sheen/*=microfiber/roughness=0.2": "fits to the tables that Cycles interpolates",
    "closure/hair/*": "Cycles' lamps and samples disagree about where lobes end around the hair",
    "closure/toon/*": "samples of Blender 3.4 fade otherwise at the soft edge than its lamps do",
    "closure/refraction/*=ggx/roughness=1.0": "as rough glass",
}

# What is wrong, or missing without a warning, and not yet mended; docs/parity.md has the numbers.
FAILING: dict[str, str] = {
    "displacement/vector_tangent": "edges of the flat block go elsewhere by a pixel",
    "pass/transmission_color": "of rough refraction, a little darker",
    "setting/transparent_bounces=0": "Cycles' last transparent bounce still sees what glows",
}


def reason(name: str, table: dict[str, str]) -> str | None:
    """Of the first pattern that the row's name matches."""
    return next((why for pattern, why in table.items() if fnmatchcase(name, pattern)), None)
