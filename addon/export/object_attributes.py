# SPDX-License-Identifier: GPL-3.0-or-later
"""What materials read of an object, its instancer or the view layer -> `AttributeDesc`."""

from __future__ import annotations

import numpy as np

from .desc import AttributeDesc, AttributeDomain, AttributeKind, AttributeNeed
from .hashes import hash_of_text, hash_of_two

_LARGEST = 0xFFFFFFFF


def object_attributes(instance, depsgraph, needs: frozenset[AttributeNeed]) -> list[AttributeDesc]:
    """The attributes of a depsgraph `instance` that `needs` names; those it lacks are left out."""
    found = []
    for need in sorted(needs):
        if need.kind < AttributeKind.OBJECT:
            continue
        value = _READERS[need.kind](instance, depsgraph, need.name)
        if value is not None:
            values = np.array([value], np.float32)
            found.append(AttributeDesc(need.name, need.kind, AttributeDomain.OBJECT, values))
    return found


def _numbers(value) -> tuple[float, ...] | None:
    """One to four numbers of a property; None for anything else. A pair or triple gets zeros and an
    alpha of 1, as Cycles fills them up."""
    if isinstance(value, (bool, int, float)):
        return (float(value),)
    try:
        numbers = [float(component) for component in value]
    except (TypeError, ValueError):
        return None
    if not 2 <= len(numbers) <= 4:
        return None
    return tuple(numbers) if len(numbers) == 4 else (*numbers, *(0.0,) * (3 - len(numbers)), 1.0)


def _property(owner, name: str) -> tuple[float, ...] | None:
    """A custom property or, by its path, one of Blender's own."""
    if owner is None or not name:
        return None
    custom = owner.get(name)
    if custom is not None:
        return _numbers(custom)
    try:
        return _numbers(owner.path_resolve(name))
    except (ValueError, TypeError):  # there is none
        return None


def _first(owners, name: str):
    return next((v for v in (_property(owner, name) for owner in owners) if v is not None), None)


def _of_object(instance, depsgraph, name: str):
    return _first((instance.object, instance.object.data), name)


def _of_instancer(instance, depsgraph, name: str):
    owners = [instance.object, instance.object.data]
    if instance.is_instance:
        system, parent = instance.particle_system, instance.parent
        if system:
            owners.insert(0, system.settings)
        owners[-2:-2] = [parent, parent.data]
    return _first(owners, name)


def _of_view_layer(instance, depsgraph, name: str):
    scene = depsgraph.scene_eval
    return _first((depsgraph.view_layer_eval, scene, scene.world), name)


def _object_info(instance, depsgraph, name: str):
    obj = instance.object
    if name == "Location":
        return tuple(instance.matrix_world.translation)
    if name == "Color":
        return tuple(obj.color)
    if name == "Object Index":
        return (obj.pass_index,)
    if name == "Random":
        return (_random_number(instance) / _LARGEST,)
    if name == "Instance UV":
        return (*instance.uv, 0.0) if instance.is_instance else (0.0, 0.0, 0.0)
    assert name == "Instance Generated", name
    return tuple(0.5 * c - 0.5 for c in instance.orco) if instance.is_instance else (0.0, 0.0, 0.0)


def _random_number(instance) -> int:
    if instance.is_instance:
        return instance.random_id & _LARGEST
    return hash_of_two(hash_of_text(instance.object.name), 0)


def _particle_info(instance, depsgraph, name: str):
    """Of a particle, not of its children, which Cycles does not tell either."""
    system = instance.particle_system if instance.is_instance else None
    index = instance.persistent_id[0] if system else -1
    if system is None or not 0 <= index < len(system.particles):
        return None
    particle = system.particles[index]
    if name == "Index":
        return (index,)
    if name == "Random":
        return (hash_of_two(index, 0) / _LARGEST,)
    if name == "Age":
        scene = depsgraph.scene_eval
        return (scene.frame_current + scene.frame_subframe - particle.birth_time,)
    if name in ("Size", "Lifetime"):
        return (getattr(particle, name.lower()),)
    return tuple(getattr(particle, name.lower().replace(" ", "_")))


_READERS = {
    AttributeKind.OBJECT: _of_object,
    AttributeKind.INSTANCER: _of_instancer,
    AttributeKind.OBJECT_INFO: _object_info,
    AttributeKind.PARTICLE_INFO: _particle_info,
    AttributeKind.VIEW_LAYER: _of_view_layer,
}
