# SPDX-License-Identifier: GPL-3.0-or-later
"""How a final render is denoised: Cycles' settings, and the passes that guide the denoiser."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from . import passes
from .abi import Pass
from .denoising import Denoiser, DenoisingError, Prefilter, Quality, load
from .export import compat
from .export.log import ExportLog


def denoising_of(scene, view_layer, log: ExportLog) -> Callable | None:
    """Reads Combined as passes.RenderPass.read does, denoised; None if that is not to be.

    Where Cycles' settings ask for it and this Blender has no denoiser, `log` is told.
    """
    if not passes.wants_denoising(scene, view_layer):
        return None
    try:
        library = load(compat.library_folders())
    except DenoisingError as error:
        log.warn("denoising", f"{error}, the picture is as it was rendered")
        return None
    inputs = _choice(scene, "denoising_input_passes", "RGB_ALBEDO_NORMAL")
    prefilter = Prefilter(_choice(scene, "denoising_prefilter", "ACCURATE"))
    quality = Quality[_choice(scene, "denoising_quality", "HIGH")]

    def read(session, width: int, height: int) -> np.ndarray:
        def picture(source: Pass) -> np.ndarray:
            return session.read(source, width, height).reshape(height, width, -1)

        combined = picture(Pass.COMBINED)
        albedo = picture(Pass.DENOISING_ALBEDO) if "ALBEDO" in inputs else None
        normal = picture(Pass.DENOISING_NORMAL) if "NORMAL" in inputs else None
        with Denoiser(library) as denoiser:
            color = denoiser.denoise(combined[..., :3], albedo, normal, prefilter, quality)
        combined[..., :3] = color
        return combined.reshape(height * width, -1)

    return read


def _choice(scene, name: str, default: str) -> str:
    """An enumeration of Cycles' by its identifier; with the Cycles addon off, the default."""
    value = compat.cycles_value(scene, name, default)
    return value if isinstance(value, str) else default
