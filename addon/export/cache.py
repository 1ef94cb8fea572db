# SPDX-License-Identifier: GPL-3.0-or-later
"""What earlier exports of a scene have made and the next one need not make again.

What Blender's dependency graph tells of changes decides what is forgotten. Descriptions that are
kept stay the same objects: by that `upload` knows what the core has already.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import bpy

from . import compat, epoch
from .desc import AttributeNeed, ImageDesc, LightDesc, MaterialDesc, MeshDesc
from .image import Images
from .log import ExportLog, Warnings

# Types of data, by Blender's name, whose updates say nothing of materials.
_NAMES = (
    "Action Armature Camera Collection Curve Curves GreasePencil GreasePencilv3 Key Lattice Light "
    "LightProbe Mesh MetaBall ParticleSettings PointCloud Scene Speaker TextCurve Volume"
)
_NOT_OF_MATERIALS = tuple(
    getattr(bpy.types, name) for name in _NAMES.split() if hasattr(bpy.types, name)
)


@dataclass
class KeptMaterial:
    """A material or world as it was exported, with what else came of it."""

    desc: MaterialDesc
    images: dict[int, tuple[ImageDesc, tuple | None]]  # as `Images.used_by`
    needs: frozenset[AttributeNeed]
    warnings: Warnings
    sun: LightDesc | None = None


@dataclass
class KeptMesh:
    desc: MeshDesc | None  # None: it has no faces
    needs: frozenset[AttributeNeed]
    warnings: Warnings
    owners: tuple  # as `identities` has those who showed it first


@dataclass
class _Changes:
    """What the dependency graph has told since the last export."""

    data: set = field(default_factory=set)  # identities of data that is not what it was
    shapes: set = field(default_factory=set)  # identities of objects whose geometry is not
    all_materials: bool = False  # a node group, an image or the like that any may read


class ExportCache:
    """Serves one `SceneExport` after the other, of one view layer. What an export has not used is
    forgotten at its end."""

    def __init__(self):
        self._graph: tuple | None = None  # whose data is kept
        self._changes = _Changes()
        self._kept: dict[str, dict] = _nothing()
        self._used: dict[str, dict] = _nothing()

    def begin(self, depsgraph) -> None:
        """Takes notice of what has changed since the export before."""
        graph = (
            compat.identity(depsgraph.scene),
            depsgraph.view_layer.name,
            compat.aov_names(depsgraph.view_layer),
            depsgraph.mode,
            epoch.number(),
        )
        if graph != self._graph:  # after an undo, too, data may be elsewhere
            self._graph, self._kept = graph, _nothing()
        self._changes = _changes(depsgraph.updates)
        self._used = _nothing()

    def end(self) -> None:
        """Forgets what the export that ends here has not used."""
        self._kept, self._used = self._used, _nothing()

    # ----------------------------------------------------------------- materials and worlds

    def material(self, owner, images: Images, log: ExportLog) -> KeptMaterial | None:
        """What is kept of a material or world (None: an empty slot), its images among `images`."""
        kept = self._kept["materials"].get(_name_of(owner))
        if kept is None or self._has_changed(owner):
            return None
        if not images.are_as(state for _, state in kept.images.values()):
            return None
        log.repeat(kept.warnings)
        for _, state in kept.images.values():
            self.image(state, log)
        indices = {index: images.place(image) for index, (image, _) in kept.images.items()}
        if any(index != now for index, now in indices.items()):
            kept = replace(
                kept,
                desc=replace(kept.desc, nodes=_with_images(kept.desc.nodes, indices)),
                images={indices[index]: image for index, image in kept.images.items()},
            )
        self._used["materials"][_name_of(owner)] = kept
        return kept

    def keep_material(self, owner, kept: KeptMaterial) -> None:
        # Tiles are images by their place, coordinates of an object move with it.
        if not any(name in node.arrays for node in kept.desc.nodes for name in ("Tiles", "Object")):
            self._used["materials"][_name_of(owner)] = kept

    def _has_changed(self, owner) -> bool:
        return owner is not None and (
            self._changes.all_materials or compat.identity(owner) in self._changes.data
        )

    # ------------------------------------------------------------------------------- meshes

    def mesh(self, key: tuple, owners: tuple, needs: frozenset[AttributeNeed], log: ExportLog):
        """The KeptMesh of `key` if it has all that `needs` names and neither the data nor one of
        the objects in `owners` has changed; else None."""
        kept = self._used["meshes"].get(key) or self._kept["meshes"].get(key)
        if kept is None or not (kept.desc is None or needs <= kept.needs):
            return None
        if key not in self._used["meshes"]:
            # One that others show may lie where a mesh was that is gone.
            if kept.owners != identities(owners) or any(map(self._shape_changed, owners)):
                return None
            log.repeat(kept.warnings)
            self._used["meshes"][key] = kept
        return kept

    def keep_mesh(self, key: tuple, kept: KeptMesh) -> None:
        self._used["meshes"][key] = kept

    def _shape_changed(self, obj) -> bool:
        """Whether the mesh that comes of `obj`, evaluated or not, may be another one. What a
        metaball looks like depends on others."""
        original = obj.original
        return (
            original.type == "META"
            or compat.identity(original) in self._changes.shapes
            or (original.data is not None and compat.identity(original.data) in self._changes.data)
        )

    # ------------------------------------------------------------------------------- images

    def image(self, state: tuple, log: ExportLog) -> ImageDesc | None:
        """What is kept of an image in a state, see `image.state_of`."""
        kept = self._used["images"].get(state) or self._kept["images"].get(state)
        if kept is None or state[0] in self._changes.data:
            return None
        desc, warnings = self._used["images"][state] = kept
        log.repeat(warnings)
        return desc

    def keep_image(self, state: tuple, desc: ImageDesc, warnings: Warnings) -> None:
        self._used["images"][state] = desc, warnings


def identities(owners: tuple) -> tuple:
    return tuple(compat.identity(owner) for owner in owners)


def _nothing() -> dict[str, dict]:
    return {"materials": {}, "meshes": {}, "images": {}}


def _changes(updates) -> _Changes:
    changes = _Changes()
    for update in updates:
        data = update.id
        if isinstance(data, bpy.types.Object):
            if update.is_updated_geometry:
                changes.shapes.add(compat.identity(data))
            continue
        # A change to a material's own nodes is one to the material, too. In the kept graph of
        # Blender 3.4 what embedded data was made from may be gone, so that nothing asks for it.
        if data.is_embedded_data:
            continue
        shades = not isinstance(data, _NOT_OF_MATERIALS)
        if not shades and update.is_updated_shading and not update.is_updated_geometry:
            continue  # a material on it has changed
        changes.data.add(compat.identity(data))
        own = isinstance(data, (bpy.types.Material, bpy.types.World))
        changes.all_materials |= shades and not own
    return changes


def _with_images(nodes: list, indices: dict[int, int]) -> list:
    return [replace(n, image=indices[n.image]) if n.image in indices else n for n in nodes]


def _name_of(owner) -> tuple:
    return (compat.identity(owner), owner.name_full, type(owner).__name__) if owner else (None,)
