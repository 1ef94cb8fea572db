# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
import pytest

import specula
from specula import passes, ui

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

    def prop(self, owner, name, **_):
        assert hasattr(owner, name), f"{owner} has no {name}"
        self.shown.append(name)

    def label(self, **_):
        pass

    def separator(self):
        pass

    def column(self, **_):
        return self

    row = box = split = column


class Context:
    engine = "SPECULA"

    def __init__(self, **members):
        self.scene = bpy.context.scene
        self.view_layer = bpy.context.view_layer
        self.light = self.object = self.world = None
        self.__dict__.update(members)


def draw(panel, context):
    """Calls the panel's own draw with a recording layout; returns the properties it shows."""

    class Drawn:
        layout = Recorder()
        column = ui.SpeculaPanel.column

    for name in ("COMMON", "PROPERTIES", "LABELS"):
        setattr(Drawn, name, getattr(panel, name, None))
    assert panel.poll.__func__(panel, context)
    panel.draw(Drawn(), context)
    return Drawn.layout.shown


@pytest.mark.parametrize("light", ["POINT", "SPOT", "SUN", "AREA"])
def test_every_panel_draws(light):
    members = {
        "light": bpy.data.lights.new("Light", light),
        "object": bpy.data.objects.new("Object", None),
        "world": bpy.data.worlds.new("World"),
    }
    for panel in ui.PANELS:
        shown = draw(panel, Context(**members))
        assert shown or panel is ui.SPECULA_PT_statistics


def test_panels_stay_away_from_other_engines():
    context = Context(light=bpy.data.lights.new("Light", "POINT"))
    context.engine = "CYCLES"
    assert not any(panel.poll.__func__(panel, context) for panel in ui.PANELS)


def test_names_that_scripts_rely_on():
    settings = bpy.context.scene.specula
    for method in ("AUTO", "PT", "SMS_UNBIASED", "SMS_BIASED"):
        settings.method = method
    for constraint in ("HALF_VECTOR", "ANGLE_DIFFERENCE"):
        settings.constraint = constraint
    settings.two_stage, settings.set_size, settings.time_limit = True, 4, 1.0
    with pytest.raises(TypeError):
        settings.method = "MNEE"


def test_engine_is_what_files_name():
    engine = bpy.types.RenderEngine.bl_rna_get_subclass_py("SPECULA")
    assert (engine.bl_idname, engine.bl_label) == ("SPECULA", "Specula")
    assert not engine.bl_use_shading_nodes_custom
    assert [row.name for row in passes.PASSES] == [
        "Combined",
        "Depth",
        "Position",
        "Normal",
        "Caustics",
    ]
