# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of two renderers: read from Blender's files, drawn beside each other."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from tests.instruments.bench import _metrics
from tests.instruments.pairs.comparison import DARK, Picture

STRONG = 0.5  # (a - b) / (a + b) that is shown in full colour: three times the light


def read(path: Path) -> dict[str, np.ndarray]:
    """`Combined`, and `Caustics` if it is there, of a multilayer EXR file of Blender's."""
    file = oiio.ImageInput.open(str(path))
    if not file:
        raise OSError(f"{path}: {oiio.geterror()}")
    passes: dict[str, np.ndarray] = {}
    part = 0
    while file.seek_subimage(part, 0):  # Blender 5.0 gives every pass a part of its own
        names = file.spec().channelnames
        pixels = np.asarray(file.read_image("float"), np.float64)[::-1]
        for name in ("Combined", "Caustics"):
            found = [names.index(n) for n in names if re.search(rf"\b{name}\.[RGBXYZ]$", n)]
            if len(found) >= 3:
                passes.setdefault(name, ordered(pixels, names, found))
        part += 1
    file.close()
    if "Combined" not in passes:
        raise OSError(f"{path}: no pass Combined")
    return passes


def ordered(pixels: np.ndarray, names: list[str], found: list[int]) -> np.ndarray:
    """(H, W, 3): red first, whatever the order in the file."""
    by_letter = {names[index][-1]: index for index in found}
    letters = "RGB" if "R" in by_letter else "XYZ"
    return pixels[..., [by_letter[letter] for letter in letters]]


def draw(
    folder: Path, stem: str, specula: Picture | None, cycles: Picture | None
) -> dict[str, str]:
    """Writes PNG files into folder/pictures, both of one exposure; returns label -> path."""
    shown = {}
    measure = next((p for p in (cycles, specula) if p and np.isfinite(p.mean).all()), None)
    exposure = _metrics.exposure(measure.mean) if measure else 1.0
    for label, picture in (("Specula", specula), ("Cycles", cycles)):
        if picture:
            shown[label] = _metrics.display(np.nan_to_num(picture.mean), exposure)
    if specula and cycles:
        shown["difference"] = difference(specula.mean, cycles.mean)
    paths = {}
    for label, image in shown.items():
        paths[label] = f"pictures/{stem}-{label.lower()}.png"
        write_png(folder / paths[label], image)
    return paths


def difference(image: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """sRGB: white where both are alike, red where `image` is brighter, blue where it is darker,
    magenta where it is not finite."""
    light, other = image @ _metrics.LUMINANCE, expected @ _metrics.LUMINANCE
    total = np.abs(light) + np.abs(other) + DARK * max(float(np.abs(other).mean()), 1e-30)
    amount = np.clip((light - other) / total / STRONG, -1.0, 1.0)
    brighter, darker = np.maximum(amount, 0.0), np.maximum(-amount, 0.0)
    shown = np.stack([1.0 - darker, 1.0 - darker - brighter, 1.0 - brighter], axis=-1)
    shown[~np.isfinite(light)] = (1.0, 0.0, 1.0)
    return shown.astype(np.float32)


def write_png(path: Path, image: np.ndarray) -> None:
    """Of sRGB values, bottom row first."""
    path.parent.mkdir(parents=True, exist_ok=True)
    pixels = np.ascontiguousarray(np.round(255.0 * image[::-1]), np.uint8)
    output = oiio.ImageOutput.create(str(path))
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint8")
    if not output or not output.open(str(path), spec) or not output.write_image(pixels):
        raise OSError(f"{path}: {output.geterror() if output else oiio.geterror()}")
    output.close()


def replace(path: Path, text: str) -> None:
    """Whoever reads it meanwhile sees the old one."""
    fresh = path.with_suffix(".new")
    fresh.write_text(text)
    fresh.replace(path)
