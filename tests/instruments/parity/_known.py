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
    "geometry/hair_curves": "straight tubes of six sides, which shade each other where Cycles'"
    " ribbons, round by their normals alone, do not",
    "closure/glass/*ggx/roughness=1.0": "directions that no facet joins by refraction are black;"
    " Cycles has light there where it looks for lamps, more than comes in",
    "closure/glass/*=ggx/roughness=0.6": "as with a roughness of 1",
    "closure/principled/subsurface_half": "Blender 3.4 has a retroreflection over what is below",
    "closure/sheen/*=microfiber/roughness=0.2": "fits to the tables that Cycles interpolates",
    "closure/hair/*": "Cycles' lamps and samples disagree about where lobes end around the hair",
    "closure/toon/*": "samples of Blender 3.4 fade otherwise at the soft edge than its lamps do",
    "input/tangent/axis=[xy]": "zero on the flat floor, where Cycles shows its rounding",
    "input/light_path/is_glossy_ray": "lamps that Cycles looks for shine as the camera's ray sees"
    " them, whatever ray would hit them",
    "input/light_path/is_reflection_ray": "as input/light_path/is_glossy_ray",
    "input/light_path/glossy_depth": "as input/light_path/is_glossy_ray",
    "texture/image/alpha_mode=premul": "colours above their alpha, which premultiplied ones cannot"
    " have: Cycles cuts them where the image is packed",
    "texture/image/alpha": "Cycles multiplies by alpha in bytes",
    "texture/image/alpha_mode=straight": "as texture/image/alpha",
    "vector_math/divide": "by normals that are zero but for rounding",
    "closure/refraction/*=ggx/roughness=1.0": "as rough glass",
}

# What is wrong, or missing without a warning, and not yet mended; docs/parity.md has the numbers.
FAILING: dict[str, str] = {
    "input/wireframe/pixels": "lines are wider: a pixel is not as wide in Cycles",
    "texture/environment/interpolation=closest": "at the pole",
    "wavelength": "dark violets, and blocks at edges",
    "normal_map/blender_object": "a card's back that Cycles lights faintly is black",
    "color_ramp/constant": "edges of steps",
    "displacement/vector_tangent": "edges of the flat block go elsewhere by a pixel",
    "pass/transmission_color": "of rough refraction, a little darker",
    "setting/transparent_bounces=0": "Cycles' last transparent bounce still sees what glows",
}


def reason(name: str, table: dict[str, str]) -> str | None:
    """Of the first pattern that the row's name matches."""
    return next((why for pattern, why in table.items() if fnmatchcase(name, pattern)), None)
