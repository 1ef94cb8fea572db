# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels have in common: their base, and lines that several of them draw."""

import sys

from .. import diagnosis
from ..abi import CausticsSearch

ENGINE = "SPECULA"
LABEL_SHARE = 0.4  # of a panel's width, as Blender splits properties

# Objects that have, or are turned into, a mesh.
SURFACE_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}

# (casts, receives) and who searches -> what a panel says.
PARTS = {
    (False, False): "No part in caustics",
    (False, True): "Shows caustics, casts none",
    (True, False): "Casts caustics, shows none",
    (True, True): "Casts and shows caustics",
}

SEARCHES = {
    CausticsSearch.LIGHT_PATHS: "by light paths alone",
    CausticsSearch.MANIFOLD: "by manifold and light paths",
    CausticsSearch.MANIFOLD_IF_COARSE: "by light paths, the manifold too if its map is coarse",
}


class SpeculaPanel:
    """Base of the panels; subclasses say in which tab they are by `bl_context`."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context) -> bool:
        return context.engine in cls.COMPAT_ENGINES

    def column(self):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        return layout.column()


def draw_note(column, text: str, icon: str = "NONE") -> None:
    """Greyed text, in line with the values of properties."""
    row = column.split(factor=LABEL_SHARE)
    row.active = False
    row.label()
    row.label(text=text, icon=icon)


def draw_row(box, label: str, value: str = "", icon: str = "NONE") -> None:
    """A line for each part of `value`: a panel is narrow, and cuts long lines in the middle."""
    row = box.split(factor=LABEL_SHARE)
    row.label(text=label, icon=icon)
    column = row.column(align=True)
    for part in value.split(", "):
        column.label(text=part)


def draw_overrides(column, scene, names: tuple[str, ...]) -> None:
    """Settings that override Cycles', and below those that do not what holds instead."""
    problem = diagnosis.installation_problem()
    for name in names:
        column.prop(scene.specula, name)
        if problem:  # NumPy may be missing, which the export needs
            continue
        from ..export.settings import inherited_text, is_inherited

        if is_inherited(scene, name):
            draw_note(column, inherited_text(scene, name))


def draw_ignored(column, owner, names: tuple[str, ...]) -> None:
    """Those of Cycles' settings of `owner` that are set and do nothing here."""
    for name in names:
        if getattr(owner, name, None):
            draw_note(column, f"{owner.bl_rna.properties[name].name}: no effect", icon="INFO")


def draw_forecast(column, ask) -> None:
    """The part in caustics; `ask` gets the module `forecast` and returns what it says."""
    try:
        from .. import forecast  # not above: NumPy may be missing

        found = ask(forecast)
    except Exception as error:
        column.label(text=diagnosis.describe(error), icon="ERROR")
        return
    column.label(text=PARTS[found.casts, found.receives], icon="INFO")
    for text in (found.reason, SEARCHES.get(found.search)):
        for line in text.split(", ") if text else ():
            draw_note(column, line)


def draw_live_report(column, context) -> None:
    """What a rendered viewport has found of the active object, if one shows it."""
    viewport = sys.modules.get(f"{diagnosis.__package__}.viewport")  # loaded by the first of them
    lines = viewport.live_report(context.scene, context.object.name) if viewport else []
    if lines:
        column.label(text="In the viewport", icon="SHADING_RENDERED")
    for line in lines:
        for part in line.split(", "):
            draw_note(column, part)


def draw_light_group(column, owner, view_layer) -> None:
    """The group of an object's or a world's light, with a button that makes it."""
    row = column.row(align=True)
    row.use_property_decorate = False
    row.prop_search(
        owner,
        "lightgroup",
        view_layer,
        "lightgroups",
        text="Light Group",
        results_are_suggestions=True,
    )
    add = row.column(align=True)
    known = {group.name for group in view_layer.lightgroups}
    add.enabled = bool(owner.lightgroup) and owner.lightgroup not in known
    add.operator("scene.view_layer_add_lightgroup", icon="ADD", text="").name = owner.lightgroup
