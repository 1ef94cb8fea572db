# SPDX-License-Identifier: GPL-3.0-or-later
"""The same scene in Cycles and in Specula has the same mean colour, and the same shape.

Each factor of light and each conversion of a material meets Cycles itself, and so does each kind of
camera. Clamping and glossy filter are off in Cycles, as Specula has neither. Means over the frame:
the noise that is left is below a fifth of TOLERANCE.
"""

import math

import bpy
import numpy as np
import pytest
from scenes import (
    add_camera,
    add_light,
    add_mesh,
    add_node,
    new_material,
    new_world,
    output_of,
    surface,
)

from specula.export import compat

SIZE = 32
SAMPLES = 128
BEAM_SAMPLES = 2048  # where a beam's edge crosses most of the pixels that it lights
TOLERANCE = 0.01  # of the mean
# Today's closures are the model: until 4.0 Cycles' Principled and Oren-Nayar were others.
TOLERANCE_CLOSURES = TOLERANCE if bpy.app.version >= (4, 3, 0) else 0.03
NARROW_BEAM = math.radians(15)  # of a spread
PLANE = [(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)]
WHITE = (0.8, 0.8, 0.8, 1)

LIGHTS = {
    "point": ("POINT", {"energy": 500, "shadow_soft_size": 0}),
    "small sphere": ("POINT", {"energy": 500, "shadow_soft_size": 0.1}),
    "spot": ("SPOT", {"energy": 900, "spot_size": 1.0, "spot_blend": 0.3, "shadow_soft_size": 0}),
    "sun": ("SUN", {"energy": 3, "angle": 0.1}),
    "square": ("AREA", {"energy": 500, "shape": "SQUARE", "size": 1.5}),
    "rectangle": ("AREA", {"energy": 500, "shape": "RECTANGLE", "size": 1, "size_y": 2}),
    "disk": ("AREA", {"energy": 500, "shape": "DISK", "size": 1}),
    "ellipse": ("AREA", {"energy": 500, "shape": "ELLIPSE", "size": 1, "size_y": 2}),
    **{
        f"spread of {degrees} degrees": (
            "AREA",
            {"energy": 500, "shape": shape, "size": 1.5, "spread": math.radians(degrees)},
        )
        for degrees, shape in (
            (120, "SQUARE"),
            (60, "DISK"),
            (30, "SQUARE"),
            (10, "DISK"),
            (1, "SQUARE"),
            (0, "DISK"),
        )
    },
}

COPPER = (0.8, 0.4, 0.2, 1)
MATERIALS = {
    "rough diffuse": ("ShaderNodeBsdfDiffuse", None, {"Color": COPPER, "Roughness": 0.5}),
    "glossy": ("ShaderNodeBsdfGlossy", "GGX", {"Color": COPPER, "Roughness": 0.5}),
    "glass": ("ShaderNodeBsdfGlass", "GGX", {"Roughness": 0.4, "IOR": 1.4}),
    "plaster": ("ShaderNodeBsdfDiffuse", None, {"Color": COPPER, "Roughness": 1.0}),
    "translucent": ("ShaderNodeBsdfTranslucent", None, {"Color": COPPER}),
    "toon": ("ShaderNodeBsdfToon", None, {"Color": COPPER, "Size": 0.4, "Smooth": 0.3}),
    "phong": ("ShaderNodeBsdfGlossy", "ASHIKHMIN_SHIRLEY", {"Color": COPPER, "Roughness": 0.5}),
    "emission": ("ShaderNodeEmission", None, {"Color": COPPER, "Strength": 2.0}),
    "plastic": ("ShaderNodeBsdfPrincipled", "GGX", {"Base Color": COPPER, "Roughness": 0.4}),
    "metal": (
        "ShaderNodeBsdfPrincipled",
        "GGX",
        {"Base Color": COPPER, "Roughness": 0.5, "Metallic": 1.0},
    ),
    "emitting": (
        "ShaderNodeBsdfPrincipled",
        "GGX",
        {"Base Color": COPPER, "Emission Color": COPPER, "Emission Strength": 2.0},
    ),
    "coat": (
        "ShaderNodeBsdfPrincipled",
        "GGX",
        {"Base Color": COPPER, "Roughness": 0.5, "Coat Weight": 1.0, "Coat Roughness": 0.3},
    ),
}
# What is not in every Blender.
OTHERS = {
    "velvet": ("ShaderNodeBsdfVelvet", None, {"Color": COPPER, "Sigma": 0.7}),
    "ashikhmin": ("ShaderNodeBsdfSheen", "ASHIKHMIN", {"Color": COPPER, "Roughness": 0.7}),
    "microfiber": ("ShaderNodeBsdfSheen", "MICROFIBER", {"Color": COPPER, "Roughness": 0.5}),
    "principled": (
        "ShaderNodeBsdfPrincipled",
        "GGX",
        {"Base Color": COPPER, "Sheen Weight": 1.0, "Sheen Roughness": 0.4},
    ),
    "subsurface": ("ShaderNodeSubsurfaceScattering", None, {"Color": COPPER, "Scale": 0.1}),
    "far subsurface": (
        "ShaderNodeSubsurfaceScattering",
        None,
        {"Color": COPPER, "Scale": 0.5, "Anisotropy": 0.5},
    ),
    "dull skin": (
        "ShaderNodeBsdfPrincipled",
        "GGX",
        {"Base Color": COPPER, "Subsurface Weight": 1.0, "Specular IOR Level": 0.0},
    ),
    "skin": (
        "ShaderNodeBsdfPrincipled",
        "GGX",
        {"Base Color": COPPER, "Subsurface Weight": 1.0},
    ),
    "brushed": (
        "ShaderNodeBsdfAnisotropic",
        "GGX",
        {"Color": COPPER, "Roughness": 0.5, "Anisotropy": 0.7},
    ),
    "brushed across": (
        "ShaderNodeBsdfAnisotropic",
        "GGX",
        {"Color": COPPER, "Roughness": 0.5, "Anisotropy": -0.5, "Rotation": 0.1},
    ),
    "brushed metal": (
        "ShaderNodeBsdfPrincipled",
        "GGX",
        {"Base Color": COPPER, "Metallic": 1.0, "Anisotropic": 0.8},
    ),
    "metallic": ("ShaderNodeBsdfMetallic", "GGX", {"Roughness": 0.4, "Anisotropy": 0.5}),
    "rough principled": (
        "ShaderNodeBsdfPrincipled",
        "GGX",
        {"Base Color": COPPER, "Diffuse Roughness": 1.0},
    ),
}
COATS = {
    "tint": {"Base Color": COPPER, "Coat Tint": (0.4, 0.7, 0.9, 1)},
    "half of a tint": {"Base Color": COPPER, "Coat Tint": COPPER, "Coat Weight": 0.5},
    "high index": {"Base Color": COPPER, "Coat IOR": 2.2},
    "low index": {"Base Color": COPPER, "Coat IOR": 1.05, "Coat Tint": COPPER},
    "metal": {"Base Color": COPPER, "Metallic": 1.0, "Roughness": 0.5, "Coat Tint": COPPER},
    "glass": {"Transmission Weight": 1.0, "Roughness": 0.4, "Coat Tint": COPPER},
    "emitting": {
        "Base Color": (0, 0, 0, 1),
        "Emission Color": WHITE,
        "Emission Strength": 2.0,
        "Coat Tint": COPPER,
    },
    "mirror": {"Base Color": COPPER, "Coat Roughness": 0.0},
    "rough": {"Base Color": COPPER, "Coat Roughness": 0.9},
}


# What a camera does to a glowing square at five metres.
CAMERAS = {
    "perspective": ("PERSP", None),
    "lens": ("PERSP", {"focus_distance": 2.5, "aperture_fstop": 0.03}),
    "focus behind": ("PERSP", {"focus_distance": 20, "aperture_fstop": 0.03}),
    "triangle": (
        "PERSP",
        {
            "focus_distance": 2.5,
            "aperture_fstop": 0.03,
            "aperture_blades": 3,
            "aperture_rotation": 0.4,
            "aperture_ratio": 1.5,
        },
    ),
    "orthographic": ("ORTHO", None),
    "orthographic lens": ("ORTHO", {"focus_distance": 2.5, "aperture_fstop": 0.6}),
    "orthographic pentagon": (
        "ORTHO",
        {
            "focus_distance": 8,
            "aperture_fstop": 0.4,
            "aperture_blades": 5,
            "aperture_rotation": -0.9,
            "aperture_ratio": 0.8,
        },
    ),
}
CAMERA_SAMPLES = 1024


@pytest.fixture
def render(tmp_path):
    """render(engine) gives the pixels (SIZE, SIZE, 4) of the open scene."""
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.specula.samples = SAMPLES
    for name, value in {
        "samples": SAMPLES,
        "use_denoising": False,
        "use_adaptive_sampling": False,
        "sample_clamp_direct": 0,
        "sample_clamp_indirect": 0,
        "blur_glossy": 0,
    }.items():
        setattr(scene.cycles, name, value)
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"

    def render(engine: str) -> np.ndarray:
        scene.render.engine = engine
        scene.render.filepath = str(tmp_path / f"{engine}.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        image.colorspace_settings.name = "Non-Color"
        pixels = np.array(image.pixels[:]).reshape(*reversed(image.size), 4)
        bpy.data.images.remove(image)
        return pixels

    return render


@pytest.fixture
def stage(render):
    """A plane, seen from the side; returns compare()."""
    add_mesh("Plane", PLANE, material=diffuse(WHITE))
    camera = add_camera((0, -8, 5))
    camera.rotation_euler = (math.radians(60), 0, 0)

    def compare(tolerance=TOLERANCE) -> None:
        means = [render(engine).mean(axis=(0, 1)) for engine in ("SPECULA", "CYCLES")]
        np.testing.assert_allclose(*means, rtol=tolerance)

    return compare


def diffuse(color):
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    shader.inputs["Color"].default_value = color
    return material


def place(light) -> None:
    light.location = (2, -2, 5)
    light.rotation_euler = (0.5, 0.3, 0)


def add_sky(strength=0.5) -> None:
    world = new_world()
    background = add_node(world, "ShaderNodeBackground", surface(world))
    background.inputs["Color"].default_value = (0.3, 0.5, 0.8, 1)
    background.inputs["Strength"].default_value = strength


@pytest.mark.parametrize("name", LIGHTS)
def test_light(stage, name):
    kind, properties = LIGHTS[name]
    if kind == "SPOT" and bpy.app.version < (4, 0, 0):
        pytest.skip("the edge of Cycles' spots had another profile")
    if properties.get("spread", math.pi) < NARROW_BEAM:
        if bpy.app.version < (4, 0, 0):
            pytest.skip("narrow beams of Cycles had another power")
        scene = bpy.context.scene
        scene.specula.samples = scene.cycles.samples = BEAM_SAMPLES
    light = add_light(kind, color=(1, 0.5, 0.25), **properties)
    place(light)
    if kind == "AREA":
        light.scale = (1, 1.5, 1)
    stage()


NEAR_LIGHTS = {
    "point": ("POINT", {}),
    "spot": ("SPOT", {"spot_size": 1.8, "spot_blend": 0.3}),
    "narrow spot": ("SPOT", {"spot_size": 0.8, "spot_blend": 0.3}),
}
NEAR_WHAT = ("plane", "plane within its radius", "lampshade", "mirror")


@pytest.mark.parametrize("soft", [True, False])
@pytest.mark.parametrize("what", NEAR_WHAT)
@pytest.mark.parametrize("name", NEAR_LIGHTS)
def test_wide_light(stage, name, what, soft):
    """Near to a plane, with something that stands within the light, or with what shows it."""
    kind, properties = NEAR_LIGHTS[name]
    if kind == "SPOT" and bpy.app.version < (4, 0, 0):
        pytest.skip("the edge of Cycles' spots had another profile")
    light = add_light(kind, energy=100, shadow_soft_size=1.0, **properties)
    if hasattr(light.data, "use_soft_falloff"):
        light.data.use_soft_falloff = soft
    elif not soft:
        pytest.skip("always soft")
    if kind == "SPOT" and not soft and what in ("plane within its radius", "lampshade"):
        pytest.skip("Cycles loses light of a spot's sphere from inside")
    if name == "narrow spot":
        scene = bpy.context.scene
        scene.specula.samples = scene.cycles.samples = 4 * BEAM_SAMPLES
    light.location = (0.5, 0.3, 0.6 if what == "plane within its radius" else 1.6)
    if what == "lampshade":
        shade = add_mesh("Shade", material=diffuse(COPPER))
        shade.location, shade.scale = (0.4, 0.3, 1.3), (0.5, 0.5, 1)
    elif what == "mirror":
        light.visible_camera = True
        mirror = new_material()
        glossy = add_node(mirror, "ShaderNodeBsdfGlossy", surface(mirror))
        glossy.inputs["Roughness"].default_value = 0.1
        wall = add_mesh("Mirror", material=mirror)
        wall.location, wall.rotation_euler = (0, 2.5, 1), (math.pi / 2, 0, 0)
        wall.scale = (2, 1, 1)
    stage()


def test_world(stage):
    add_sky()
    stage()


@pytest.mark.parametrize("animated", ["energy", "strength", "world", "material", "lens"])
def test_animation(stage, animated):
    """Of a later frame, whose values are not those that the file holds as well."""
    add_sky()
    light = add_light("POINT", energy=100, shadow_soft_size=0)
    place(light)
    scene = bpy.context.scene
    light.data.use_nodes = True
    nodes = light.data.node_tree.nodes
    owner, name = {
        "energy": (light.data, "energy"),
        "strength": (
            next(n for n in nodes if n.type == "EMISSION").inputs["Strength"],
            "default_value",
        ),
        "world": (scene.world.node_tree.nodes["Background"].inputs["Strength"], "default_value"),
        "material": (
            bpy.data.materials[0].node_tree.nodes["Diffuse BSDF"].inputs["Color"],
            "default_value",
        ),
        "lens": (scene.camera.data, "lens"),
    }[animated]
    owner.keyframe_insert(name, frame=1)
    value = getattr(owner, name)
    setattr(owner, name, COPPER if animated == "material" else 8 * value)
    owner.keyframe_insert(name, frame=9)
    scene.frame_set(4)
    stage()


LAYERS = ("use_sky", "use_solid", "material_override", "world_override")


@pytest.mark.parametrize("setting", LAYERS)
def test_view_layer(stage, setting):
    layer = bpy.context.view_layer
    if setting not in layer.bl_rna.properties:
        pytest.skip("no such setting")
    add_sky(2.0)
    override = bpy.context.scene.world
    add_sky()
    place(add_light("AREA", energy=500, size=1.0))
    values = {"material_override": diffuse(COPPER), "world_override": override}
    setattr(layer, setting, values.get(setting, False))
    stage()


@pytest.mark.parametrize("name", MATERIALS)
def test_material(stage, name):
    bl_idname, distribution, inputs = MATERIALS[name]
    add_ball(bl_idname, distribution, inputs)
    stage(TOLERANCE_CLOSURES)


@pytest.mark.parametrize("name", OTHERS)
def test_other_closures(stage, name):
    bl_idname, distribution, inputs = OTHERS[name]
    if not hasattr(bpy.types, bl_idname) or (
        bl_idname == "ShaderNodeBsdfPrincipled" and bpy.app.version < (4, 3, 0)
    ):
        pytest.skip("not in this Blender")
    add_ball(bl_idname, distribution, inputs)
    stage(TOLERANCE_CLOSURES)


TILTS = ("diffuse", "glossy", "glass")


@pytest.mark.parametrize("name", TILTS)
def test_normals_far_from_the_surface(render, name):
    """By squares: a map of a quarter turn on the whole, on flat and on smooth surfaces."""
    if name == "glass" and bpy.app.version < (4, 0, 0):
        pytest.skip("rough glass divided light by its own normal, not by its facets'")
    kind = {"diffuse": "Diffuse", "glossy": "Glossy", "glass": "Glass"}[name]
    material = new_material()
    shader = add_node(material, f"ShaderNodeBsdf{kind}", surface(material))
    if name != "diffuse":
        shader.inputs["Roughness"].default_value = 0.3
    mapped = add_node(material, "ShaderNodeNormalMap", shader.inputs["Normal"], space="OBJECT")
    coordinates = add_node(material, "ShaderNodeTexCoord", mapped.inputs["Color"])
    material.node_tree.links.new(coordinates.outputs["Generated"], mapped.inputs["Color"])
    scale = add_node(material, "ShaderNodeMapping", mapped.inputs["Color"])
    material.node_tree.links.new(coordinates.outputs["Normal"], scale.inputs["Vector"])
    scale.inputs["Rotation"].default_value = (0.9, 0.3, 0)
    scale.inputs["Scale"].default_value = (0.5, 0.5, 0.5)
    scale.inputs["Location"].default_value = (0.5, 0.5, 0.5)
    add_sky()
    place(add_light("AREA", energy=300, size=1.0))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.2)
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material)
    add_camera((0, 0, 6))
    bpy.context.scene.specula.samples = bpy.context.scene.cycles.samples = 8 * SAMPLES
    ours, theirs = (in_squares(render(engine)[..., 0]) for engine in ("SPECULA", "CYCLES"))
    atol = TOLERANCE * theirs.mean()
    np.testing.assert_allclose(ours, theirs, rtol=TOLERANCE_CLOSURES, atol=atol)


def test_holdout(render):
    """Black, and a hole in the alpha, half of one where it is mixed."""
    material = new_material()
    mix = add_node(material, "ShaderNodeMixShader", surface(material))
    add_node(material, "ShaderNodeHoldout", mix.inputs[1])
    add_node(material, "ShaderNodeEmission", mix.inputs[2])
    add_mesh("Plane", PLANE, material=material)
    add_camera((0, 0, 6))
    bpy.context.scene.render.film_transparent = True
    ours, theirs = (render(engine).mean(axis=(0, 1)) for engine in ("SPECULA", "CYCLES"))
    np.testing.assert_allclose(ours, theirs, atol=1e-3)
    assert 0.1 < ours[3] < 0.9


@pytest.mark.skipif(bpy.app.version < (4, 3, 0), reason="the coat was another")
@pytest.mark.parametrize("name", COATS)
def test_coat(stage, name):
    inputs = {"Coat Weight": 1.0, "Coat Roughness": 0.3, **COATS[name]}
    add_ball("ShaderNodeBsdfPrincipled", "GGX", inputs)
    stage(TOLERANCE_CLOSURES)


def add_ball(bl_idname, distribution, inputs) -> None:
    """A ball of one shader, in light from all around."""
    add_sky()
    place(add_light("AREA", energy=300, size=1.0))
    material = new_material()
    shader = add_node(material, bl_idname, surface(material))
    if distribution:
        shader.distribution = distribution
    for socket, value in inputs.items():
        compat.find_input(shader, socket).default_value = value
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.2, location=(0, 0, 1.3))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material)


def relief():
    """A height that varies as slowly as its texels let it, from 0 to 1."""
    size = 16
    image = bpy.data.images.new("relief", size, size, float_buffer=True, is_data=True)
    y, x = np.mgrid[:size, :size] * (2 * np.pi / size)
    height = 0.5 + 0.25 * (np.sin(x) + np.cos(2 * y))
    image.pixels.foreach_set(np.stack([height] * 3 + [height * 0 + 1], -1).ravel().astype("f"))
    image.update()
    return image


def enlarge(factor: int) -> None:
    """More pixels, with fewer samples in each."""
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = factor * SIZE
    scene.specula.samples = scene.cycles.samples = SAMPLES // factor


def in_squares(pixels: np.ndarray) -> np.ndarray:
    """Means over 8 x 8 squares of a picture."""
    size = len(pixels) // 8
    return pixels.reshape(8, size, 8, size).mean(axis=(1, 3))


BUMPS = {
    "plain": {},
    "inverted": {"invert": True},
    "weak": {"Strength": 0.4},
    "strong": {"Strength": 1.6, "Distance": 0.08},
}


@pytest.mark.parametrize("name", BUMPS)
def test_bump(render, name):
    """By squares of the picture: on the whole, bumps may do nothing."""
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    bump = add_node(material, "ShaderNodeBump", shader.inputs["Normal"])
    settings = {"Strength": 1.0, "Distance": 0.12, **BUMPS[name]}
    bump.invert = settings.pop("invert", False)
    for socket, value in settings.items():
        bump.inputs[socket].default_value = value
    if "Filter Width" not in bump.inputs:  # Cycles takes differences over a whole pixel
        enlarge(8)
    texture = add_node(material, "ShaderNodeTexImage", bump.inputs["Height"], image=relief())
    texture.interpolation = "Cubic"
    bpy.ops.mesh.primitive_plane_add(size=4)
    plane = bpy.context.object
    plane.data.materials.append(material)
    plane.scale = (1, 1.5, 1)
    add_camera((0, 0, 6))
    sun = add_light("SUN", energy=3, angle=0.0)
    sun.rotation_euler = (0.5, 0.7, 0)
    ours, theirs = (in_squares(render(engine)[..., 0]) for engine in ("SPECULA", "CYCLES"))
    assert ours.std() > 2 * TOLERANCE * ours.mean()
    np.testing.assert_allclose(ours, theirs, atol=TOLERANCE * theirs.mean())


def test_background_on_a_surface(stage):
    material = new_material()
    add_node(material, "ShaderNodeBackground", surface(material)).inputs[
        "Color"
    ].default_value = COPPER
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.2, location=(0, 0, 1.3))
    bpy.context.object.data.materials.append(material)
    stage()


WORLDS = {
    "emission": "ShaderNodeEmission",
    "colour": "ShaderNodeRGB",
    "nothing": None,
    "diffuse": "ShaderNodeBsdfDiffuse",
}


@pytest.mark.parametrize("name", WORLDS)
def test_world_without_a_background(stage, name):
    place(add_light("AREA", energy=300, size=1.0))
    world = new_world()
    if WORLDS[name]:
        node = add_node(world, WORLDS[name], surface(world))
        color = node.outputs[0] if name == "colour" else node.inputs["Color"]
        color.default_value = COPPER
    stage()


@pytest.mark.parametrize("kind", ["VERTS", "FACES", "COLLECTION", "PARTICLES"])
def test_instances(stage, kind):
    """Of a cube, on the corners, the faces or the particles of a grid, or in a collection."""
    add_sky()
    place(add_light("SUN", energy=2))
    bpy.ops.mesh.primitive_cube_add(size=0.6)
    cube = bpy.context.object
    cube.data.materials.append(diffuse(COPPER))
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=3, size=3, location=(0, 0, 1))
    grid = bpy.context.object
    grid.show_instancer_for_render = False
    if kind in ("VERTS", "FACES"):
        cube.parent, grid.instance_type = grid, kind
    elif kind == "COLLECTION":
        collection = bpy.data.collections.new("Cubes")
        bpy.context.scene.collection.objects.unlink(cube)
        collection.objects.link(cube)
        bpy.ops.object.empty_add(location=(1, 0, 1))
        bpy.context.object.instance_type = kind
        bpy.context.object.instance_collection = collection
    else:
        grid.modifiers.new("Particles", "PARTICLE_SYSTEM")
        settings = grid.particle_systems[0].settings
        settings.count, settings.frame_start, settings.frame_end = 20, 1, 1
        settings.physics_type, settings.particle_size = "NO", 0.8
        settings.render_type, settings.instance_object = "OBJECT", cube
        cube.location.z = -9
        bpy.context.scene.frame_set(2)
    stage()


# What fills a glass ball, or, without a surface, a box around all that is seen, camera and lamp.
MEDIA = {
    "absorption": ("ShaderNodeVolumeAbsorption", {"Color": COPPER, "Density": 1.5}),
    "principled": (
        "ShaderNodeVolumePrincipled",
        {"Color": (0, 0, 0, 1), "Density": 0.7, "Absorption Color": COPPER},
    ),
}


def fill(material, name, density=1.0) -> None:
    bl_idname, inputs = MEDIA[name]
    medium = add_node(material, bl_idname, output_of(material).inputs["Volume"])
    for socket, value in inputs.items():
        medium.inputs[socket].default_value = value
    medium.inputs["Density"].default_value *= density


@pytest.mark.parametrize("name", MEDIA)
def test_coloured_glass(stage, name):
    add_sky()
    light = add_light("AREA", energy=600, size=5.0)
    light.location = (0, 0, 6)
    material = new_material()
    glass = add_node(material, "ShaderNodeBsdfGlass", surface(material))
    glass.inputs["IOR"].default_value = 1.4
    fill(material, name)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.2, location=(0, 0, 1.3))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material)
    stage()


@pytest.mark.parametrize("name", MEDIA)
def test_smoke_around_camera_and_lamp(stage, name):
    place(add_light("AREA", energy=300, size=1.0))
    material = new_material()
    fill(material, name, density=0.1)
    bpy.ops.mesh.primitive_cube_add(size=2, scale=(12, 12, 12))
    bpy.context.object.data.materials.append(material)
    stage()


def moments(image: np.ndarray) -> dict[str, np.ndarray]:
    """Of what glows: its mean, centre and spread in pixels, and its shape whatever its size."""
    y, x = np.mgrid[:SIZE, :SIZE]
    weights = image / image.sum()
    center = np.array([(weights * x).sum(), (weights * y).sum()])
    x, y = x - center[0], y - center[1]
    spread = np.sqrt([(weights * x * x).sum(), (weights * y * y).sum()])
    x, y = x / spread[0], y / spread[1]
    shape = [(weights * x**i * y**j).sum() for i, j in ((1, 1), (3, 0), (2, 1), (1, 2), (0, 3))]
    return {"mean": image.mean(), "center": center, "spread": spread, "shape": np.array(shape)}


@pytest.mark.parametrize("name", CAMERAS)
def test_camera(render, name):
    kind, dof = CAMERAS[name]
    scene = bpy.context.scene
    scene.specula.samples = scene.cycles.samples = CAMERA_SAMPLES
    camera = add_camera((0, 0, 5)).data
    camera.type, camera.ortho_scale, camera.shift_x = kind, 3.6, 0.05
    camera.clip_start = 0.001  # where Cycles 3.4 has an orthographic camera's lens
    for key, value in (dof or {}).items():
        setattr(camera.dof, key, value)
    camera.dof.use_dof = dof is not None
    material = new_material()
    add_node(material, "ShaderNodeEmission", surface(material))
    card = add_mesh("Card", material=material)
    card.scale, card.location = (0.35, 0.35, 1), (0.2, -0.1, 0)
    ours, theirs = (moments(render(engine)[..., 0]) for engine in ("SPECULA", "CYCLES"))
    assert ours["mean"] == pytest.approx(theirs["mean"], rel=TOLERANCE)
    np.testing.assert_allclose(ours["spread"], theirs["spread"], rtol=TOLERANCE)
    np.testing.assert_allclose(ours["center"], theirs["center"], atol=0.05)  # pixels
    np.testing.assert_allclose(ours["shape"], theirs["shape"], atol=0.02)
