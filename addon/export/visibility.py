# SPDX-License-Identifier: GPL-3.0-or-later
"""Ray visibility and the part in caustics, from Blender's, Cycles' and Specula's own properties."""

from __future__ import annotations

from . import compat
from .desc import CausticsRole, Visibility

_OBJECT_FLAGS = {
    "visible_camera": Visibility.CAMERA,
    "visible_diffuse": Visibility.DIFFUSE,
    "visible_glossy": Visibility.GLOSSY,
    "visible_transmission": Visibility.TRANSMISSION,
    "visible_shadow": Visibility.SHADOW,
}

_WORLD_FLAGS = {
    "camera": Visibility.CAMERA,
    "diffuse": Visibility.DIFFUSE,
    "glossy": Visibility.GLOSSY,
    "transmission": Visibility.TRANSMISSION,
}


def object_visibility(obj) -> Visibility:
    """Of an object by itself."""
    visible = Visibility(0)
    for name, flag in _OBJECT_FLAGS.items():
        if getattr(obj, name):
            visible |= flag
    return visible


def instancer(instance):
    """The object that a depsgraph instance belongs to: what makes it, else itself."""
    return instance.parent if instance.is_instance and instance.parent else instance.object


def instance_visibility(instance, view_layer) -> Visibility:
    """Of a depsgraph instance: it is seen where both it and its instancer are.

    In an *Indirect Only* collection of the view layer the camera sees nothing.
    """
    owner = instancer(instance)
    visible = object_visibility(instance.object) & object_visibility(owner)
    if owner.indirect_only_get(view_layer=view_layer):
        visible &= ~Visibility.CAMERA
    return visible


def light_group(instance) -> str:
    """Of a depsgraph instance: the object's own or, if that has none, its instancer's."""
    return instance.object.lightgroup or instancer(instance).lightgroup


def world_visibility(world) -> Visibility:
    """Cycles' flags of a world, which has none for shadows."""
    flags = getattr(world, "cycles_visibility", None)
    visible = Visibility.ALL
    for name, flag in _WORLD_FLAGS.items():
        if not getattr(flags, name, True):
            visible &= ~flag
    return visible


def original(instance):
    """The object that a depsgraph instance shows, to read property groups of.

    `instance.object` of what is instanced is a temporary copy, which leaks the property group that
    reading one may create.
    """
    return instance.instance_object if instance.is_instance else instance.object


def caustics_role(instance) -> CausticsRole:
    """Of a depsgraph instance; read from the object that is instanced."""
    return object_role(original(instance))


def object_role(obj) -> CausticsRole:
    """Specula's setting; where it is AUTO, Cycles' caster flag asks for more than AUTO would."""
    role = CausticsRole[obj.specula.caustics]
    if role != CausticsRole.AUTO or not compat.cycles_value(obj, "is_caustics_caster", False):
        return role
    receives = compat.cycles_value(obj, "is_caustics_receiver", False)
    return CausticsRole.BOTH if receives else CausticsRole.CASTER
