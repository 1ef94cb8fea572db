# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of everything but materials: lights, worlds, cameras, geometry, instances, settings.

A row is a function of the stage; those that only set values stand in tables.
"""

from __future__ import annotations

from collections.abc import Callable
from math import radians

from tests.instruments.parity._nodes import GENERATED, HUES, OBJECT, N, Row, halved

ROWS: list[Row] = []


def row(function: Callable) -> Callable:
    """Decorator: `room__name` becomes the row room/name."""
    ROWS.append(Row(function.__name__.replace("__", "/"), function))
    return function


def assign(owner, values: dict) -> None:
    for name, value in values.items():
        setattr(owner, name, value)


# ----------------------------------------------------------------------------------------- lights

LIGHTS = {
    "point": ("POINT", {"energy": 500, "shadow_soft_size": 0.0}),
    "point/sphere": ("POINT", {"energy": 500, "shadow_soft_size": 0.5}),
    "point/hard_sphere": (
        "POINT",
        {"energy": 500, "shadow_soft_size": 0.5, "use_soft_falloff": False},
    ),
    "point/unnormalized": ("POINT", {"energy": 30, "shadow_soft_size": 0.5, "normalize": False}),
    "spot": ("SPOT", {"energy": 900, "spot_size": 0.9, "shadow_soft_size": 0.0}),
    "spot/sphere": ("SPOT", {"energy": 900, "spot_size": 0.9, "shadow_soft_size": 0.3}),
    "spot/hard": ("SPOT", {"energy": 900, "spot_size": 0.9, "spot_blend": 0.0}),
    "spot/blended": ("SPOT", {"energy": 900, "spot_size": 1.2, "spot_blend": 1.0}),
    "spot/square": ("SPOT", {"energy": 900, "spot_size": 0.9, "use_square": True}),
    "sun": ("SUN", {"energy": 3, "angle": 0.0}),
    "sun/soft": ("SUN", {"energy": 3, "angle": 0.3}),
    "sun/unnormalized": ("SUN", {"energy": 30, "angle": 0.3, "normalize": False}),
    "area/square": ("AREA", {"energy": 400, "shape": "SQUARE", "size": 1.5}),
    "area/rectangle": ("AREA", {"energy": 400, "shape": "RECTANGLE", "size": 1, "size_y": 3}),
    "area/disk": ("AREA", {"energy": 400, "shape": "DISK", "size": 1.5}),
    "area/ellipse": ("AREA", {"energy": 400, "shape": "ELLIPSE", "size": 1, "size_y": 3}),
    "area/unnormalized": ("AREA", {"energy": 60, "size": 1.5, "normalize": False}),
    "area/spread_90": ("AREA", {"energy": 400, "size": 1.5, "spread": radians(90)}),
    "area/spread_30": ("AREA", {"energy": 400, "size": 1.5, "spread": radians(30)}),
    "exposure": ("POINT", {"energy": 100, "exposure": 2.0}),
    "temperature": ("POINT", {"energy": 500, "use_temperature": True, "temperature": 3000}),
    "color": ("AREA", {"energy": 400, "size": 1.5, "color": (1.0, 0.3, 0.1)}),
    "no_shadow": ("AREA", {"energy": 400, "size": 1.5, "use_shadow": False}),
}
for name, (kind, values) in LIGHTS.items():
    ROWS.append(Row(f"light/{name}", lambda stage, k=kind, v=values: stage.light(k, **v)))

# Values of a light's Cycles settings.
LIGHT_SWITCHES = {
    "no_multiple_importance": {"use_multiple_importance_sampling": False},
    "no_cast_shadow": {"cast_shadow": False},
    "max_bounces_0": {"max_bounces": 0},
    "portal": {"is_portal": True},
}
for name, values in LIGHT_SWITCHES.items():
    ROWS.append(
        Row(
            f"light/{name}",
            lambda stage, v=values: stage.light("AREA", energy=400, size=1.5, cycles=v),
        )
    )
for flag in ("camera", "diffuse", "glossy", "transmission"):
    ROWS.append(
        Row(
            f"light/invisible_{flag}",
            lambda stage, f=flag: stage.light(
                "AREA", energy=400, size=1.5, object={f"visible_{f}": False}, glossy=True
            ),
        )
    )

LIGHT_NODES = {
    "strength": N("Emission", {"Strength": 0.4, "Color": (0.3, 0.6, 1.0, 1.0)}),
    "blackbody": N("Emission", {"Color": N("Blackbody", {0: 3000.0})}),
    "linear_falloff": N("Emission", {"Strength": N("LightFalloff", {0: 0.3}, "Linear")}),
    "constant_falloff": N("Emission", {"Strength": N("LightFalloff", {0: 0.05}, "Constant")}),
    "smooth_falloff": N("Emission", {"Strength": N("LightFalloff", {0: 1.0, 1: 3.0}, 0)}),
    "texture": N(
        "Emission", {"Color": N("TexImage", {"Vector": N("TexCoord", output="UV")}, image="hues")}
    ),
    "light_path": N("Emission", {"Strength": N("LightPath", output="Is Shadow Ray")}),
}
for name, shader in LIGHT_NODES.items():
    ROWS.append(
        Row(
            f"light/nodes/{name}",
            lambda stage, s=shader: stage.light("AREA", energy=400, size=1.5, nodes=s),
        )
    )


@row
def light__ies(stage):
    stage.light(
        "POINT",
        energy=300,
        shadow_soft_size=0.0,
        nodes=N("Emission", {"Strength": N("TexIES", ies="lamp")}),
    )


@row
def light__mesh(stage):
    stage.light_off()
    stage.glow(N("Emission", {"Color": (1.0, 0.7, 0.4, 1.0), "Strength": 12.0}))


@row
def light__mesh_textured(stage):
    stage.light_off()
    stage.glow(N("Emission", {"Color": HUES, "Strength": 12.0}))


@row
def light__mesh_front_only(stage):
    stage.light_off()
    backs = N("NewGeometry", output="Backfacing")
    stage.glow(N("MixShader", {0: backs, 1: N("Emission", {"Strength": 12.0})}))


@row
def light__many(stage):
    for index in range(12):
        color = (1.0, 0.2 + 0.06 * index, 1.0 - 0.08 * index)
        stage.add_light(
            "POINT",
            (index % 4 - 1.5, index // 4 - 2.0, 2.5),
            energy=20,
            color=color,
            shadow_soft_size=0.1,
        )


@row
def light__linking(stage):
    stage.link_light(receivers=True)


@row
def light__shadow_linking(stage):
    stage.link_light(receivers=False)


@row
def light__scaled(stage):
    stage.lamp.scale = (2.0, 0.5, 1.0)


# ----------------------------------------------------------------------------------------- worlds


def background(**inputs) -> Callable:
    return lambda stage: stage.world(N("Background", inputs))


DIRECTION = N("TexCoord", output="Generated")
WORLDS = {
    "color": background(Color=(0.3, 0.5, 0.8, 1.0), Strength=0.7),
    "gradient": background(
        Color=N("ValToRGB", {0: N("TexGradient", {"Vector": DIRECTION})}, ramp="LINEAR")
    ),
    "image": background(Color=N("TexEnvironment", image="sky")),
    "image_rotated": background(
        Color=N(
            "TexEnvironment",
            {"Vector": N("Mapping", {"Vector": DIRECTION, "Rotation": (0.2, 0.3, 1.0)})},
            image="sky",
        )
    ),
    "mirror_ball": background(Color=N("TexEnvironment", image="sky", projection="MIRROR_BALL")),
    "sharp_sun": background(Color=N("TexEnvironment", image="sun")),
    "window": background(Color=N("TexCoord", output="Window")),
    "mixed": lambda stage: stage.world(
        N(
            "MixShader",
            {0: 0.4, 1: N("Background", {"Color": (1, 0.5, 0.2, 1)}), 2: N("Background")},
        )
    ),
    "camera_alone": lambda stage: stage.world(
        N(
            "MixShader",
            {
                0: N("LightPath", output="Is Camera Ray"),
                1: N("Background", {"Color": (0.5, 0.7, 1.0, 1)}),
                2: N("Background", {"Color": (0.9, 0.1, 0.1, 1)}),
            },
        )
    ),
    "emission": lambda stage: stage.world(N("Emission", {"Color": (0.5, 0.6, 0.7, 1.0)})),
    "unlinked": lambda stage: stage.world(None),
    "none": lambda stage: stage.no_world(),
    "volume": lambda stage: stage.world(
        N("Background"), volume=N("VolumeScatter", {"Density": 0.02})
    ),
}
for name, build in WORLDS.items():
    ROWS.append(Row(f"world/{name}", build))
for flag in ("camera", "diffuse", "glossy", "transmission"):
    ROWS.append(Row(f"world/invisible_{flag}", lambda stage, f=flag: stage.hide_world(f)))


@row
def world__no_importance(stage):
    stage.scene.world.cycles.sampling_method = "NONE"


@row
def world__max_bounces(stage):
    stage.scene.world.cycles.max_bounces = 0


# ---------------------------------------------------------------------------------------- cameras

CAMERAS = {
    "wide": {"lens": 18.0},
    "shifted": {"shift_x": 0.2, "shift_y": -0.1},
    "clipped": {"clip_start": 5.2, "clip_end": 7.0},
    "orthographic": {"type": "ORTHO", "ortho_scale": 5.0},
    "vertical_fit": {"sensor_fit": "VERTICAL", "sensor_height": 18.0},
    "depth_of_field": {"dof": {"use_dof": True, "focus_distance": 5.0, "aperture_fstop": 0.1}},
    "blades": {
        "dof": {
            "use_dof": True,
            "focus_distance": 4.0,
            "aperture_fstop": 0.1,
            "aperture_blades": 5,
            "aperture_rotation": 0.3,
            "aperture_ratio": 1.6,
        }
    },
}
PANORAMAS = "EQUIRECTANGULAR EQUIANGULAR_CUBEMAP_FACE MIRRORBALL FISHEYE_EQUIDISTANT"
PANORAMAS += " FISHEYE_EQUISOLID FISHEYE_LENS_POLYNOMIAL CENTRAL_CYLINDRICAL"
for name, values in CAMERAS.items():
    ROWS.append(Row(f"camera/{name}", lambda stage, v=values: stage.camera(**v)))
for kind in PANORAMAS.split():
    ROWS.append(Row(f"camera/panorama/{kind.lower()}", lambda stage, k=kind: stage.panorama(k)))


@row
def camera__scaled(stage):
    stage.scene.camera.scale = (2.0, 2.0, 2.0)


@row
def camera__border(stage):
    assign(stage.scene.render, {"use_border": True, "border_min_x": 0.25, "border_max_x": 0.75})


@row
def camera__pixel_aspect(stage):
    stage.scene.render.pixel_aspect_x = 2.0


# --------------------------------------------------------------------------------------- geometry


@row
def geometry__flat(stage):
    stage.smooth(False)


@row
def geometry__coarse_smooth(stage):
    """Few faces: the normals leave them by much, and shadows show their edges."""
    stage.replace_sphere(segments=8, rings=5)


@row
def geometry__smooth_cap(stage):
    """A can whose smooth normals go round its edge."""
    stage.can(smooth=True)


@row
def geometry__auto_smooth(stage):
    stage.can(smooth=True, sharp=True)


@row
def geometry__custom_normals(stage):
    stage.custom_normals()


@row
def geometry__subdivided(stage):
    stage.modify("SUBSURF", levels=2, render_levels=2)


@row
def geometry__solidified(stage):
    stage.modify("SOLIDIFY", thickness=0.1)


@row
def geometry__slots(stage):
    stage.two_materials()


@row
def geometry__mirrored(stage):
    stage.sphere.scale = (-1.0, 1.0, 1.0)


@row
def geometry__sheared(stage):
    stage.sphere.scale = (1.0, 0.4, 1.2)
    stage.sphere.rotation_euler = (0.5, 0.4, 0.2)


@row
def geometry__tiny(stage):
    stage.rescale(1e-3)


@row
def geometry__huge(stage):
    stage.rescale(1e3)


@row
def geometry__far_from_origin(stage):
    stage.move((800.0, -300.0, 50.0))


CURVES = {"curve": "bezier_circle", "surface": "torus_surface", "metaball": "BALL", "text": "Aa"}
for kind in CURVES:
    ROWS.append(Row(f"geometry/{kind}", lambda stage, k=kind: stage.other_geometry(k)))


@row
def geometry__hair_curves(stage):
    stage.hair_curves()


@row
def geometry__particle_hair(stage):
    stage.particles("HAIR", "PATH")


HAIR = {
    "chiang": N("BsdfHairPrincipled", {"Color": (0.6, 0.3, 0.1, 1.0)}),
    "chiang_black": N("BsdfHairPrincipled", {"Melanin": 0.9}, parametrization="MELANIN"),
    "chiang_random": N("BsdfHairPrincipled", {"Random Color": 0.8}, parametrization="MELANIN"),
    "chiang_coat": N("BsdfHairPrincipled", {"Coat": 0.8, "Roughness": 0.5}),
    "reflection": N("BsdfHair", {"RoughnessU": 0.3, "RoughnessV": 0.4}),
    "transmission": N("BsdfHair", {"RoughnessU": 0.3}, component="Transmission"),
    "intercept": N("Emission", {"Color": N("HairInfo", output="Intercept")}),
    "random": N("Emission", {"Color": N("HairInfo", output="Random")}),
}
for name, shader in HAIR.items():
    ROWS.append(Row(f"hair/{name}", lambda stage, s=shader: stage.dress_particles(s)))


@row
def geometry__point_cloud(stage):
    stage.geometry_nodes("points")


@row
def geometry__no_material(stage):
    stage.sphere.data.materials.clear()


@row
def geometry__generated_of_deformed(stage):
    """Generated coordinates are those before modifiers."""
    stage.modify("CAST", factor=0.7, cast_type="CUBOID")
    stage.show(N("Emission", {"Color": GENERATED}))


@row
def geometry__vertex_of_no_face(stage):
    stage.loose_vertices()


@row
def geometry__nested_glass(stage):
    """A bubble within glass."""
    glass = N("BsdfGlass", {"Roughness": 0.0, "IOR": 1.5})
    stage.dress(glass)
    stage.inner_sphere(0.6, glass)


@row
def geometry__glass_ball_in_glass(stage):
    stage.dress(N("BsdfGlass", {"Roughness": 0.0, "IOR": 1.3}))
    stage.inner_sphere(0.5, N("BsdfGlass", {"Roughness": 0.0, "IOR": 1.7}))


@row
def geometry__diffuse_in_glass(stage):
    stage.dress(N("BsdfGlass", {"Roughness": 0.0, "IOR": 1.5}))
    stage.inner_sphere(0.5, N("BsdfDiffuse", {"Color": (0.8, 0.3, 0.1, 1.0)}))


@row
def geometry__glass_touches_floor(stage):
    stage.dress(N("BsdfGlass", {"Roughness": 0.0, "IOR": 1.5}))
    stage.block.location.z = 0.45  # its lower side in the floor


# -------------------------------------------------------------------------------------- instances


@row
def instance__linked(stage):
    for index in range(4):
        stage.copy(stage.block, (index - 1.5, -1.6, 0.3), 0.5)


@row
def instance__collection(stage):
    stage.collection_instance((0.3, -1.5, 0.0), 0.4)


for _kind in ("VERTS", "FACES"):
    ROWS.append(Row(f"instance/{_kind.lower()}", lambda stage, k=_kind: stage.instances_on(k)))


@row
def instance__particles(stage):
    stage.particles("EMITTER", "OBJECT")


@row
def instance__particle_halo(stage):
    stage.particles("EMITTER", "HALO")


@row
def instance__geometry_nodes(stage):
    stage.geometry_nodes("instances")


@row
def instance__object_info(stage):
    stage.show(N("Emission", {"Color": halved(N("ObjectInfo", output="Location"))}))
    for index in range(4):
        stage.copy(stage.block, (0.5 * index, 0.2 * index, 1.0), 0.5)


@row
def instance__coordinates(stage):
    """Generated and object coordinates of scaled copies."""
    stage.show(N("Emission", {"Color": halved(OBJECT)}))
    stage.collection_instance((0.3, -1.5, 0.0), 0.4)


# --------------------------------------------------------------------------------------- settings

# Values of Cycles' settings.
SETTINGS = {
    **{f"max_bounces={n}": {"max_bounces": n} for n in (0, 1, 3)},
    **{f"diffuse_bounces={n}": {"diffuse_bounces": n} for n in (0, 1)},
    "glossy_bounces=0": {"glossy_bounces": 0},
    "glossy_bounces=1": {"glossy_bounces": 1},
    "transmission_bounces=0": {"transmission_bounces": 0},
    "transmission_bounces=2": {"transmission_bounces": 2},
    "transparent_bounces=0": {"transparent_max_bounces": 0},
    "no_reflective_caustics": {"caustics_reflective": False},
    "no_refractive_caustics": {"caustics_refractive": False},
    "clamp_direct": {"sample_clamp_direct": 0.5},
    "clamp_indirect": {"sample_clamp_indirect": 0.3},
    "filter_glossy": {"blur_glossy": 2.0},
    "light_threshold": {"light_sampling_threshold": 0.3},
    "no_light_tree": {"use_light_tree": False},
    "film_exposure": {"film_exposure": 1.7},
    "filter_box": {"pixel_filter_type": "BOX"},
    "filter_gaussian": {"pixel_filter_type": "GAUSSIAN"},
    "filter_wide": {"filter_width": 4.0},
    "fast_gi_replace": {"use_fast_gi": True, "fast_gi_method": "REPLACE", "ao_bounces_render": 1},
    "fast_gi_add": {"use_fast_gi": True, "fast_gi_method": "ADD"},
}
for name, values in SETTINGS.items():
    ROWS.append(Row(f"setting/{name}", lambda stage, v=values: stage.varied(v)))


@row
def setting__film_transparent(stage):
    stage.scene.render.film_transparent = True


@row
def setting__film_transparent_glass(stage):
    stage.varied({"film_transparent_glass": True})
    stage.scene.render.film_transparent = True


@row
def setting__world_off_in_layer(stage):
    stage.scene.view_layers[0].use_sky = False


@row
def setting__override_material(stage):
    stage.varied({})
    stage.scene.view_layers[0].material_override = stage.material(N("BsdfDiffuse", {"Color": HUES}))


@row
def setting__simplify(stage):
    stage.modify("SUBSURF", levels=2, render_levels=2)
    assign(stage.scene.render, {"use_simplify": True, "simplify_subdivision_render": 0})


@row
def setting__motion_blur(stage):
    stage.scene.render.use_motion_blur = True
    stage.animate(stage.sphere, (1.5, 0.0, 0.0))


@row
def setting__resolution_percentage(stage):
    stage.scene.render.resolution_percentage = 50


OBJECTS = {
    **{
        f"invisible_{flag}": {f"visible_{flag}": False}
        for flag in ("camera", "diffuse", "glossy", "transmission", "shadow")
    },
    "holdout": {"is_holdout": True},
    "shadow_catcher": {"is_shadow_catcher": True},
    "hidden": {"hide_render": True},
}
for name, values in OBJECTS.items():
    ROWS.append(Row(f"object/{name}", lambda stage, v=values: stage.sphere_among_mirrors(v)))


@row
def object__floor_catches_shadows(stage):
    stage.floor.is_shadow_catcher = True
    stage.scene.render.film_transparent = True


@row
def object__indirect_only(stage):
    stage.layer_switch("indirect_only")


@row
def object__holdout_collection(stage):
    stage.layer_switch("holdout")


@row
def object__shadow_terminator(stage):
    stage.replace_sphere(segments=8, rings=5)
    stage.terminator_offset()


def rows():
    yield from ROWS
