# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders of the open file, read back pass by pass."""

from __future__ import annotations

import subprocess

import bpy
import numpy as np


def render_layers(tmp_path) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Renders the open file.

    Returns 'layer.pass' -> (H, W, C) float32, bottom row first, and the metadata of the file.
    """
    scene = bpy.context.scene
    image_settings = scene.render.image_settings
    if hasattr(image_settings, "media_type"):
        image_settings.media_type = "MULTI_LAYER_IMAGE"
    image_settings.file_format = "OPEN_EXR_MULTILAYER"
    image_settings.color_depth = "32"
    scene.render.filepath = str(tmp_path / "render.exr")
    bpy.ops.render.render(write_still=True)
    return read_layers(tmp_path / "render.exr")


# Run by Debian's Python, which has OpenImageIO: PyPI's bpy has no reader of multilayer files.
READER = """
import sys
import numpy as np
import OpenImageIO as oiio
image = oiio.ImageInput.open(sys.argv[1])
arrays, part = {}, 0
while image.seek_subimage(part, 0):  # Blender 5.0 gives every pass a part of its own
    spec = image.spec()
    arrays[f"pixels {part}"] = image.read_image("float").reshape(
        spec.height, spec.width, spec.nchannels)[::-1]
    arrays[f"channels {part}"] = spec.channelnames
    arrays[f"metadata {part}"] = [(a.name, str(a.value)) for a in spec.extra_attribs]
    part += 1
np.savez(sys.argv[2], **arrays)
"""


def read_layers(path) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Passes and metadata of a multilayer EXR."""
    arrays = path.with_suffix(".npz")
    subprocess.run(["/usr/bin/python3", "-c", READER, str(path), str(arrays)], check=True)
    content = np.load(arrays)
    layers = {}
    for part in range(len(content.files) // 3):
        groups: dict[str, list[int]] = {}
        for index, channel in enumerate(content[f"channels {part}"]):
            groups.setdefault(str(channel).rpartition(".")[0], []).append(index)
        pixels = content[f"pixels {part}"]
        layers |= {name: pixels[:, :, indices] for name, indices in groups.items()}
    return layers, dict(content["metadata 0"].tolist())
