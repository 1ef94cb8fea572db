# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: the images that rows read, made when they are first asked for."""

from __future__ import annotations

import bpy
import numpy as np

TEXELS = 64
LEVELS = 0.3  # depth of the bumps' slopes


def image(name: str):
    """One of IMAGES."""
    return bpy.data.images.get(name) or IMAGES[name](name)


def _grid(height: int = TEXELS, width: int = TEXELS) -> tuple[np.ndarray, np.ndarray]:
    """Texel centres in [0, 1], (height, width): u, v."""
    v, u = np.mgrid[0:height, 0:width]
    return (u + 0.5) / width, (v + 0.5) / height


def _new(name: str, pixels: np.ndarray, floating: bool, data: bool, alpha: bool = False):
    """`pixels`: (H, W, 3 or 4), bottom row first."""
    height, width = pixels.shape[:2]
    made = bpy.data.images.new(
        name, width, height, alpha=alpha, float_buffer=floating, is_data=data
    )
    full = np.ones((height, width, 4), np.float32)
    full[..., : pixels.shape[2]] = pixels
    made.pixels.foreach_set(full.ravel())
    made.update()
    made.pack()
    return made


def _hues(name: str):
    """Smooth, periodic, of all hues and many brightnesses."""
    u, v = _grid()
    waves = [
        np.cos(2 * np.pi * (a * u + b * v + c)) for a, b, c in ((1, 0, 0), (1, 1, 0.3), (0, 1, 0.6))
    ]
    return _new(name, 0.5 + 0.45 * np.stack(waves, axis=-1), True, True)


def _ramp(name: str):
    u, _ = _grid()
    return _new(name, np.repeat(u[..., None], 3, axis=2), True, True)


def _photo(name: str):
    """8 bits, sRGB; no two quarters alike."""
    u, v = _grid(24, 32)
    checks = ((np.floor(4 * u) + np.floor(3 * v)) % 2)[..., None]
    return _new(name, np.stack([u, v, 1.0 - u], axis=-1) * (0.4 + 0.6 * checks), False, False)


def _cutout(name: str):
    """A disk of alpha 1 that fades to 0."""
    u, v = _grid()
    alpha = np.clip(3.0 - 6.0 * np.hypot(u - 0.5, v - 0.5), 0.0, 1.0)
    return _new(name, np.stack([u, v, 0.6 * np.ones_like(u), alpha], axis=-1), False, False, True)


def _waves() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Height and slopes in u and v."""
    u, v = _grid()
    x, y = 2 * np.pi * 3 * u, 2 * np.pi * 2 * v
    height = np.cos(x) * np.cos(y)
    return height, -np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y)


def _bumps(name: str):
    height, _, _ = _waves()
    return _new(name, np.repeat((0.5 + 0.4 * height)[..., None], 3, axis=2), True, True)


def _tilts(name: str):
    """A normal map."""
    _, u, v = _waves()
    normals = np.stack([-LEVELS * u, -LEVELS * v, np.ones_like(u)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return _new(name, 0.5 + 0.5 * normals, True, True)


def _directions() -> np.ndarray:
    """(32, 64, 3) unit, of an equirectangular map's texels."""
    u, v = _grid(32, 64)
    azimuth, elevation = 2 * np.pi * (0.5 - u), np.pi * (v - 0.5)
    flat = np.cos(elevation)
    return np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=-1)


def _sky(name: str):
    """Blue above, brown below, a wide glow: smooth enough for path tracing."""
    direction = _directions()
    up = direction[..., 2:]
    glow = np.clip(direction @ np.array([0.6, -0.5, 0.62]), 0.0, 1.0)[..., None] ** 8
    radiance = np.where(up > 0.0, (0.25, 0.35, 0.5), (0.2, 0.16, 0.12)) * (1.0 + 0.5 * np.abs(up))
    return _new(name, radiance + glow * (2.0, 1.6, 1.0), True, True)


def _sun(name: str):
    """The sky with one bright texel."""
    radiance = 0.5 * np.ones((32, 64, 3))
    radiance[26, 40] = 400.0
    return _new(name, radiance, True, True)


IMAGES = {
    "hues": _hues,
    "ramp": _ramp,
    "photo": _photo,
    "cutout": _cutout,
    "bumps": _bumps,
    "tilts": _tilts,
    "sky": _sky,
    "sun": _sun,
}


def ies_text(name: str):
    """A text block with a lamp that shines down, stronger at the side."""
    text = bpy.data.texts.get(name) or bpy.data.texts.new(name)
    angles = range(0, 181, 15)
    candela = [100 + 8 * angle if angle <= 90 else 0 for angle in angles]
    lines = ["IESNA:LM-63-1995", "TILT=NONE", f"1 1000 1 {len(angles)} 1 1 2 0 0 0", "1 1 10"]
    lines += [" ".join(map(str, angles)), "0", " ".join(map(str, candela))]
    text.from_string("\n".join(lines) + "\n")
    return text
