# SPDX-License-Identifier: GPL-3.0-or-later
"""`specula` on scenes, objects, lights, worlds and view layers."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

METHODS = (
    (
        "AUTO",
        "Automatic",
        "Light sheets, light paths and path tracing, each where it pays",
    ),
    ("PT", "Path Tracing", "Path tracing alone, without manifold sampling"),
    ("SMS_UNBIASED", "SMS Unbiased", "Specular Manifold Sampling with a random number of trials"),
    (
        "SMS_BIASED",
        "SMS Biased",
        "Specular Manifold Sampling with a fixed number of walks: less noise, "
        "but the light paths that these walks miss are lost",
    ),
    (
        "SHEETS",
        "Light Sheets",
        "All light paths through casters at once, from grids of rays that each light sends",
    ),
    (
        "LT",
        "Light Tracing",
        "Path tracing from the camera and from the light, without manifold sampling",
    ),
    (
        "MNEE",
        "MNEE Unbiased",
        "Manifold Next Event Estimation, to compare with: a refraction looked for along the "
        "straight line to the light, a reflection from the middle of a caster. "
        "What that misses is path traced",
    ),
    (
        "MNEE_BIASED",
        "MNEE Biased",
        "Manifold Next Event Estimation: less noise, but what it misses is lost",
    ),
)

LIGHT_TRACING = (
    ("AUTO", "Automatic", "Trace as many paths from the light as pay"),
    ("ON", "On", "Trace paths from the light, too; today the same as automatic"),
    ("OFF", "Off", "Find caustics from the camera's side alone"),
)

CONSTRAINTS = (
    ("HALF_VECTOR", "Half Vector", "Align the half vector with the surface normal"),
    ("ANGLE_DIFFERENCE", "Angle Difference", "Match the angles of the scattered direction"),
)

CAUSTICS_ROLES = (
    ("AUTO", "Automatic", "Cast and receive caustics as the materials suggest"),
    ("CASTER", "Caster", "Focus light on other objects"),
    ("RECEIVER", "Receiver", "Show caustics"),
    ("BOTH", "Caster and Receiver", "Focus light on other objects and show caustics"),
    ("OFF", "Off", "Leave this object's caustics to path tracing"),
)

GLINTS = (
    ("AUTO", "Automatic", "Where the roughness is constant and at most 0.4"),
    ("ON", "On", "Wherever the normal map or bump allows it, whatever the roughness"),
    ("OFF", "Off", "Look at the normal map or bump at one point for each sample"),
)

GLINT_METHODS = (
    ("SEARCH", "Search", "The one to use: the parts of the map that reflect the light"),
    (
        "WALKS",
        "Walks Unbiased",
        "To compare with: Specular Manifold Sampling's random walks on the normal map, "
        "with a random number of trials",
    ),
    (
        "WALKS_BIASED",
        "Walks Biased",
        "To compare with: a fixed number of such walks. Less noise, "
        "but the glints that these walks miss are lost",
    ),
    (
        "YAN",
        "Position-Normal Distribution",
        "To compare with: the normal map as millions of Gaussians. No noise of its own, but an "
        "approximation that is a little off, and takes memory",
    ),
)

FROM_CYCLES = "Taken from the Cycles settings if"


def _bounces(name: str) -> IntProperty:
    return IntProperty(
        name=name,
        description=f"Largest number of bounces of this kind. {FROM_CYCLES} -1",
        default=-1,
        min=-1,
        max=1024,
    )


def _tag(settings, context) -> None:
    """So that a rendered viewport hears of the change."""
    settings.id_data.update_tag()


class SpeculaSceneSettings(bpy.types.PropertyGroup):
    method: EnumProperty(name="Method", description="How caustics are found", items=METHODS)
    light_tracing: EnumProperty(
        name="Light Tracing",
        description="Paths from the light to what the camera sees, beside Specular Manifold "
        "Sampling: far less noise in caustics that are not seen in a mirror or through glass",
        items=LIGHT_TRACING,
    )
    constraint: EnumProperty(
        name="Constraint",
        description="What a walk over the caustic casters solves for",
        items=CONSTRAINTS,
        default="ANGLE_DIFFERENCE",
    )
    two_stage: BoolProperty(
        name="Two Stages",
        description="Walk on the smooth surface first where a caster has a normal map",
        default=True,
    )
    chain_family: StringProperty(
        name="Family",
        description="The only chains that walks look for, as letters from the receiver on: "
        "R is a reflection, T a refraction, TT light through a glass with two sides. "
        "The rest is path traced. Empty: all chains",
        default="",
        maxlen=6,
    )
    set_size: IntProperty(
        name="Walks",
        description="Walks for each estimate of the biased methods",
        default=16,
        min=1,
        max=4096,
    )
    glint_method: EnumProperty(
        name="Method",
        description="How light is averaged over what a pixel covers of a normal map. "
        "All but the search are there for comparison",
        items=GLINT_METHODS,
    )
    samples: IntProperty(
        name="Samples",
        description="Samples for each pixel, at most where Cycles' adaptive sampling is on. "
        f"Cycles' clamping and glossy filter are not used. {FROM_CYCLES} 0",
        default=0,
        min=0,
        max=1 << 24,
    )
    viewport_samples: IntProperty(
        name="Viewport Samples",
        description=f"Samples for each pixel of the rendered viewport. {FROM_CYCLES} 0",
        default=0,
        min=0,
        max=1 << 24,
    )
    time_limit: FloatProperty(
        name="Time Limit",
        description="Stop rendering after this time, whatever the samples. "
        "0: the time limit of the Cycles settings, usually none",
        default=0.0,
        min=0.0,
        subtype="TIME_ABSOLUTE",
        unit="TIME_ABSOLUTE",
    )
    seed: IntProperty(
        name="Seed",
        description=f"Seed of the random numbers. {FROM_CYCLES} -1",
        default=-1,
        min=-1,
    )
    max_bounces: _bounces("Total")
    max_diffuse_bounces: _bounces("Diffuse")
    max_glossy_bounces: _bounces("Glossy")
    max_transmission_bounces: _bounces("Transmission")
    max_transparent_bounces: _bounces("Transparent")


class SpeculaObjectSettings(bpy.types.PropertyGroup):
    caustics: EnumProperty(
        name="Caustics",
        description="Part of this object in caustics. Automatic honours Cycles' caster flag",
        items=CAUSTICS_ROLES,
        update=_tag,
    )


class SpeculaMaterialSettings(bpy.types.PropertyGroup):
    glints: EnumProperty(
        name="Glints",
        description="Average glossy reflections of lights over what a pixel covers of the normal "
        "map or bump: same picture, far less noise where the map is finer than a pixel",
        items=GLINTS,
        update=_tag,
    )


class SpeculaLightSettings(bpy.types.PropertyGroup):
    """Of lights and worlds."""

    caustics: BoolProperty(
        name="Caustics",
        description="Search for caustics of this light; path tracing finds it in any case",
        default=True,
        update=_tag,
    )


class SpeculaViewLayerSettings(bpy.types.PropertyGroup):
    use_pass_caustics: BoolProperty(
        name="Caustics",
        description="Deliver the light that manifold sampling and light tracing found "
        "as a pass of its own",
        default=False,
    )
    use_pass_walks: BoolProperty(
        name="Walks",
        description="Deliver the share of the walks on caustics' casters that converged, "
        "and how many trials an estimate took, as passes Walk Success and Walk Trials",
        default=False,
    )


class SpeculaShadingSettings(bpy.types.PropertyGroup):
    render_pass: EnumProperty(
        name="Render Pass",
        description="What the rendered viewport shows",
        items=(
            ("COMBINED", "Combined", "The picture", 0),
            ("CAUSTICS", "Caustics", "The light that manifold and light paths have found", 4),
            ("NORMAL", "Normal", "Shading normals, world space", 3),
        ),
        default="COMBINED",
    )


GROUPS = {
    SpeculaSceneSettings: (bpy.types.Scene,),
    SpeculaObjectSettings: (bpy.types.Object,),
    SpeculaMaterialSettings: (bpy.types.Material,),
    SpeculaLightSettings: (bpy.types.Light, bpy.types.World),
    SpeculaViewLayerSettings: (bpy.types.ViewLayer,),
    SpeculaShadingSettings: (bpy.types.View3DShading,),
}


def register() -> None:
    for group, owners in GROUPS.items():
        bpy.utils.register_class(group)
        for owner in owners:
            owner.specula = PointerProperty(type=group)


def unregister() -> None:
    for group, owners in reversed(GROUPS.items()):
        for owner in owners:
            del owner.specula
        bpy.utils.unregister_class(group)
