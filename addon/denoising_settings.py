# SPDX-License-Identifier: GPL-3.0-or-later
"""How pictures are denoised: Cycles' settings, of final renders and of the viewport."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from . import passes
from .abi import Pass
from .denoising import Denoising, DenoisingError, Prefilter, Quality, load
from .export import compat
from .export.log import ExportLog


def denoising_of(scene, view_layer, log: ExportLog) -> Callable | None:
    """Reads Combined as passes.RenderPass.read does, denoised; None if that is not to be.

    Where Cycles' settings ask for it and this Blender has no denoiser, `log` is told.
    """
    if not passes.wants_denoising(scene, view_layer):
        return None
    try:
        denoising = _by_settings(scene, "denoising_", "RGB_ALBEDO_NORMAL", "ACCURATE", "HIGH")
    except DenoisingError as error:
        log.warn("denoising", f"{error}, the picture is as it was rendered")
        return None

    def read(session, width: int, height: int) -> np.ndarray:
        def picture(source: Pass) -> np.ndarray:
            return session.read(source, width, height).reshape(height, width, -1)

        return denoising.denoised(picture(Pass.COMBINED), picture).reshape(height * width, -1)

    return read


def viewport_denoising(scene) -> Denoising | None:
    """How the rendered viewport is denoised; None if that is not to be. Raises DenoisingError if
    this Blender has no denoiser."""
    if not compat.cycles_value(scene, "use_preview_denoising", False):
        return None
    return _by_settings(
        scene,
        "preview_denoising_",
        "RGB_ALBEDO",
        "FAST",
        "FAST",
        first_sample=max(1, compat.cycles_value(scene, "preview_denoising_start_sample", 1)),
    )


def _by_settings(
    scene, prefix: str, inputs: str, prefilter: str, quality: str, **more
) -> Denoising:
    """By Cycles' properties whose names begin with `prefix`, or these defaults."""
    inputs = _choice(scene, f"{prefix}input_passes", inputs)
    guides = {"ALBEDO": Pass.DENOISING_ALBEDO, "NORMAL": Pass.DENOISING_NORMAL}
    return Denoising(
        load(compat.library_folders()),
        tuple(source for name, source in guides.items() if name in inputs),
        Prefilter(_choice(scene, f"{prefix}prefilter", prefilter)),
        Quality[_choice(scene, f"{prefix}quality", quality)],
        **more,
    )


def _choice(scene, name: str, default: str) -> str:
    """An enumeration of Cycles' by its identifier; with the Cycles addon off, the default."""
    value = compat.cycles_value(scene, name, default)
    return value if isinstance(value, str) else default
