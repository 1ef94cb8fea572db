# SPDX-License-Identifier: GPL-3.0-or-later
"""Each panel that Cycles has in this Blender has something in its place while Specula is chosen."""

import bpy
import pytest
from scenes import add_mesh, new_material, new_world
from test_registration import Context

from specula import cycles_panels, ui


def all_panels(base=bpy.types.Panel) -> set[type]:
    return {base}.union(*(all_panels(panel) for panel in base.__subclasses__()))


def of_cycles() -> set[str]:
    """Names of those that show with Cycles, and in no other way with Specula."""
    cycles = {
        panel
        for panel in all_panels()
        if ("cycles" in panel.__module__ and "specula" not in panel.__module__)
        or "CYCLES" in getattr(panel, "COMPAT_ENGINES", ())
    }
    shared = set(ui.shared_panels())
    return {panel.__name__ for panel in cycles - shared}


def test_each_is_lent_or_replaced_or_stated_to_have_no_effect():
    tables = (
        cycles_panels.LENT,
        cycles_panels.SHARED,
        cycles_panels.OWN,
        cycles_panels.STATED,
        cycles_panels.WITHOUT_PLACE,
        ui.EXCLUDED_PANELS,
    )
    known = set().union(*tables)
    assert len(of_cycles()) > 80
    assert not of_cycles() - known
    assert not set(cycles_panels.LENT) & set(cycles_panels.OWN)


def test_what_stands_for_them_shows():
    for name in cycles_panels.OWN.values():
        panel = getattr(bpy.types, name)
        own = panel.__module__.startswith(ui.__name__)
        assert own or "SPECULA" in panel.COMPAT_ENGINES, name
    for name in cycles_panels.SHARED:
        panel = cycles_panels.find(name)
        assert panel is None or {"SPECULA", "CYCLES"} <= panel.COMPAT_ENGINES, name


def own(name: str) -> type:
    """What stands in the place of a panel of Cycles."""
    return getattr(bpy.types, cycles_panels._own_name(name))


@pytest.mark.parametrize("name", cycles_panels.LENT)
def test_lent_panels_show_for_specula_alone(name):
    if cycles_panels.find(name) is None:
        pytest.skip("not in this Blender")
    material, world = new_material(), new_world()
    bpy.context.view_layer.use_pass_mist = True
    context = Context(
        camera=bpy.data.cameras.new("Camera"),
        light=bpy.data.lights.new("Light", "POINT"),
        object=add_mesh(material=material),
        material=material,
        world=world,
    )
    assert own(name).poll(context)
    context.engine = "CYCLES"
    assert not own(name).poll(context)
    parent = getattr(own(name), "bl_parent_id", "")
    assert not parent or hasattr(bpy.types, parent)


@pytest.mark.parametrize("name", cycles_panels.STATED)
def test_stated_panels_stand_in_the_same_place(name):
    cycles = cycles_panels.find(name)
    if cycles is None:
        pytest.skip("not in this Blender")
    panel = own(name)
    assert panel.bl_label == cycles.bl_label
    assert panel.bl_context == cycles.bl_context
    parent = getattr(panel, "bl_parent_id", "")
    if parent:
        assert "SPECULA" in getattr(bpy.types, parent).COMPAT_ENGINES
    else:
        assert not getattr(cycles, "bl_parent_id", "")
