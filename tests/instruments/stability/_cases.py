# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes in which methods fail, and what each is held against."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from specula.export import desc
from tests.instruments.stability._scenes import (
    FLOOR_ALBEDO,
    Maker,
    brilliant,
    camera,
    diffuse,
    directions,
    displaced_slab,
    floor_points,
    glass,
    grid,
    mapped,
    mirror,
    moved_and_scaled,
    placed,
    rotation_x,
    rotation_z,
    roughened,
    slab,
    sphere,
    square,
    waves,
)

BRUTE_FORCE, LIGHT_PATHS = "path tracing", "light paths"


@dataclass(frozen=True)
class Case:
    name: str
    hazard: str
    build: Callable[[], desc.SceneDesc]
    # The name of an independent method, or a function to the picture, (H, W) float64.
    truth: str | Callable[[], np.ndarray] = BRUTE_FORCE
    # With 1 there are caustics without the light that they throw on: so have it closed forms and
    # light paths. To those, light that a rough caster throws on has been scattered once more.
    diffuse_bounces: int = 1
    samples: int | None = None  # of its truth, where the usual number says too little
    least_samples: int = 0  # of each method, where fewer do not know of their noise's tail


def over(*casters, light=lambda maker: maker.bulb()) -> desc.SceneDesc:
    """Casters, each (mesh, material, transform), above the floor under a light."""
    maker = Maker()
    for caster in casters:
        maker.add(*caster)
    light(maker)
    return maker.scene


BALL = placed((0.0, 0.0, 0.7))
FINE = 708  # quads along each side of a grid: a million triangles
UNSEEN = desc.Visibility.ALL & ~desc.Visibility.CAMERA


def unseen(*casters, light=lambda maker: maker.bulb()) -> desc.SceneDesc:
    """As `over`, by casters that the camera does not see.

    Light paths have no caustics in mirrors or glass, and a small light seen in a caster may be most
    of a picture, and all of its noise.
    """
    scene = over(*casters, light=light)
    for instance in scene.instances[1:]:
        instance.visibility = UNSEEN
    return scene


# ---- closed forms


def point_irradiance(distance_down: float, foot: tuple[float, float], intensity: float):
    """Radiance of the floor under a point light of so many W/sr at a height above it."""
    p = floor_points()
    squared = ((p[..., :2] - np.array(foot)) ** 2).sum(axis=-1) + distance_down**2
    irradiance = intensity * distance_down / squared**1.5
    return (irradiance * FLOOR_ALBEDO / math.pi).mean(axis=-1)


LAMP, POWER, CEILING = (0.3, 0.4, 1.0), 50.0, 2.5


def plane_mirror() -> desc.SceneDesc:
    return over(
        (square(6.0), mirror(), placed((0, 0, CEILING), rotation_x(math.pi))),
        light=lambda maker: maker.bulb(LAMP, 0.0, POWER),
    )


def plane_mirror_truth() -> np.ndarray:
    """The lamp's mirror image above the ceiling."""
    return point_irradiance(2.0 * CEILING - LAMP[2], LAMP[:2], POWER / (4.0 * math.pi))


def dielectric_reflectance(cosine: np.ndarray, ior: float) -> np.ndarray:
    """[Fresnel], unpolarised, from outside."""
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / ior**2)
    s = (cosine - ior * inside) / (cosine + ior * inside)
    p = (ior * cosine - inside) / (ior * cosine + inside)
    return 0.5 * (s**2 + p**2)


SLAB_HEIGHT, SLAB_THICKNESS, SLAB_IOR = 0.6, 0.3, 1.5
BELOW_SLAB = (0.0, -0.5, 0.4), 0.4  # eye, view


def flat_slab() -> desc.SceneDesc:
    scene = over(
        (slab(3.0, SLAB_THICKNESS), glass(SLAB_IOR), placed((0, 0, SLAB_HEIGHT))),
        light=lambda maker: maker.bulb((0.3, 0.4, 2.0), 0.0, POWER),
    )
    scene.camera = camera(*BELOW_SLAB)
    return scene


def flat_slab_truth() -> np.ndarray:
    """A ring of light between two cones becomes a ring on the floor: I sin t dt = E r dr.

    The camera looks under the slab: from below it, by light that passed it once or with two
    reflections inside.
    """
    p = floor_points(*BELOW_SLAB)
    r = np.hypot(p[..., 0] - 0.3, p[..., 1] - 0.4)
    theta = np.linspace(1e-4, 1.4, 20000)
    sine_inside = np.sin(theta) / SLAB_IOR
    tangent_inside = sine_inside / np.sqrt(1.0 - sine_inside**2)
    reflectance = dielectric_reflectance(np.cos(theta), SLAB_IOR)
    irradiance = np.zeros_like(r)
    for reflections in (0, 2):
        radius = (2.0 - SLAB_THICKNESS) * np.tan(theta)
        radius += (1 + reflections) * SLAB_THICKNESS * tangent_inside
        passed = (1.0 - reflectance) ** 2 * reflectance**reflections
        density = passed * np.sin(theta) / (radius * np.gradient(radius, theta))
        irradiance += np.interp(r, radius, density * POWER / (4.0 * math.pi))
    return (irradiance * FLOOR_ALBEDO / math.pi).mean(axis=-1)


# ---- scenes


def critical_angle() -> desc.SceneDesc:
    turned = placed((0.0, 0.1, 0.6), rotation_x(0.7))
    return over((slab(0.35, 0.6), glass(), turned), light=lambda m: m.bulb((0.3, -1.2, 1.4)))


def grazing() -> desc.SceneDesc:
    return over(
        (sphere(0.5, 48), mirror(), placed((0.0, 0.6, 0.52))),
        light=lambda maker: maker.bulb((0.3, -3.0, 0.3), 0.2),
    )


def water() -> desc.SceneDesc:
    """Camera and floor below the surface."""
    scene = over(
        (square(4.0), glass(1.33), placed((0, 0, 0.8))),
        light=lambda m: m.bulb((0.4, 0.3, 2.2), 0.4),
    )
    scene.camera = camera((0.0, -1.0, 0.7), 0.4)
    return scene


def without_uv_map() -> desc.SceneDesc:
    """A normal map on UVs that are all the same."""
    maker = Maker()
    shape = grid("panel", 2, lambda at: np.c_[2 * at - 1, 0 * at[:, 0]] * 0.7, uv=True)
    shape.attributes[0].values[:] = 0.25
    material = mapped(mirror(), maker.image(waves(0.2)))
    maker.add(shape, material, placed((0.0, 0.8, 0.7), rotation_x(1.3)))
    return maker.bulb((0.0, -1.0, 1.5)).scene


def degenerate_triangles() -> desc.SceneDesc:
    shape = sphere(0.4)
    zero = np.array([(5, 5, 5), (7, 8, 7), (0, 1, 1)], np.uint32)
    shape.triangles = np.concatenate([shape.triangles, zero])
    shape.normals = np.concatenate([shape.normals, np.tile((0.0, 0.0, 1.0), (3, 3, 1))])
    shape.normals = np.ascontiguousarray(shape.normals, np.float32)
    return over((shape, mirror(), BALL))


def steep_map(material) -> desc.SceneDesc:
    """Normals that leave many reflections below the surface, under grazing light."""
    maker = Maker()
    maker.add(
        square(0.6, uv=True),
        mapped(material, maker.image(waves(1.2))),
        placed((0.0, 0.5, 0.8), rotation_x(1.2)),
    )
    return maker.bulb((0.0, -1.5, 1.0), 0.25).scene


def nested() -> desc.SceneDesc:
    """Water in glass, the light within."""
    return over(
        (sphere(0.45), glass(1.5), BALL),
        (sphere(0.3), glass(1.33 / 1.5), BALL),
        light=lambda maker: maker.bulb((0.05, 0.0, 0.75), 0.1, 20.0),
    )


def camera_in_glass() -> desc.SceneDesc:
    scene = over((sphere(0.4), mirror(), BALL), (sphere(0.2), glass(), placed((0, -3, 2))))
    return scene


def folds() -> desc.SceneDesc:
    """Pairs of solutions that meet on many curves."""
    maker = Maker()
    maker.add(
        square(0.9, uv=True),
        mapped(mirror(), maker.image(waves(0.12))),
        placed((0.0, 0.9, 0.8), rotation_x(1.2)),
        visibility=UNSEEN,
    )
    return maker.bulb((0.0, -1.5, 1.8), 0.3).scene


def egg() -> desc.SceneDesc:
    """Wavy glass: straight lines through it tell little of where chains are."""

    def radius(at):
        return 0.35 * (
            1.0 + 0.08 * np.sin(6.0 * math.pi * at[..., 1]) * np.sin(10 * math.pi * at[..., 0])
        )

    def position(at):
        return radius(at)[..., None] * directions(at) * (1.0, 1.0, 1.3)

    def normal(at, h=1e-4):
        du, dv = np.array([h, 0.0]), np.array([0.0, h])
        inner = at * (1.0, 1.0 - 4.0 * h) + (0.0, 2.0 * h)  # the poles have no tangents
        n = np.cross(
            position(inner + du) - position(inner - du), position(inner + dv) - position(inner - dv)
        )
        return n / np.linalg.norm(n, axis=-1, keepdims=True)

    return over((grid("egg", 48, position, normal), glass(), BALL))


def displaced() -> desc.SceneDesc:
    """Two wavy sides: what a straight line through both meets is far from where a chain does."""
    return over((displaced_slab(0.7, 0.2, 0.03), glass(), BALL))


def many_lights() -> desc.SceneDesc:
    maker = Maker().add(sphere(0.4), mirror(), BALL)
    rng = np.random.default_rng(3)
    for power in 10.0 ** rng.uniform(-6.0, 6.0, 100):
        x, y = rng.uniform(-1.0, 1.0, 2)
        maker.bulb((x, y, 2.0), 0.2, float(power))
    return maker.scene


def quarters_apart() -> desc.SceneDesc:
    """Each quarter of the picture has its own ball and lamps, thousands of times as bright as
    those of the quarter before, between black walls that reach above both."""
    maker = Maker()
    for turn in (rotation_x(0.5 * math.pi), rotation_z(0.5 * math.pi) @ rotation_x(0.5 * math.pi)):
        maker.add(square(1.2), diffuse(0.0), placed(turn=turn), desc.CausticsRole.OFF)
    rng = np.random.default_rng(5)
    for quarter, (x, y) in enumerate(((-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5))):
        maker.add(sphere(0.15), mirror(), placed((x, y, 0.3)), visibility=UNSEEN)
        for power in 10.0 ** (quarter * 11.0 / 3.0 - 6.0 + rng.uniform(0.0, 1.0, 4)):
            dx, dy = rng.uniform(-0.3, 0.3, 2)
            maker.bulb((x + dx, y + dy, 0.9), 0.1, float(power))
    maker.scene.camera = camera((0.0, -0.05, 4.0), 0.25)
    return maker.scene


def pole_and_seam() -> desc.SceneDesc:
    """A dark sky but for two discs: about the zenith, where all columns of its image meet, and
    across the edge of the image."""
    height = 128
    pixels = np.zeros((height, 2 * height, 3), np.float32)
    pixels[-3:] = 100.0
    rows = slice(3 * height // 4 - 3, 3 * height // 4 + 3)
    pixels[rows, :4] = pixels[rows, -4:] = 50.0
    image = desc.ImageDesc("sky", pixels=pixels, color_space=desc.ColorSpace.LINEAR)
    return over(
        (sphere(0.35), mirror(), placed((-0.4, 0.0, 0.6))),
        (sphere(0.35), glass(), placed((0.4, 0.0, 0.6))),
        light=lambda maker: maker.panorama(image),
    )


def both_sides() -> desc.SceneDesc:
    """Sheets without an inside: glass that faces up, glass that faces down and the back of a
    mirror, with lamps above and below."""
    return over(
        (square(0.5), glass(), placed((-0.55, 0.0, 0.8))),
        (square(0.5), glass(), placed((0.55, 0.0, 0.8), rotation_x(math.pi))),
        (square(0.5), mirror(), placed((0.0, 0.9, 0.6), rotation_x(1.35 + math.pi))),
        light=lambda maker: maker.bulb((0.1, 0.0, 1.8)).bulb((0.0, -0.3, 0.3), 0.2, 50.0),
    )


def rough_neighbours() -> desc.SceneDesc:
    """Facets of one estimate lead from glass to a mirror, or past it."""
    return over(
        (sphere(0.35), roughened(glass(), 0.15), placed((0.0, 0.2, 0.5))),
        (square(0.5), roughened(mirror(), 0.15), placed((0.0, 0.75, 0.6), rotation_x(1.35))),
    )


def rough_relief() -> desc.SceneDesc:
    """A wavy pane of frosted glass: its normal map makes some chains at facets of one slope."""
    maker = Maker()
    frosted = roughened(glass(), 0.15)
    maker.add(square(0.6, uv=True), mapped(frosted, maker.image(waves(0.3))), BALL)
    return maker.bulb().scene


def furnace() -> desc.SceneDesc:
    return (
        Maker()
        .add(sphere(0.4), mirror(), BALL)
        .add(sphere(0.2), glass(), placed((0.5, 0.3, 0.4)))
        .sky()
        .scene
    )


def of_another_size(scale: float, offset=(0.0, 0.0, 0.0)):
    return lambda: moved_and_scaled(over((sphere(0.4), mirror(), BALL)), scale, offset)


def between_mirrors(first=None) -> desc.SceneDesc:
    return over(
        (square(0.5), first or mirror(), placed((0.0, 0.9, 0.8), rotation_x(1.35))),
        (square(0.5), mirror(), placed((0.0, -0.9, 1.3), rotation_x(-1.2))),
        light=lambda maker: maker.bulb((0.0, 0.2, 2.2)),
    )


CASES = (
    Case("plane mirror", "closed form, one reflection", plane_mirror, plane_mirror_truth),
    Case("flat slab", "closed form, two refractions and more", flat_slab, flat_slab_truth),
    Case("critical angle", "derivatives grow without bound", critical_angle),
    Case("grazing", "silhouettes: many misses", grazing),
    Case("water", "half-vectors of reflections solve refractions", water),
    Case(
        "coarse smooth ball",
        "normals' derivatives jump at edges",
        lambda: over((sphere(0.4, 8), mirror(), BALL)),
    ),
    Case(
        "faceted ball",
        "no derivatives of normals",
        lambda: over((sphere(0.4, 12, smooth=False), mirror(), BALL)),
    ),
    Case("one UV for all", "no tangents from UVs", without_uv_map),
    Case("degenerate triangles", "no area, no normal", degenerate_triangles),
    Case(
        "steep map, mirror",
        "normals below the horizon",
        lambda: steep_map(mirror()),
        least_samples=512,
    ),
    Case("steep map, glass", "normals below the horizon", lambda: steep_map(glass())),
    Case(
        "thin glass",
        "sides 1 mm apart",
        lambda: over((slab(0.6, 0.001), glass(), placed((0.0, 0.2, 0.7), rotation_x(0.4)))),
        least_samples=512,
    ),
    Case("double-sided planes", "sides without an inside", both_sides),
    Case("nested glass, light within", "media on both ends", nested),
    Case("camera in glass", "a medium at the camera", camera_in_glass),
    Case(
        "IOR 1",
        "interactions that change nothing",
        lambda: over((sphere(0.4), glass(1.0), BALL)),
    ),
    Case("glass ball", "reflections and refractions", lambda: over((sphere(0.4), glass(), BALL))),
    Case(
        "a million triangles",
        "solutions on facets of a thousandth",
        lambda: over((sphere(0.4, FINE), glass(), BALL)),
    ),
    Case(
        "cut stone",
        "no derivatives of normals, between facets",
        lambda: over((brilliant(0.45), glass(), placed((0.0, 0.1, 0.6), rotation_x(0.35)))),
    ),
    Case("two mirrors", "chains across objects", between_mirrors),
    Case(
        "rough ball",
        "a facet for each estimate",
        lambda: over((sphere(0.4), roughened(mirror(), 0.15), BALL)),
        diffuse_bounces=2,
    ),
    Case(
        "rough glass ball",
        "two facets for each estimate",
        lambda: over((sphere(0.4), roughened(glass(), 0.15), BALL)),
        diffuse_bounces=2,
    ),
    Case(
        "rough and smooth mirror",
        "rough chains across objects",
        lambda: between_mirrors(roughened(mirror(), 0.1)),
        diffuse_bounces=2,
    ),
    Case(
        "rough neighbours",
        "facets that lead to another object",
        rough_neighbours,
        diffuse_bounces=2,
    ),
    Case(
        "rough and mapped",
        "several chains at facets of one slope",
        rough_relief,
        diffuse_bounces=2,
    ),
    Case(
        "light on a caster",
        "distances shrink to nothing",
        lambda: over(
            (sphere(0.3, 48), mirror(), placed((0.0, 0.0, 0.4))),
            light=lambda maker: maker.bulb((0.0, 0.0, 0.8), 0.1, 10.0),
        ),
    ),
    Case(
        "sun",
        "directions instead of points",
        lambda: over((sphere(0.4), mirror(), BALL), light=lambda maker: maker.sun(0.1)),
    ),
    Case(
        "sun without size",
        "path tracing is blind",
        lambda: unseen((sphere(0.4), mirror(), BALL), light=lambda maker: maker.sun(0.0)),
        LIGHT_PATHS,
    ),
    Case("pole and seam of the sky", "no longitude, or two", pole_and_seam),
    Case(
        "point light",
        "path tracing is blind",
        lambda: unseen((sphere(0.4), glass(), BALL), light=lambda m: m.bulb(radius=0.0)),
        LIGHT_PATHS,
    ),
    Case("0.1 mm", "scale", of_another_size(1e-4)),
    Case("100 km", "scale", of_another_size(1e5)),
    Case(
        "1 km from the origin",
        "digits are lost",
        of_another_size(1.0, (800, -600, 0)),
    ),
    Case(
        "1000 km from the origin",
        "scale, digits are lost",
        of_another_size(1e5, (8e5, -6e5, 0)),
    ),
    Case(
        "stretched and mirrored",
        "normals of instances",
        lambda: over(
            (sphere(0.4), glass(), placed((0, 0, 0.7), rotation_x(0.5), (1.5, -0.7, 0.9)))
        ),
    ),
    Case(
        "folds",
        "solutions in pairs, ever closer",
        folds,
        samples=16384,
        least_samples=512,
    ),
    Case("wavy egg", "seeds on straight lines fail", egg),
    Case("displaced slab", "seeds on straight lines fail", displaced),
    Case("a hundred lights, 1e-6 to 1e6 W", "starvation, overflow", many_lights),
    Case("a quarter each, 1e-6 to 1e6 W", "starvation, overflow", quarters_apart),
    Case("furnace", "an even sky: nothing is a caustic", furnace),
)
