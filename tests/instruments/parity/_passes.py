# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes of Blender's multilayer files, as pictures that can be compared.

Run as a program by Debian's Python, it is a reader of such files, which PyPI's bpy has not:
FILE PASS OUT writes the pass's channels in the order of their letters.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

PYTHON = "/usr/bin/python3"
ROOT = Path(__file__).resolve().parents[3]
FARTHEST = 12.0  # m: beyond the stage; what is not hit has a depth of 1e10
SIGNED = {"Normal", "Denoising Normal", "Position"}
DEPTHS = {"Depth", "Denoising Depth"}


def comparable(name: str, pixels: np.ndarray) -> np.ndarray:
    """Of one brightness: depths end behind the stage, what may be negative is raised."""
    if name in DEPTHS:
        return np.minimum(pixels, FARTHEST)
    return 0.5 + 0.5 * pixels if name in SIGNED else pixels


def read(path: str, name: str, size: tuple[int, int]) -> np.ndarray:
    """(H, W, 3) float64 of a pass, bottom row first; 0 if the file has none of this name."""
    found = f"{path}.npy"
    env = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    command = [PYTHON, "-m", __name__, path, name, found]
    subprocess.run(command, check=True, env=env, cwd=ROOT)
    pixels = np.load(found)
    os.remove(found)
    if pixels.size == 0:
        return np.zeros((*size, 3))
    return np.broadcast_to(pixels[..., :3], (*pixels.shape[:2], 3)).astype(np.float64)


def channels(path: str, name: str) -> np.ndarray:
    """(H, W, C) float32, red, x or u first; empty if there is no such pass."""
    import OpenImageIO as oiio

    file = oiio.ImageInput.open(path)
    part = 0
    while file.seek_subimage(part, 0):  # Blender 5.0 gives every pass a part of its own
        names = file.spec().channelnames
        wanted = {
            channel[-1]: index
            for index, channel in enumerate(names)
            if channel.rpartition(".")[0].endswith(f".{name}")
        }
        if wanted:
            order = [wanted[letter] for letter in "RGBXYZUVA" if letter in wanted]
            return np.asarray(file.read_image("float"))[::-1][..., order]
        part += 1
    return np.empty(0, np.float32)


if __name__ == "__main__":
    np.save(sys.argv[3], channels(sys.argv[1], sys.argv[2]))
