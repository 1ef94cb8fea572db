# SPDX-License-Identifier: GPL-3.0-or-later
"""Render settings: Specula's own where they are set, else Cycles', else the defaults."""

from __future__ import annotations

from . import compat
from .desc import Constraint, Method, PixelFilter, RenderSettings

AUTO_METHOD = Method.SMS_UNBIASED
PREVIEW_SAMPLES = 16  # of the little renders of material and world previews

# Field of RenderSettings that Specula overrides -> (its property, Cycles' property, "not set").
OVERRIDES = {
    "samples": ("samples", "samples", 0),
    "time_limit": ("time_limit", "time_limit", 0.0),
    "seed": ("seed", "seed", -1),
    "max_bounces": ("max_bounces", "max_bounces", -1),
    "max_diffuse_bounces": ("max_diffuse_bounces", "diffuse_bounces", -1),
    "max_glossy_bounces": ("max_glossy_bounces", "glossy_bounces", -1),
    "max_transmission_bounces": ("max_transmission_bounces", "transmission_bounces", -1),
    "max_transparent_bounces": ("max_transparent_bounces", "transparent_max_bounces", -1),
}

# Fields that are Cycles' own.
INHERITED = {
    "caustics_reflective": "caustics_reflective",
    "caustics_refractive": "caustics_refractive",
    "filter_width": "filter_width",
}


def export_settings(scene, is_preview: bool = False) -> RenderSettings:
    """Settings for a final render of `scene`, or for a preview with few samples."""
    own = scene.specula
    settings = RenderSettings(
        method=AUTO_METHOD if own.method == "AUTO" else Method[own.method],
        constraint=Constraint[own.constraint],
        two_stage=own.two_stage,
        set_size=own.set_size,
        threads=scene.render.threads if scene.render.threads_mode == "FIXED" else 0,
        transparent_film=scene.render.film_transparent,
    )
    for name, (own_name, cycles_name, unset) in OVERRIDES.items():
        value = getattr(own, own_name)
        if value == unset:
            value = compat.cycles_value(scene, cycles_name, getattr(settings, name))
        setattr(settings, name, value)
    for name, cycles_name in INHERITED.items():
        default = getattr(settings, name)
        setattr(settings, name, type(default)(compat.cycles_value(scene, cycles_name, default)))
    settings.pixel_filter = _pixel_filter(scene, settings.pixel_filter)
    if compat.cycles_value(scene, "use_animated_seed", False):
        settings.seed += scene.frame_current
    if is_preview:
        settings.samples = min(settings.samples, PREVIEW_SAMPLES)
    return settings


def film_exposure(scene) -> float:
    """Factor on every colour of the film."""
    return compat.cycles_value(scene, "film_exposure", 1.0)


def _pixel_filter(scene, default: PixelFilter) -> PixelFilter:
    value = compat.cycles_value(scene, "pixel_filter_type", default.name)
    return PixelFilter[value] if isinstance(value, str) else PixelFilter(value)
