# SPDX-License-Identifier: GPL-3.0-or-later
"""One walk over the evaluated scene: instances, and what they share, once each."""

from __future__ import annotations

from functools import partial

import numpy as np

from .. import cryptomatte
from ..abi import NONE, Crypto
from ..inquiry import Inquiry
from ..native import NativeError
from . import compat, ignored, strands
from .cache import ExportCache, KeptMaterial, KeptMesh, identities
from .camera import export_camera
from .desc import (
    AttributeKind,
    AttributeNeed,
    CausticsRole,
    EnvironmentDesc,
    ExportError,
    InstanceDesc,
    SceneDesc,
)
from .image import Images
from .light import export_light, export_light_nodes
from .linking import Linking
from .log import ExportLog
from .material import default_material, export_material
from .mesh import export_mesh
from .object_attributes import object_attributes
from .view import export_view, is_shown, shows_particles
from .visibility import (
    caustics_role,
    instance_visibility,
    instancer,
    light_group,
    original,
    world_visibility,
)
from .world import export_world

# Objects that carry something to see which Specula cannot show. Curves, surfaces, text and
# metaballs are not among them: they arrive as meshes.
UNSUPPORTED_TYPES = {"VOLUME", "GPENCIL", "GREASEPENCIL"}
RENDERED_TYPES = {"MESH", "LIGHT", "CURVES", "POINTCLOUD"}


def export_scene(
    depsgraph,
    log: ExportLog,
    images_as_pixels: bool = False,
    view=None,
    cache: ExportCache | None = None,
) -> SceneDesc:
    """Everything that `depsgraph` renders. Raises ExportError naming what cannot be rendered.

    `images_as_pixels`: see `Images`. `view`: the context of a 3D view, whose camera and visible
    objects stand in for the scene's. `cache`: of the exports before, which have met all updates of
    `depsgraph` but its present ones.
    """
    return SceneExport(depsgraph, log, images_as_pixels, view, cache or ExportCache()).run()


class SceneExport:
    """The walk under way, and what it has met so far."""

    def __init__(self, depsgraph, log: ExportLog, images_as_pixels: bool, view, cache: ExportCache):
        self.depsgraph = depsgraph
        self.view = view
        self.layer = depsgraph.view_layer_eval
        self.log = log
        self.cache = cache
        self.images = Images(log, images_as_pixels, depsgraph.scene_eval.frame_current, cache)
        self.scene = SceneDesc(images=self.images.descs)
        self.scene.crypto_names = {kind: set() for kind in cryptomatte.kinds(self.layer)}
        self._aovs = compat.aov_names(self.layer)
        self._materials: dict = {}  # evaluated material or None -> (index, needs)
        self._lights: dict = {}  # evaluated light -> what `_light_nodes` says of it
        self._meshes: dict = {}  # mesh_key -> (index or None, needs)

    def run(self) -> SceneDesc:
        self.cache.begin(self.depsgraph)
        self.scene.camera = (
            export_view(self.view, self.depsgraph) if self.view else export_camera(self.depsgraph)
        )
        self._linking = Linking(self.depsgraph, self.log)
        self._world(compat.world_of(self.depsgraph.scene_eval, self.layer))
        with Inquiry() as self._core:
            for instance in self.depsgraph.object_instances:
                space = self.view and self.view.space_data
                if is_shown(instance, space):
                    self._named(self._instance, instance)
                if self.layer.use_strand and shows_particles(instance, space):
                    self._named(self._particle_hair, instance)
        self._check_scene(self.depsgraph.scene_eval)
        self.cache.end()
        return self.scene

    def _check_scene(self, scene) -> None:
        if scene.render.use_motion_blur:
            self.log.warn("scene", "motion blur is not supported, the frame is still")
        if scene.render.use_multiview:
            self.log.warn("scene", "stereoscopy is not supported, all views are the same")
        ignored.warn_of_scene(scene, self.log)

    def _named(self, export, instance) -> None:
        """So that whatever goes wrong with an object says which one it was."""
        name = instance.object.name
        try:
            export(instance)
        except (ExportError, NativeError):
            raise
        except MemoryError as error:
            raise ExportError(f"object {name}: out of memory ({error})") from error
        except Exception as error:
            raise ExportError(f"object {name}: {type(error).__name__}: {error}") from error

    def _instance(self, instance) -> None:
        obj = instance.object
        owner = f"object {obj.name}"
        if obj.type in UNSUPPORTED_TYPES and (obj.type != "VOLUME" or self.layer.use_volumes):
            self.log.warn(owner, f"type {obj.type} is not supported, it is not rendered")
        if obj.type not in RENDERED_TYPES:
            return
        # The matrix belongs to the iterator: gone at the next step.
        transform = np.array(instance.matrix_world, np.float32)[:3]
        if obj.type == "LIGHT":
            visibility = instance_visibility(instance, self.layer)
            light = export_light(obj, transform, visibility, self._light_nodes, self.log)
            if light:
                light.light_group = light_group(instance)
                light.receiver_sets, light.blocker_sets = self._linking.links(original(instance))
                self.scene.lights.append(light)
            return
        self._check_object(instance, owner)
        if obj.type == "CURVES" and self.layer.use_strand:
            self._strand_instance(instance, (obj.data, "strands"), 0, partial(strands.curves, obj))
        if not self.layer.use_solid:
            return
        if obj.type == "POINTCLOUD":
            self._balls(instance)
        if obj.type == "MESH":
            self._mesh_instance(instance, transform)

    def _check_object(self, instance, owner: str) -> None:
        if instance.object.is_shadow_catcher:
            self.log.warn(owner, "shadow catchers are not supported, the object is rendered")
        ignored.warn_of_object(original(instance), self.log)
        ignored.warn_of_subdivision(self.depsgraph.scene_eval, original(instance), self.log)

    def _particle_hair(self, instance) -> None:
        obj = instance.object
        for system in obj.particle_systems:
            settings = system.settings
            if settings.type != "HAIR" or settings.render_type != "PATH":
                continue

            def strands_of(needs: frozenset[AttributeNeed], system=system):
                return strands.particle_hair(obj, system, needs, self.view is None)

            key = (obj.data, system.name)
            self._strand_instance(instance, key, settings.material - 1, strands_of)

    def _strand_instance(self, instance, key: tuple, slot: int, export) -> None:
        """Strands with the material of a slot; `export` makes their mesh of what that reads."""
        obj = instance.object
        slots = [slot.material for slot in obj.material_slots] or [None]
        index, needs = self._material(
            self.layer.material_override or slots[min(slot, len(slots) - 1)]
        )
        if (key, index) not in self._meshes:
            desc = export(needs)
            self._meshes[key, index] = (len(self.scene.meshes) if desc else None, needs)
            self.scene.meshes += [desc] if desc else []
        mesh, _ = self._meshes[key, index]
        transform = np.array(instance.matrix_world, np.float32)[:3]
        role = self._without_casting(instance)
        self._add_instance(instance, mesh, transform, [index], needs, role)

    def _balls(self, instance) -> None:
        """A point cloud: its first material is that of all."""
        obj = instance.object
        slots = [slot.material for slot in obj.material_slots] or [None]
        index, needs = self._material(self.layer.material_override or slots[0])
        if "ball" not in self._meshes:
            self._meshes["ball"] = (len(self.scene.meshes), needs)
            self.scene.meshes.append(strands.ball())
        matrix = np.array(instance.matrix_world, np.float64)
        role = self._without_casting(instance)
        for position, radius in zip(*strands.points(obj), strict=True):
            ball = matrix @ np.diag((radius, radius, radius, 1.0))
            ball[:, 3] = matrix @ (*position, 1.0)
            if radius > 0.0:
                transform = ball[:3].astype(np.float32)
                self._add_instance(
                    instance, self._meshes["ball"][0], transform, [index], needs, role
                )

    def _without_casting(self, instance) -> CausticsRole:
        """The part of strands and points, whose many small chains nothing could find again."""
        role = caustics_role(instance)
        if role in (CausticsRole.CASTER, CausticsRole.BOTH):
            owner = f"object {instance.object.name}"
            self.log.warn(owner, "hair, curves and points cast no caustics but by path tracing")
        return CausticsRole.OFF if role == CausticsRole.OFF else CausticsRole.RECEIVER

    def _mesh_instance(self, instance, transform: np.ndarray) -> None:
        obj = instance.object
        slots = [slot.material for slot in obj.material_slots] or [None]
        override = self.layer.material_override
        materials = [self._material(override or material) for material in slots]
        of_passes = {AttributeNeed(AttributeKind.UV)} if self.layer.use_pass_uv else ()
        needs = frozenset(of_passes).union(*(reads for _, reads in materials))
        mesh = self._mesh(instance, needs, len(materials))
        indices = [index for index, _ in materials]
        self._add_instance(instance, mesh, transform, indices, needs, caustics_role(instance))

    def _add_instance(
        self,
        instance,
        mesh: int | None,
        transform: np.ndarray,
        materials: list[int],
        needs: frozenset[AttributeNeed],
        role: CausticsRole,
    ) -> None:
        """Of a mesh, unless that is None, at `transform` (3, 4). `needs`: of all its materials."""
        obj, name = instance.object, instance.object.name
        if mesh is None:
            return
        if np.linalg.det(transform[:, :3].astype(np.float64)) == 0.0:
            self.log.warn(f"object {name}", "has a scale of zero, it is not rendered")
            return
        receivers, blockers = self._linking.links(original(instance))
        receives_in, blocks_in = self._linking.memberships(instance)
        self.scene.instances.append(
            InstanceDesc(
                name=name,
                mesh=mesh,
                transform=transform,
                materials=materials,
                visibility=instance_visibility(instance, self.layer),
                caustics_role=role,
                holdout=instancer(instance).holdout_get(view_layer=self.layer),
                terminator_offset=compat.cycles_value(obj, "shadow_terminator_offset", 0.0),
                pass_index=instancer(instance).pass_index,
                crypto_object=self._crypto(Crypto.OBJECT, obj.name),
                crypto_asset=self._crypto(Crypto.ASSET, cryptomatte.asset_name(obj)),
                light_group=light_group(instance),
                receives_in=receives_in,
                blocks_in=blocks_in,
                receiver_sets=receivers,
                blocker_sets=blockers,
                attributes=object_attributes(instance, self.depsgraph, needs),
            )
        )

    def _mesh(self, instance, needs: frozenset[AttributeNeed], slots: int) -> int | None:
        """Index of the object's mesh, shared by all who show it; None if it has no faces.

        Exported again in its place if a later user reads more of it than all before.
        """
        key = mesh_key(instance.object.data, slots)
        index, exported = self._meshes.get(key, (len(self.scene.meshes), None))
        if exported is not None and (index is None or needs <= exported):
            return index
        needs = needs if exported is None else needs | exported
        owners = shapers(instance)
        kept = self.cache.mesh(key, owners, needs, self.log)
        if kept is None:
            with self.log.recording() as warnings:
                desc = export_mesh(instance.object, needs, slots)
            kept = KeptMesh(desc, needs, warnings, identities(owners))
            self.cache.keep_mesh(key, kept)
        self._meshes[key] = (index if kept.desc else None, kept.needs)
        if kept.desc is None:
            return None
        self.scene.meshes[index : index + 1] = [kept.desc]
        return index

    def _material(self, material) -> tuple[int, frozenset[AttributeNeed]]:
        """Index of a material and what it reads of a mesh and an object; None is an empty slot."""
        if material not in self._materials:
            kept = self.cache.material(material, self.images, self.log)
            if kept is None:
                kept = self._new_material(material)
                self.cache.keep_material(material, kept)
            self._materials[material] = (len(self.scene.materials), kept.needs)
            self.scene.materials.append(kept.desc)
            self._crypto(Crypto.MATERIAL, kept.desc.name)
        return self._materials[material]

    def _new_material(self, material) -> KeptMaterial:
        with self.log.recording() as warnings:
            desc = (
                export_material(material, self.images, self.log, self._aovs)
                if material
                else default_material()
            )
        desc.crypto = cryptomatte.identifier(desc.name)
        needs = self._core.needs(self._core.add(desc, self.images.descs))
        return KeptMaterial(desc, self.images.used_by(desc), needs, warnings)

    def _light_nodes(self, light) -> tuple[tuple[float, float, float], int]:
        """See light.Shade."""
        if light not in self._lights:
            kept = self.cache.material(light, self.images, self.log)
            if kept is None:
                with self.log.recording() as warnings:
                    desc = export_light_nodes(light, self.images, self.log)
                kept = KeptMaterial(desc, self.images.used_by(desc), frozenset(), warnings)
                self.cache.keep_material(light, kept)
            material = self._core.add(kept.desc, self.images.descs)
            emission, varies = self._core.emission(material)
            if varies:
                emission = (1.0, 1.0, 1.0)
                self.scene.materials.append(kept.desc)
            self._lights[light] = emission, len(self.scene.materials) - 1 if varies else NONE
        return self._lights[light]

    def _crypto(self, kind: Crypto, name: str) -> float:
        """The name's identifier, if the view layer asks for the kind."""
        if kind not in self.scene.crypto_names:
            return 0.0
        self.scene.crypto_names[kind].add(name)
        return cryptomatte.identifier(name)

    def _world(self, world) -> None:
        if world is None or not self.layer.use_sky:
            return
        ignored.warn_of_world(world, self.log)
        self.scene.environment = EnvironmentDesc(
            material=len(self.scene.materials),
            visibility=world_visibility(world),
            feeds_caustics=world.specula.caustics,
            light_group=world.lightgroup,
        )
        kept = self.cache.material(world, self.images, self.log)
        if kept is None:
            with self.log.recording() as warnings:
                desc, sun = export_world(world, self.images, self.log, self._aovs)
            kept = KeptMaterial(desc, self.images.used_by(desc), frozenset(), warnings, sun)
            self.cache.keep_material(world, kept)
        self.scene.materials.append(kept.desc)
        if kept.sun is not None:
            kept.sun.visibility = self.scene.environment.visibility
            kept.sun.feeds_caustics = world.specula.caustics
            kept.sun.light_group = world.lightgroup
            self.scene.lights.append(kept.sun)


def mesh_key(mesh, slots: int) -> tuple:
    """Tells an evaluated mesh, shown with a number of material slots, from others."""
    sizes = len(mesh.vertices), len(mesh.loops), len(mesh.polygons)
    return mesh.as_pointer(), slots, *sizes


def shapers(instance) -> tuple:
    """The objects whose geometry decides what mesh a depsgraph instance shows."""
    if not instance.is_instance:
        return (instance.object,)
    return instancer(instance), instance.instance_object
