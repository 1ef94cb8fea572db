# SPDX-License-Identifier: GPL-3.0-or-later
import addon_utils
import bpy
import pytest

from specula import native
from specula.abi import Constraint, GlintMethod, LightTracing, Method, PixelFilter
from specula.export.settings import (
    PREVIEW_SAMPLES,
    export_settings,
    inherited_text,
    is_inherited,
    method_label,
)

CYCLES = {
    "samples": 77,
    "time_limit": 5.0,
    "seed": 3,
    "max_bounces": 9,
    "diffuse_bounces": 1,
    "glossy_bounces": 2,
    "transmission_bounces": 5,
    "transparent_max_bounces": 6,
    "caustics_reflective": False,
    "pixel_filter_type": "GAUSSIAN",
    "filter_width": 2.5,
}


@pytest.fixture
def scene():
    scene = bpy.context.scene
    scene.specula.samples = 0
    for name, value in CYCLES.items():
        setattr(scene.cycles, name, value)
    return scene


def check_cycles(settings):
    assert settings.samples == 77
    assert settings.time_limit == 5.0
    assert settings.seed == 3
    assert settings.max_bounces == 9
    assert settings.max_diffuse_bounces == 1
    assert settings.max_glossy_bounces == 2
    assert settings.max_transmission_bounces == 5
    assert settings.max_transparent_bounces == 6
    assert settings.caustics_reflective == 0
    assert settings.caustics_refractive == 1
    assert settings.pixel_filter == PixelFilter.GAUSSIAN
    assert settings.filter_width == 2.5


def test_settings_of_cycles_are_ours(scene):
    check_cycles(export_settings(scene))


@pytest.mark.parametrize(
    ("use", "own", "expected"),
    [
        ("USE", 0, 77),
        ("USE", 5, 5),
        ("USE", 500, 500),
        ("BOUNDED", 5, 5),
        ("BOUNDED", 500, 77),
        ("IGNORE", 5, 77),
    ],
)
@pytest.mark.parametrize("addon", [True, False])
def test_a_view_layer_has_its_own_samples(scene, use, own, expected, addon):
    scene.cycles.use_layer_samples = use
    scene.view_layers[0].samples = own
    if not addon:
        addon_utils.disable("cycles")
    try:
        settings = export_settings(scene, view_layer=scene.view_layers[0])
    finally:
        addon_utils.enable("cycles")
    assert settings.samples == expected


def test_settings_of_cycles_outlive_its_addon(scene):
    addon_utils.disable("cycles")
    try:
        assert not hasattr(scene, "cycles")
        check_cycles(export_settings(scene))
    finally:
        addon_utils.enable("cycles")


def test_our_settings_win(scene):
    own = {
        "samples": 8,
        "time_limit": 2.0,
        "seed": 0,
        "max_bounces": 0,
        "max_diffuse_bounces": 11,
        "max_glossy_bounces": 12,
        "max_transmission_bounces": 13,
        "max_transparent_bounces": 14,
        "set_size": 5,
        "two_stage": False,
        "chain_family": "TT",
    }
    for name, value in own.items():
        setattr(scene.specula, name, value)
    own["chain_family"] = b"TT"  # as C has it
    settings = export_settings(scene)
    assert {name: getattr(settings, name) for name in own} == own


def test_every_setting_is_a_field_of_the_core_with_the_same_choices(scene):
    own = {p.identifier: p for p in scene.specula.bl_rna.properties if not p.is_readonly}
    fields = native.struct_fields(native.render_settings())
    of_views = {"viewport_samples"}
    assert own.keys() - {"name"} - of_views <= fields.keys()
    for name, row in own.items():
        if row.type == "ENUM":
            choices = {item.identifier for item in row.enum_items}
            assert choices == set(native.enumeration(name).__members__)


def test_method_and_constraint(scene):
    assert export_settings(scene).method == Method.AUTO
    scene.specula.method, scene.specula.constraint = "PT", "ANGLE_DIFFERENCE"
    settings = export_settings(scene)
    assert (settings.method, settings.constraint) == (Method.PT, Constraint.ANGLE_DIFFERENCE)


def test_glints_are_searched_for_unless_another_method_is_asked_for(scene):
    assert export_settings(scene).glint_method == GlintMethod.SEARCH
    for method in GlintMethod:
        scene.specula.glint_method = method.name
        assert export_settings(scene).glint_method == method


def test_light_tracing_is_automatic_and_stays_so_with_any_method(scene):
    settings = export_settings(scene)
    assert (settings.method, settings.light_tracing) == (Method.AUTO, LightTracing.AUTO)
    for choice in LightTracing:
        scene.specula.light_tracing = choice.name
        assert export_settings(scene).light_tracing == choice
    for method in (Method.LT, Method.MNEE, Method.MNEE_BIASED):
        scene.specula.method = method.name
        assert export_settings(scene).method == method


def test_labels_are_those_of_the_interface(scene):
    assert method_label(scene) == "Automatic"
    scene.specula.method = "SMS_BIASED"
    assert method_label(scene) == "SMS Biased"
    scene.specula.method = "LT"
    assert method_label(scene) == "Light Tracing"
    scene.specula.method = "MNEE"
    assert method_label(scene) == "MNEE Unbiased"


def test_what_holds_where_nothing_is_set(scene):
    assert inherited_text(scene, "samples") == "0: as Cycles, 77"
    assert inherited_text(scene, "time_limit") == "0: as Cycles, 5 s"
    assert inherited_text(scene, "max_diffuse_bounces") == "-1: as Cycles, 1"
    scene.cycles.time_limit = 0.0
    assert inherited_text(scene, "time_limit") == "0: as Cycles, none"
    assert is_inherited(scene, "samples")
    scene.specula.samples = 1
    assert not is_inherited(scene, "samples")


def test_seed_follows_the_frame_only_if_animated(scene):
    scene.frame_set(10)
    assert export_settings(scene).seed == 3
    scene.cycles.use_animated_seed = True
    assert export_settings(scene).seed == 13


def test_threads_film_and_preview(scene):
    assert export_settings(scene).threads == 0
    scene.render.threads_mode, scene.render.threads = "FIXED", 3
    scene.render.film_transparent = True
    settings = export_settings(scene, is_preview=True)
    assert (settings.threads, settings.transparent_film) == (3, 1)
    assert settings.samples == PREVIEW_SAMPLES
    assert settings.method == Method.PT
