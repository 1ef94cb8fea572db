# SPDX-License-Identifier: GPL-3.0-or-later
"""Cryptomatte beside Cycles': the same identifiers, about the same shares, the same manifest."""

import json

import bpy
import numpy as np
from layers import render_layers
from scenes import add_camera, add_mesh, add_node, new_material, surface

SHARES = 0.06  # that two renders with as many samples may differ by in a pixel at an edge


def test_is_that_of_cycles(tmp_path):
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.world = None
    for index, (name, x) in enumerate((("left", -0.9), ("right", 0.8), ("behind", 0.1))):
        material = new_material(f"paint {index}")
        add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
        obj = add_mesh(name, material=material)
        obj.location, obj.rotation_euler = (x, 0, -index), (0.1, 0.2, 0.5 + index)
    bpy.data.objects["right"].parent = bpy.data.objects["left"]
    add_camera((0, 0, 5))
    for kind in ("object", "material", "asset"):
        setattr(layer, f"use_pass_cryptomatte_{kind}", True)
    scene.specula.samples = scene.cycles.samples = 512
    scene.cycles.use_adaptive_sampling = False
    (ours, metadata), (theirs, of_cycles) = (
        rendered(scene, engine, tmp_path) for engine in ("SPECULA", "CYCLES")
    )
    assert set(ours) == set(theirs)
    for kind, names in (("CryptoObject", 3), ("CryptoMaterial", 3), ("CryptoAsset", 2)):
        found, expected = (shares(layers, f"ViewLayer.{kind}") for layers in (ours, theirs))
        assert len(found) == names
        for identifier, share in found.items():
            assert np.abs(share - expected[identifier]).max() < SHARES
            assert abs(share.mean() - expected[identifier].mean()) < 0.01
    for key in (key for key in metadata if key.startswith("cryptomatte/")):
        if key.endswith("/manifest"):
            assert json.loads(metadata[key]).items() <= json.loads(of_cycles[key]).items()
        else:
            assert metadata[key] == of_cycles[key]


def rendered(scene, engine, tmp_path):
    scene.render.engine = engine
    return render_layers(tmp_path)


def shares(layers, name: str) -> dict[float, np.ndarray]:
    """Identifier -> (H, W) share of each pixel."""
    found = {}
    for level in range(3):
        pixels = layers[f"{name}{level:02}"]
        for rank in (0, 2):
            ids, share = pixels[..., rank], pixels[..., rank + 1]
            for identifier in np.unique(ids[share > 0]):
                part = np.where((ids == identifier) & (share > 0), share, 0.0)
                found[identifier] = found.get(identifier, 0.0) + part
    return found
