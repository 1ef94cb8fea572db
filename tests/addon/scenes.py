# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes as descriptions."""

import numpy as np

from specula.export import desc

IDENTITY = np.eye(3, 4, dtype=np.float32)


def emission(color, name="glow"):
    return desc.MaterialDesc(
        name,
        [
            desc.NodeDesc("Output", "output"),
            desc.NodeDesc("Emission", "emission", inputs={"Color": (*color, 1.0)}),
        ],
        [desc.LinkDesc(1, "Emission", 0, "Surface")],
    )


def triangle(name="triangle"):
    """In the plane z = 0, facing up; covers what `camera` sees."""
    positions = np.array([(-20, -10, 0), (20, -10, 0), (0, 30, 0)], np.float32)
    return desc.MeshDesc(name, positions, np.array([(0, 1, 2)], np.uint32))


def camera(width=8, height=4, crop=None, z=5.0):
    """At height `z`, looking down, 90 degrees wide."""
    transform = IDENTITY.copy()
    transform[2, 3] = z
    half = height / width
    return desc.CameraDesc(
        transform, width, height, crop or (0, 0, width, height), (-1, 1, -half, half), 0.1, 100
    )


def glowing_triangle(color=(0.5, 0.25, 0.125)) -> desc.SceneDesc:
    return desc.SceneDesc(
        materials=[emission(color)],
        meshes=[triangle()],
        instances=[desc.InstanceDesc("instance", 0, IDENTITY, [0])],
        camera=camera(),
    )
