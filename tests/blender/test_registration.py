# SPDX-License-Identifier: GPL-3.0-or-later
from types import SimpleNamespace

import bpy
import pytest
from scenes import add_mesh, add_node, new_image, new_material, surface

import specula
from specula import abi, forecast, native, passes, statistics, ui

OWNERS = (bpy.types.Scene, bpy.types.Object, bpy.types.Light, bpy.types.World, bpy.types.ViewLayer)


def is_registered() -> bool:
    return bpy.types.RenderEngine.bl_rna_get_subclass_py("SPECULA") is not None


def compatible_panels():
    return {
        panel.__name__
        for panel in bpy.types.Panel.__subclasses__()
        if "SPECULA" in getattr(panel, "COMPAT_ENGINES", ())
    }


def test_register_unregister_register():
    shared = {panel.__name__ for panel in ui.shared_panels()}
    before = compatible_panels()
    assert shared <= before
    specula.unregister()
    try:
        assert not is_registered()
        assert not any("specula" in owner.bl_rna.properties for owner in OWNERS)
        assert not shared & compatible_panels()
    finally:
        specula.register()
    assert is_registered()
    assert all("specula" in owner.bl_rna.properties for owner in OWNERS)
    assert compatible_panels() == before


def test_panels_that_an_artist_needs():
    """Those without COMPAT_ENGINES, such as RENDER_PT_context, show in any engine."""
    assert compatible_panels() >= {
        "RENDER_PT_format",
        "RENDER_PT_output",
        "EEVEE_MATERIAL_PT_context_material",
        "EEVEE_MATERIAL_PT_surface",
        "EEVEE_WORLD_PT_surface",
        "DATA_PT_camera",
        "DATA_PT_lens",
    }
    assert not ui.EXCLUDED_PANELS & compatible_panels()


class Recorder:
    """A layout that checks that every property which a panel shows exists."""

    def __init__(self):
        self.shown = []
        self.texts = []

    def prop(self, owner, name, **_):
        assert hasattr(owner, name), f"{owner} has no {name}"
        self.shown.append(name)

    def label(self, text="", **_):
        self.texts.append(text)

    def separator(self):
        pass

    def prop_search(self, owner, name, source, names, **_):
        assert hasattr(source, names), f"{source} has no {names}"
        self.prop(owner, name)

    def template_list(self, kind, identifier, owner, name, *_, **__):
        self.prop(owner, name)

    def operator(self, name, **_):
        return SimpleNamespace()

    def menu(self, name, **_):
        pass

    def template_node_view(self, tree, node, socket):
        assert socket.node == node
        self.shown.append("nodes")

    def column(self, **_):
        return self

    row = box = split = column


class Context:
    engine = "SPECULA"

    def __init__(self, **members):
        self.scene = bpy.context.scene
        self.view_layer = bpy.context.view_layer
        self.light = self.object = self.world = self.material = self.camera = None
        screens = bpy.data.screens
        areas = [area for screen in screens for area in screen.areas if area.type == "VIEW_3D"]
        self.space_data = areas[0].spaces[0]
        self.space_data.shading.type = "RENDERED"
        self.__dict__.update(members)


def draw(panel, context):
    """Calls the panel's own draw with a recording layout, which it returns."""

    class Drawn:
        layout = Recorder()
        column = ui.panel.SpeculaPanel.column

    for name in ("COMMON", "PROPERTIES", "LABELS", "SWITCHES", "SWITCH", "SETTINGS"):
        setattr(Drawn, name, getattr(panel, name, None))
    assert panel.poll.__func__(panel, context)
    panel.draw(Drawn(), context)
    return Drawn.layout


def glass(roughness=0.0):
    material = new_material("Glass")
    add_node(material, "ShaderNodeBsdfGlass", surface(material)).inputs[
        "Roughness"
    ].default_value = roughness
    return material


@pytest.mark.parametrize("light", ["POINT", "SPOT", "SUN", "AREA"])
def test_every_panel_draws(light):
    members = {
        "light": bpy.data.lights.new("Light", light),
        "object": add_mesh(),
        "world": bpy.data.worlds.new("World"),
        "material": new_material(),
        "camera": bpy.data.cameras.new("Camera"),
    }
    members["camera"].type = "PANO"
    bpy.context.scene.specula.method = "SMS_UNBIASED"  # which has settings of its own
    for panel in ui.PANELS:
        layout = draw(panel, Context(**members))
        assert layout.shown or layout.texts


def test_settings_that_are_left_to_cycles_say_what_holds():
    scene = bpy.context.scene
    scene.specula.samples, scene.cycles.samples = 0, 77
    layout = draw(bpy.types.SPECULA_PT_sampling, Context())
    assert "0: as Cycles, 77" in layout.texts
    assert layout.shown.index("samples") < layout.shown.index("method")
    scene.specula.samples = 5
    assert "0: as Cycles, 77" not in draw(bpy.types.SPECULA_PT_sampling, Context()).texts


def test_settings_of_cycles_that_do_nothing_say_so():
    cycles = bpy.context.scene.cycles
    cycles.sample_clamp_indirect, cycles.sample_clamp_direct = 10.0, 0.0
    texts = draw(bpy.types.SPECULA_PT_light_paths, Context()).texts
    assert "Clamp Indirect: no effect" in texts
    assert "Clamp Direct: no effect" not in texts


def test_advanced_settings_are_closed_and_only_there_where_they_matter():
    panel = bpy.types.SPECULA_PT_advanced
    assert panel.bl_parent_id == "SPECULA_PT_sampling"
    assert panel.bl_options == {"DEFAULT_CLOSED"}
    bpy.context.scene.specula.method = "SMS_BIASED"
    assert draw(panel, Context()).shown == ["constraint", "two_stage", "chain_family"]
    for method in ("AUTO", "PT", "LT", "SHEETS", "MNEE", "MNEE_BIASED"):
        bpy.context.scene.specula.method = method
        assert not panel.poll.__func__(panel, Context())


def test_the_method_of_glints_is_in_a_closed_panel_of_its_own():
    panel = bpy.types.SPECULA_PT_glints
    assert panel.bl_parent_id == "SPECULA_PT_sampling"
    assert panel.bl_options == {"DEFAULT_CLOSED"}
    for method, shown in (
        ("SEARCH", ["glint_method"]),
        ("WALKS", ["glint_method"]),
        ("WALKS_BIASED", ["glint_method", "set_size"]),
        ("YAN", ["glint_method"]),
    ):
        bpy.context.scene.specula.glint_method = method
        assert draw(panel, Context()).shown == shown


def test_light_tracing_is_offered_beside_the_manifold():
    for method, offered in (
        ("AUTO", True),
        ("SMS_BIASED", True),
        ("SHEETS", True),
        ("MNEE", True),
        ("PT", False),
        ("LT", False),
    ):
        bpy.context.scene.specula.method = method
        shown = draw(bpy.types.SPECULA_PT_sampling, Context()).shown
        assert ("light_tracing" in shown) == offered, method


def test_statistics_show_every_line():
    stats = statistics.Statistics("Scene", "ViewLayer", "1.2", "PT", "Path Tracing")
    stats.scene_stats = native.struct_values(abi.SceneStats())
    stats.render_stats = native.struct_values(abi.RenderStats())
    stats.report = ["Glass: caster, manifold (Glass BSDF, roughness 0)"]
    stats.warnings = ["light Lamp: textures in a light are not supported, white is used"]
    statistics.last["Scene", "ViewLayer"] = stats
    texts = draw(bpy.types.SPECULA_PT_statistics, Context()).texts
    assert {label for label, _ in stats.rows()} <= set(texts)
    assert {"Path Tracing", "Glass", "manifold (Glass BSDF"} <= set(texts)
    assert {"light Lamp", "white is used"} <= set(texts)


def test_statistics_are_open():
    assert "DEFAULT_CLOSED" not in getattr(bpy.types.SPECULA_PT_statistics, "bl_options", ())


def test_an_object_tells_its_part_in_caustics():
    obj = add_mesh(material=glass())
    texts = draw(bpy.types.SPECULA_PT_object_caustics, Context(object=obj)).texts
    assert "Casts caustics, shows none" in texts
    assert "roughness 0" in texts
    obj.specula.caustics = "OFF"
    texts = draw(bpy.types.SPECULA_PT_object_caustics, Context(object=obj)).texts
    assert texts == ["No part in caustics"]


def test_a_material_tells_why_it_casts_no_caustics():
    rough = Context(material=glass(roughness=0.5))
    texts = draw(bpy.types.SPECULA_PT_material_caustics, rough).texts
    assert "Shows caustics, casts none" in texts
    assert any("roughness 0.5" in text for text in texts)


def test_a_material_tells_where_it_glints():
    material = new_material()
    glossy = add_node(material, "ShaderNodeBsdfGlossy", surface(material))
    glossy.inputs["Roughness"].default_value = 0.2
    assert "None" in draw(bpy.types.SPECULA_PT_material_glints, Context(material=material)).texts
    material.specula.glints = "ON"
    texts = draw(bpy.types.SPECULA_PT_material_glints, Context(material=material)).texts
    assert any(text.startswith("None: Glossy BSDF: no normal map") for text in texts)
    normal = add_node(material, "ShaderNodeNormalMap", glossy.inputs["Normal"])
    texture = add_node(material, "ShaderNodeTexImage", normal.inputs["Color"], image=new_image())
    texture.image.colorspace_settings.name = "Non-Color"
    texts = draw(bpy.types.SPECULA_PT_material_glints, Context(material=material)).texts
    assert "Glossy BSDF, roughness 0.2" in texts


def test_without_the_core_the_panels_say_so(monkeypatch):
    def missing():
        raise native.NativeError("the core library is missing")

    monkeypatch.setattr(native, "library", missing)
    forecast.forget()
    context = Context(object=add_mesh(), material=new_material())
    for panel in (
        bpy.types.SPECULA_PT_sampling,
        bpy.types.SPECULA_PT_object_caustics,
        bpy.types.SPECULA_PT_material_caustics,
        bpy.types.SPECULA_PT_material_glints,
    ):
        assert "the core library is missing" in draw(panel, context).texts


def test_panels_stay_away_from_other_engines():
    context = Context(light=bpy.data.lights.new("Light", "POINT"))
    context.engine = "CYCLES"
    assert not any(panel.poll.__func__(panel, context) for panel in ui.PANELS)


def test_names_that_scripts_rely_on():
    settings = bpy.context.scene.specula
    for method in (
        "AUTO",
        "PT",
        "SMS_UNBIASED",
        "SMS_BIASED",
        "LT",
        "SHEETS",
        "MNEE",
        "MNEE_BIASED",
    ):
        settings.method = method
    for light_tracing in ("AUTO", "ON", "OFF"):
        settings.light_tracing = light_tracing
    for constraint in ("HALF_VECTOR", "ANGLE_DIFFERENCE"):
        settings.constraint = constraint
    for glint_method in ("SEARCH", "WALKS", "WALKS_BIASED", "YAN"):
        settings.glint_method = glint_method
    settings.two_stage, settings.set_size, settings.time_limit = True, 4, 1.0
    with pytest.raises(TypeError):
        settings.method = "BDPT"


def test_engine_is_what_files_name():
    engine = bpy.types.RenderEngine.bl_rna_get_subclass_py("SPECULA")
    assert (engine.bl_idname, engine.bl_label) == ("SPECULA", "Specula")
    assert not engine.bl_use_shading_nodes_custom


def test_every_pass_of_the_core_has_its_switch():
    assert set(passes.SWITCHES) == set(abi.Pass) - {abi.Pass.VARIANCE}  # it is for instruments
    assert len(native.passes()) == len(abi.Pass)
    layer = bpy.context.view_layer
    for switch in {*passes.SWITCHES.values()} - {""}:
        owner, _, name = switch.rpartition(".")
        assert name in (getattr(layer, owner) if owner else layer).bl_rna.properties, switch
