# SPDX-License-Identifier: GPL-3.0-or-later
"""Render settings: Specula's own where they are set, else Cycles', else the defaults."""

from __future__ import annotations

from . import compat
from .desc import Constraint, GlintMethod, LightTracing, Method, PixelFilter, RenderSettings

MOST_VIEWPORT_SAMPLES = 1 << 16  # where Cycles' setting asks for no end
PREVIEW_SAMPLES = 16  # of the little renders of material and world previews

# Field of RenderSettings = Specula's property -> (Cycles' property, "not set").
OVERRIDES = {
    "samples": ("samples", 0),
    "time_limit": ("time_limit", 0.0),
    "seed": ("seed", -1),
    "max_bounces": ("max_bounces", -1),
    "max_diffuse_bounces": ("diffuse_bounces", -1),
    "max_glossy_bounces": ("glossy_bounces", -1),
    "max_transmission_bounces": ("transmission_bounces", -1),
    "max_transparent_bounces": ("transparent_max_bounces", -1),
}

# Fields that are Cycles' own.
INHERITED = {
    "caustics_reflective": "caustics_reflective",
    "caustics_refractive": "caustics_refractive",
    "filter_width": "filter_width",
}


def export_settings(scene, is_preview: bool = False, view_layer=None) -> RenderSettings:
    """Settings for a final render of `scene`, or for a preview with few samples.

    `view_layer` may have its own number of samples.
    """
    own = scene.specula
    settings = RenderSettings(
        method=Method[own.method],
        light_tracing=LightTracing[own.light_tracing],
        constraint=Constraint[own.constraint],
        two_stage=own.two_stage,
        set_size=own.set_size,
        chain_family=own.chain_family,
        glint_method=GlintMethod[own.glint_method],
        threads=scene.render.threads if scene.render.threads_mode == "FIXED" else 0,
        transparent_film=scene.render.film_transparent,
    )
    for name, (cycles_name, _) in OVERRIDES.items():
        value = getattr(own, name)
        if is_inherited(scene, name):
            value = compat.cycles_value(scene, cycles_name, getattr(settings, name))
        setattr(settings, name, value)
    for name, cycles_name in INHERITED.items():
        default = getattr(settings, name)
        setattr(settings, name, type(default)(compat.cycles_value(scene, cycles_name, default)))
    settings.pixel_filter = _pixel_filter(scene, settings.pixel_filter)
    if compat.cycles_value(scene, "use_animated_seed", False):
        settings.seed += scene.frame_current
    if view_layer:
        settings.samples = _layer_samples(scene, view_layer, settings.samples)
    if is_preview:
        settings.samples = min(settings.samples, PREVIEW_SAMPLES)
        settings.light_tracing = LightTracing.OFF  # its pilot takes longer than so few samples
    return settings


def viewport_settings(scene, view_layer) -> RenderSettings:
    """For the rendered viewport of `scene`: its own number of samples, no time limit."""
    settings = export_settings(scene, view_layer=view_layer)
    samples = scene.specula.viewport_samples or compat.cycles_value(scene, "preview_samples", 1024)
    settings.samples = samples or MOST_VIEWPORT_SAMPLES
    settings.time_limit = 0.0
    return settings


def method_label(scene) -> str:
    """The chosen method as the interface names it."""
    return _method_name(scene, scene.specula.method)


def _method_name(scene, identifier: str) -> str:
    return scene.specula.bl_rna.properties["method"].enum_items[identifier].name


def is_inherited(scene, name: str) -> bool:
    """Whether the artist left a field of OVERRIDES to Cycles."""
    return getattr(scene.specula, name) == OVERRIDES[name][1]


def inherited_text(scene, name: str) -> str:
    """What holds for such a field, as a line for the interface: "0: as Cycles, 64"."""
    unset = OVERRIDES[name][1]
    value = getattr(export_settings(scene), name)
    if name == "time_limit":
        value = f"{value:g} s" if value else "none"
    return f"{unset:g}: as Cycles, {value}"


def film_exposure(scene) -> float:
    """Factor on every colour of the film."""
    return compat.cycles_value(scene, "film_exposure", 1.0)


def _pixel_filter(scene, default: PixelFilter) -> PixelFilter:
    value = compat.cycles_value(scene, "pixel_filter_type", default.name)
    return PixelFilter[value] if isinstance(value, str) else PixelFilter(value)


def _layer_samples(scene, view_layer, samples: int) -> int:
    """`samples` of the scene, unless the view layer has its own."""
    use = compat.cycles_value(scene, "use_layer_samples", "USE")
    use = use if isinstance(use, str) else ("USE", "BOUNDED", "IGNORE")[use]
    if view_layer.samples == 0 or use == "IGNORE":
        return samples
    return min(view_layer.samples, samples) if use == "BOUNDED" else view_layer.samples
