# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking and shadow linking (since Blender 4.0): collections -> sets of bits.

An object's collection of receivers says on which objects its light shines, that of blockers which
ones throw its shadow: those that it includes, or, if it includes none, all; never those that it
excludes. What `LightDesc` and `InstanceDesc` call sets is a bit for each such collection.
"""

from __future__ import annotations

from .log import ExportLog
from .visibility import instancer, original

MOST_SETS = 64  # bits


class Linking:
    """The sets of a depsgraph's objects; nothing is linked before Blender 4.0."""

    def __init__(self, depsgraph, log: ExportLog):
        self._receivers = _Sets("receiver_collection", log)
        self._blockers = _Sets("blocker_collection", log)
        for data in depsgraph.ids:
            # Only objects have it: of what is embedded the original may be gone (see cache.py).
            if hasattr(data, "light_linking"):
                linking = data.original.light_linking
                self._receivers.add(linking.receiver_collection)
                self._blockers.add(linking.blocker_collection)

    def links(self, obj) -> tuple[int, int]:
        """Sets of receivers and of blockers of the light that `obj` gives; 0: all."""
        return self._receivers.of_emitter(obj), self._blockers.of_emitter(obj)

    def memberships(self, instance) -> tuple[int, int]:
        """Sets of receivers and of blockers that what a depsgraph instance shows is in."""
        return self._receivers.of_member(instance), self._blockers.of_member(instance)


class _Sets:
    """The collections that one property of `light_linking` names."""

    def __init__(self, name: str, log: ExportLog):
        self.name = name
        self.log = log
        self._bits: dict = {}  # collection -> its bit
        self._members: dict = {}  # object -> bits that it is lit by, of those that name it
        self._named: dict = {}  # object -> bits of the collections that name it
        self._open = 0  # bits of collections that include nobody, and so all they do not exclude

    def add(self, collection) -> None:
        if collection is None or collection in self._bits:
            return
        if len(self._bits) == MOST_SETS:
            message = f"more than {MOST_SETS} collections for linking, it is tied to nothing"
            self.log.warn(f"collection {collection.name}", message)
            return
        bit = 1 << len(self._bits)
        self._bits[collection] = bit
        states = _link_states(collection)
        if "INCLUDE" not in states.values():
            self._open |= bit
        for obj, state in states.items():
            self._named[obj] = self._named.get(obj, 0) | bit
            if state == "INCLUDE":
                self._members[obj] = self._members.get(obj, 0) | bit

    def of_emitter(self, obj) -> int:
        linking = getattr(obj.original, "light_linking", None)
        return self._bits.get(getattr(linking, self.name), 0) if linking else 0

    def of_member(self, instance) -> int:
        """An instancer that some collection names speaks for all that it makes, as in Cycles."""
        if not self._bits:
            return 0
        owner = instancer(instance).original
        obj = owner if owner in self._named else original(instance).original
        return self._members.get(obj, 0) | (self._open & ~self._named.get(obj, 0))


def _link_states(collection) -> dict:
    """Object -> INCLUDE or EXCLUDE, of a collection for linking.

    What lies deeper has the state of the child that it lies in; an object of its own counts more.
    """
    states = {}
    for child, link in zip(collection.children, collection.collection_children, strict=True):
        states |= dict.fromkeys(child.all_objects, link.light_linking.link_state)
    for obj, link in zip(collection.objects, collection.collection_objects, strict=True):
        states[obj] = link.light_linking.link_state
    return states
