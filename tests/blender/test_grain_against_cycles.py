# SPDX-License-Identifier: GPL-3.0-or-later
"""Without a Tangent the grain of a surface goes around the middle of its mesh, as in Cycles.

That need not be the object's origin. A lamp without size lights it, so that there is no noise.
"""

import numpy as np
import pytest
import tiles
from scenes import add_camera, add_light, add_mesh, add_node, new_material, surface

SIZE = 24
TOLERANCE = 0.01  # of 1 + the value: highlights change by a part of that within the filter
CORNER = [(0, 0, 0), (2, 0, 0), (2, 3, 0), (0, 3, 0)]  # whose middle is not its origin
SHADERS = {
    "glossy": ("ShaderNodeBsdfAnisotropic", {"Roughness": 0.4, "Anisotropy": 0.7}),
    "turned": ("ShaderNodeBsdfAnisotropic", {"Roughness": 0.4, "Anisotropy": 0.7, "Rotation": 0.1}),
    "principled": (
        "ShaderNodeBsdfPrincipled",
        {"Roughness": 0.5, "Anisotropic": 0.8, "Metallic": 1.0},
    ),
}


@pytest.mark.parametrize("shader", SHADERS)
def test_goes_around_the_middle(shader, tmp_path):
    kind, inputs = SHADERS[shader]
    brushed = new_material("Brushed")
    node = add_node(brushed, kind, surface(brushed))
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    plane = add_mesh("Plane", CORNER, material=brushed)
    plane.location, plane.rotation_euler = (-1, -1.5, 0), (0.1, 0.2, 0.3)
    add_light("POINT", energy=300, shadow_soft_size=0).location = (0.6, 0.4, 2)
    camera = add_camera((0, 0, 5))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 3
    scene = tiles.prepare(SIZE)
    scene.specula.samples = scene.cycles.samples = 1
    scene.cycles.max_bounces = 0
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    ours, theirs = (tiles.render(engine, tmp_path) for engine in ("SPECULA", "CYCLES"))
    inside = np.s_[4:-4, 4:-4]
    assert theirs[inside].std() > 0.1 * theirs[inside].mean()
    off = np.abs(ours - theirs)[inside] > TOLERANCE * (1 + theirs[inside])
    assert off.mean() < 0.02
