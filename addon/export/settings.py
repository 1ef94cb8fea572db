# SPDX-License-Identifier: GPL-3.0-or-later
"""Render settings: Specula's own where they are set, else Cycles', else the defaults."""

from __future__ import annotations

from .. import cryptomatte, native, passes
from ..abi import Method, RenderSettings
from . import compat

MOST_VIEWPORT_SAMPLES = 1 << 16  # where Cycles' setting asks for no end
PREVIEW_SAMPLES = 16  # of the little renders of material and world previews

# Field of spc_render_settings -> Cycles' property, which holds where Specula has no property of the
# field's name, or the artist leaves that at its default.
CYCLES = {
    "samples": "samples",
    "time_limit": "time_limit",
    "seed": "seed",
    "max_bounces": "max_bounces",
    "max_diffuse_bounces": "diffuse_bounces",
    "max_glossy_bounces": "glossy_bounces",
    "max_transmission_bounces": "transmission_bounces",
    "max_transparent_bounces": "transparent_max_bounces",
    "caustics_reflective": "caustics_reflective",
    "caustics_refractive": "caustics_refractive",
    "pixel_filter": "pixel_filter_type",
    "filter_width": "filter_width",
    "transparent_glass": "film_transparent_glass",
    "transparent_glass_roughness": "film_transparent_roughness",
}


# Fields with the names of `passes.names`.
CUSTOM = ("light_groups", "color_aovs", "value_aovs")


def export_settings(
    scene, is_preview: bool = False, view_layer=None, denoises: bool = False
) -> RenderSettings:
    """Settings for a final render of `scene`, or for a preview with few samples.

    `view_layer` may have its own number of samples, and says which passes it wants. With `denoises`
    the picture is rendered as denoisers expect it, with the passes that guide them.
    """
    defaults = native.render_settings(
        threads=scene.render.threads if scene.render.threads_mode == "FIXED" else 0,
        transparent_film=scene.render.film_transparent,
    )
    values = {}
    for name, default in native.struct_fields(defaults).items():
        if is_inherited(scene, name):
            values[name] = compat.cycles_value(scene, CYCLES[name], default)
        elif hasattr(scene.specula, name):
            values[name] = getattr(scene.specula, name)
    settings = native.changed(defaults, **values)
    if compat.cycles_value(scene, "use_animated_seed", False):
        settings.seed += scene.frame_current
    if view_layer:
        settings.samples = _layer_samples(scene, view_layer, settings.samples)
        wanted = set(passes.sources(view_layer)) | (set(passes.GUIDES) if denoises else set())
        settings.passes = passes.mask(wanted)
        settings.crypto_kinds = passes.mask(cryptomatte.kinds(view_layer))
        settings.crypto_ranks = cryptomatte.ranks(view_layer)
        for field, names in zip(CUSTOM, passes.names(view_layer).values(), strict=True):
            setattr(settings, field, passes.lines(names))
        settings.pass_alpha_threshold = view_layer.pass_alpha_threshold
    settings.for_denoiser = denoises
    if not is_preview and compat.cycles_value(scene, "use_adaptive_sampling", False):
        _export_adaptive(scene, settings)
    _export_mist(scene, view_layer, settings)
    if is_preview:
        settings.samples = min(settings.samples, PREVIEW_SAMPLES)
        settings.method = Method.PT  # others prepare for longer than so few samples take
    return settings


def viewport_settings(scene, view_layer) -> RenderSettings:
    """For the rendered viewport of `scene`: its own number of samples, no time limit."""
    settings = export_settings(scene, view_layer=view_layer)
    samples = scene.specula.viewport_samples or compat.cycles_value(scene, "preview_samples", 1024)
    settings.samples = samples or MOST_VIEWPORT_SAMPLES
    settings.time_limit = 0.0
    settings.passes = settings.crypto_kinds = 0
    for field in CUSTOM:
        setattr(settings, field, None)
    settings.noise_threshold = 0.0
    return settings


def method_label(scene) -> str:
    """The chosen method as the interface names it."""
    return _method_name(scene, scene.specula.method)


def _method_name(scene, identifier: str) -> str:
    return scene.specula.bl_rna.properties["method"].enum_items[identifier].name


def _unset(scene, name: str):
    """The value of a property of Specula's by which the artist leaves it to Cycles."""
    return scene.specula.bl_rna.properties[name].default


def is_inherited(scene, name: str) -> bool:
    """Whether a field of spc_render_settings has the value that it has in Cycles."""
    own = scene.specula
    return name in CYCLES and (not hasattr(own, name) or getattr(own, name) == _unset(scene, name))


def inherited_text(scene, name: str) -> str:
    """What holds for such a field, as a line for the interface: "0: as Cycles, 64"."""
    value = getattr(export_settings(scene), name)
    if name == "time_limit":
        value = f"{value:g} s" if value else "none"
    return f"{_unset(scene, name):g}: as Cycles, {value}"


def _export_adaptive(scene, settings: RenderSettings) -> None:
    threshold = compat.cycles_value(scene, "adaptive_threshold", 0.01)
    # 0: as Cycles chooses it.
    settings.noise_threshold = threshold or max(0.001, 1.0 / settings.samples)
    settings.min_samples = compat.cycles_value(scene, "adaptive_min_samples", 0)


def _export_mist(scene, view_layer, settings: RenderSettings) -> None:
    world = compat.world_of(scene, view_layer) if view_layer else scene.world
    if world is None:
        return
    mist = world.mist_settings
    settings.mist_start, settings.mist_depth = mist.start, mist.depth
    settings.mist_exponent = {"QUADRATIC": 2.0, "LINEAR": 1.0, "INVERSE_QUADRATIC": 0.5}[
        mist.falloff
    ]


def film_exposure(scene) -> float:
    """Factor on every colour of the film."""
    return compat.cycles_value(scene, "film_exposure", 1.0)


def _layer_samples(scene, view_layer, samples: int) -> int:
    """`samples` of the scene, unless the view layer has its own."""
    use = compat.cycles_value(scene, "use_layer_samples", "USE")
    use = use if isinstance(use, str) else ("USE", "BOUNDED", "IGNORE")[use]
    if view_layer.samples == 0 or use == "IGNORE":
        return samples
    return min(view_layer.samples, samples) if use == "BOUNDED" else view_layer.samples
