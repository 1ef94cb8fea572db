# SPDX-License-Identifier: GPL-3.0-or-later
"""Every difference between Blender versions that export meets, found by feature where possible.

Written for 3.4 and 5.0; what holds between them is told by which attribute exists.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from .desc import BumpCorrection, Displacement
from .sky import Sky

# ------------------------------------------------------------------------------------------- data


def identity(data) -> int:
    """Tells an ID, evaluated or not, from all others of the session; before 4.1, and what is part
    of another ID, from those that live at the same time."""
    original = data.original
    return getattr(original, "session_uid", 0) or original.as_pointer()


# ------------------------------------------------------------------------------- Cycles' settings


def cycles_settings(owner) -> dict | object | None:
    """Cycles' settings of a scene, object, light or world, with the Cycles addon on or off.

    On: its property group. Off: the raw values that the file still holds (only those that were
    ever changed), from the custom properties (3.4) or the system properties (5.0). Else None.
    """
    if hasattr(owner, "cycles"):
        return owner.cycles
    if hasattr(owner, "bl_system_properties_get"):
        properties = owner.bl_system_properties_get()
        return properties.get("cycles") if properties else None
    return owner.get("cycles")


def cycles_value(owner, name: str, default):
    """Cycles' setting `name` of `owner`; `default` where there is none.

    With the Cycles addon off an enumeration is its index and a boolean 0 or 1.
    """
    settings = cycles_settings(owner)
    if settings is None:
        return default
    if hasattr(settings, "bl_rna"):
        return getattr(settings, name, default)
    return settings.get(name, default)


def library_folders() -> tuple[Path, ...]:
    """Where this Blender keeps the libraries that it comes with."""
    import bpy  # not above: tables that use this module are also read without Blender

    program = bpy.app.binary_path or bpy.__file__  # as a module there is no program
    return (Path(program).parent / "lib", Path(bpy.__file__).parent / "lib")


# ------------------------------------------------------------------------------------------ passes

# Names of passes before Blender 5.0.
_SHORT_NAMES = {
    "Object Index": "IndexOB",
    "Material Index": "IndexMA",
    "Emission": "Emit",
    "Environment": "Env",
}
_SHORT_WORDS = {
    "Diffuse": "Diff",
    "Glossy": "Gloss",
    "Transmission": "Trans",
    "Direct": "Dir",
    "Indirect": "Ind",
    "Color": "Col",
}


def pass_name(name: str) -> str:
    """What this Blender calls the pass that 5.0 calls `name`."""
    import bpy  # not above: tables that use this module are also read without Blender

    words = name.split()
    if bpy.app.version >= (5, 0) or not (name in _SHORT_NAMES or words[0] in _SHORT_WORDS):
        return name
    return _SHORT_NAMES.get(name) or "".join(_SHORT_WORDS[word] for word in words)


# ------------------------------------------------------------------------------------------ meshes


DISPLACEMENTS = {
    "BUMP": Displacement.BUMP,
    "DISPLACEMENT": Displacement.VERTICES,
    "BOTH": Displacement.BOTH,
}


def displacement(material) -> Displacement:
    """What a material's displacement does; until 4.1 a setting of Cycles."""
    method = getattr(material, "displacement_method", None)
    method = method or cycles_value(material, "displacement_method", "BUMP")
    return DISPLACEMENTS[method] if isinstance(method, str) else Displacement(method)


def is_flat(mesh) -> bool:
    """True if every face is drawn with its geometric normal."""
    if hasattr(mesh, "normals_domain"):
        return mesh.normals_domain == "FACE"
    smooth = np.empty(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("use_smooth", smooth)
    return not smooth.any()


def corner_normals(mesh) -> np.ndarray:
    """Normals of the mesh's loops, custom normals and sharp edges included: (L, 3) float32."""
    normals = np.empty((len(mesh.loops), 3), np.float32)
    if hasattr(mesh, "corner_normals"):
        mesh.corner_normals.foreach_get("vector", normals.ravel())
    else:
        mesh.calc_normals_split()
        mesh.loops.foreach_get("normal", normals.ravel())
        mesh.free_normals_split()
    return normals


def active_uv(mesh) -> str | None:
    """Name of the UV layer that is active for rendering."""
    return next((layer.name for layer in mesh.uv_layers if layer.active_render), None)


def active_color(mesh) -> str | None:
    """Name of the colour attribute that is active for rendering."""
    colors = mesh.color_attributes
    index = colors.render_color_index
    return colors[index].name if 0 <= index < len(colors) else None


def finish_triangles(mesh) -> None:
    """Completes smooth triangles whose loops are set; until 4.0 faces stored their size too."""
    ones = np.ones(len(mesh.polygons), np.int32)
    if not mesh.polygons[0].bl_rna.properties["loop_total"].is_readonly:
        mesh.polygons.foreach_set("loop_total", 3 * ones)
    mesh.polygons.foreach_set("use_smooth", ones.astype(bool))
    mesh.update()


def set_corner_normals(mesh, normals: np.ndarray) -> None:
    """Makes `normals` (L, 3) the mesh's custom normals."""
    mesh.normals_split_custom_set(normals)
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True


# ------------------------------------------------------------------------------------------- nodes

# Our socket name (Blender 5.0's) -> the identifiers it had before.
OLD_IDENTIFIERS = {
    "Specular IOR Level": ("Specular",),
    "Transmission Weight": ("Transmission",),
    "Emission Color": ("Emission",),
    "Coat Weight": ("Clearcoat",),
    "Coat Roughness": ("Clearcoat Roughness",),
    "Coat Normal": ("Clearcoat Normal",),
    "Sheen Weight": ("Sheen",),
    "Subsurface Weight": ("Subsurface",),
    "Roughness": ("Sigma",),  # of a Velvet BSDF
    # Of the nodes that separated and combined colours until Separate Color and Combine Color.
    "Color": ("Image",),
    "Red": ("R", "H"),
    "Green": ("G", "S"),
    "Blue": ("B", "V"),
    # Until 5.0.
    "Fac": ("Factor",),
}
NEW_IDENTIFIERS = {
    old: tuple(new for new, names in OLD_IDENTIFIERS.items() if old in names)
    for names in OLD_IDENTIFIERS.values()
    for old in names
}


def find_input(node, name: str):
    """Input socket of `node` by our name, or None if this Blender's node lacks it."""
    for identifier in (name, *OLD_IDENTIFIERS.get(name, ())):
        for socket in node.inputs:
            if socket.identifier == identifier:
                return socket
    return None


def output_name(socket, names: tuple[str, ...]) -> str | None:
    """Which of our names of a node's outputs is that of `socket`; None if none is."""
    known = (socket.identifier, *NEW_IDENTIFIERS.get(socket.identifier, ()))
    return next((name for name in names if name in known), None)


def is_sharp(node) -> bool:
    """The distribution 'SHARP' was removed in 4.0; it is GGX of roughness 0."""
    return getattr(node, "distribution", "") == "SHARP"


def film_on_metal() -> bool:
    """Whether the thin film of a Principled BSDF covers its metal, too. The version tells."""
    import bpy  # not above: tables that use this module are also read without Blender

    return bpy.app.version >= (5, 0, 0)


def diffuse_exchanges() -> bool:
    """Whether facets of a rough diffuse surface give light to each other. The version tells."""
    import bpy  # not above: tables that use this module are also read without Blender

    return bpy.app.version >= (4, 3, 0)


def subsurface_method(method: str) -> str:
    """What a method of subsurface scattering means; the version tells."""
    import bpy  # not above: tables that use this module are also read without Blender

    old = method == "RANDOM_WALK" and bpy.app.version < (4, 0, 0)
    return "RANDOM_WALK_DIPOLE" if old else method


def bump_correction(material) -> BumpCorrection:
    """What Cycles does where shading normals disagree with the surface, since 4.2 by material."""
    if not cycles_value(material, "use_bump_map_correction", True):
        return BumpCorrection.NONE
    import bpy  # not above: tables that use this module are also read without Blender

    new = bpy.app.version >= (4, 2, 0)
    return BumpCorrection.MICROFACET if new else BumpCorrection.SMOOTHED


def sky(node) -> Sky:
    """What a Sky Texture shows. Until 4.5 a sky of one scattering was called after Nishita, its
    aerosols were dust; Hosek and Wilkie's data are not ours: Preetham's sky stands in."""
    if node.sky_type in ("PREETHAM", "HOSEK_WILKIE"):
        direction = node.sun_direction.normalized()
        return Sky("PREETHAM", tuple(direction), turbidity=node.turbidity)
    elevation, rotation = node.sun_elevation, node.sun_rotation  # clockwise from +Y
    flat = math.cos(elevation)
    return Sky(
        node.sky_type,
        (flat * math.sin(rotation), flat * math.cos(rotation), math.sin(elevation)),
        altitude=node.altitude,
        air=node.air_density,
        aerosols=node.aerosol_density if hasattr(node, "aerosol_density") else node.dust_density,
        ozone=node.ozone_density,
        sun_size=node.sun_size if node.sun_disc else 0.0,
        sun_intensity=node.sun_intensity,
    )


def is_principled_by_default() -> bool:
    """Whether Cycles shades what has no material by a Principled BSDF, not a diffuse one."""
    import bpy  # not above: tables that use this module are also read without Blender

    return bpy.app.version >= (5, 0, 0)


def voronoi_hash() -> str:
    """Which numbers the cells of a Voronoi Texture get. Nothing but the version tells."""
    import bpy  # not above: tables that use this module are also read without Blender

    return "PCG" if bpy.app.version >= (5, 0, 0) else "LOOKUP3"


def uses_nodes(owner) -> bool:
    """Whether a material, world or light is shaded by its node tree; since 5.0 it is if it has one.

    (There the switch of materials and worlds is deprecated and always on.)
    """
    switch = owner.bl_rna.properties.get("use_nodes")
    if switch is None or getattr(switch, "is_deprecated", False):
        return owner.node_tree is not None
    return owner.use_nodes and owner.node_tree is not None


# ------------------------------------------------------------------------------------------ worlds


def world_of(scene, view_layer):
    """The world that a view layer shows: its own, which 3.4 has not, or the scene's."""
    return getattr(view_layer, "world_override", None) or scene.world


def aov_names(view_layer) -> frozenset[str]:
    """Of the AOVs that a view layer delivers."""
    return frozenset(aov.name for aov in view_layer.aovs if aov.is_valid)


def aov_name(node) -> str | None:
    """Of a node that writes an AOV, which is its own name in older Blenders; else None."""
    if node.bl_idname != "ShaderNodeOutputAOV":
        return None
    return node.aov_name if hasattr(node, "aov_name") else node.name


# ----------------------------------------------------------------------------------------- cameras


def panorama_settings(camera):
    """What holds the projection of a panoramic camera; until 4.x Cycles' settings of it."""
    return camera if hasattr(camera, "panorama_type") else cycles_settings(camera)


# ------------------------------------------------------------------------------------------ lights


def casts_shadows(light) -> bool:
    """Cycles' own switch in 3.4; the light's since its EEVEE twin was merged with it."""
    cycles = cycles_settings(light)
    if hasattr(cycles, "cast_shadow"):
        return cycles.cast_shadow
    return light.use_shadow


def light_gain(light) -> tuple[float, float, float]:
    """What multiplies colour and energy: exposure in stops and blackbody tint, since 4.5.

    Until 3.6 a watt of an area light was pi / 4 of today's; Blender converts old files likewise.
    No feature tells that, so it is by number.
    """
    import bpy  # not above: tables that use this module are also read without Blender

    gain = 2.0 ** getattr(light, "exposure", 0.0)
    if light.type == "AREA" and bpy.app.version < (4, 0, 0):
        gain *= math.pi / 4
    if getattr(light, "use_temperature", False):
        return tuple(gain * channel for channel in light.temperature_color)
    return (gain, gain, gain)


def has_soft_falloff(light) -> bool:
    """Whether a point or spot light is a disk in Cycles, which had no other in 3.4."""
    return getattr(light, "use_soft_falloff", True)


def ies_text(node) -> str:
    """What an IES Texture reads. Raises OSError."""
    import bpy  # not above: tables that use this module are also read without Blender

    if node.mode == "INTERNAL":
        return node.ies.as_string() if node.ies else ""
    path = bpy.path.abspath(node.filepath, library=node.id_data.library)
    with open(path, encoding="latin-1") as file:
        return file.read()


def lights_have_coordinates() -> bool:
    """Whether Object and Generated coordinates of a light are its own: lights became objects of
    Cycles with 4.4; before, they are the world's. Nothing but the version tells."""
    import bpy  # not above: tables that use this module are also read without Blender

    return bpy.app.version >= (4, 4, 0)


def is_normalized(light) -> bool:
    """False if the light's power is per unit of its area (since 4.5)."""
    return getattr(light, "normalize", True)


# ------------------------------------------------------------------------------------------ pixels


def write_rect(render_pass, pixels: np.ndarray) -> None:
    """Writes float32 `pixels` (N, channels) to a pass; Blender takes them flat from 4.1."""
    try:
        render_pass.rect.foreach_set(pixels)
    except TypeError:
        render_pass.rect.foreach_set(pixels.ravel())
