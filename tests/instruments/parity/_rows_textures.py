# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of textures with their modes, seen as light."""

from __future__ import annotations

from tests.instruments.parity._nodes import GENERATED, OBJECT, UV, N, Row, modes, shown

METRICS = ("EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI")
FEATURES = ("F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE", "N_SPHERE_RADIUS")
NOISES = ("MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "FBM", "HETERO_TERRAIN")
DIMENSIONS = ("1D", "2D", "3D", "4D")


def texture(kind: str, inputs=None, output=0, vector=OBJECT):
    """Makes rows of one kind of texture, for `modes`."""
    sockets = {"Vector": vector} | (inputs or {})
    return lambda name, **properties: shown(name, N(kind, sockets, output, **properties))


def _images():
    image = texture("TexImage", vector=UV)
    yield image("texture/image", image="photo")
    yield from modes(
        "texture/image",
        lambda name, **p: texture("TexImage")(name, image="photo", **p),
        {
            "interpolation": ("Linear", "Closest", "Cubic", "Smart"),
            "extension": ("REPEAT", "EXTEND", "CLIP", "MIRROR"),
        },
    )
    yield from modes(
        "texture/image",
        lambda name, **p: texture("TexImage", vector=GENERATED)(name, image="photo", **p),
        {"projection": ("FLAT", "BOX", "SPHERE", "TUBE")},
    )
    box = {"projection": "BOX", "projection_blend": 0.3}
    yield texture("TexImage", vector=GENERATED)("texture/image/box_blend", image="photo", **box)
    yield image("texture/image/float", image="hues")
    yield image("texture/image/alpha", image="cutout")
    yield texture("TexImage", output="Alpha", vector=UV)(
        "texture/image/alpha_output", image="cutout"
    )
    for mode in ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"):
        settings = {"image": "cutout", "image.alpha_mode": mode}
        yield image(f"texture/image/alpha_mode={mode.lower()}", **settings)
    yield from modes(
        "texture/environment",
        lambda name, **p: texture("TexEnvironment")(name, image="sky", **p),
        {
            "projection": ("EQUIRECTANGULAR", "MIRROR_BALL"),
            "interpolation": ("Linear", "Closest", "Cubic"),
        },
    )


def _noises():
    inputs = {"Scale": 1.7, "Detail": 3.0, "Roughness": 0.6, "W": 0.3, "Distortion": 0.4}
    yield from modes("texture/noise", texture("TexNoise", inputs), {"noise_dimensions": DIMENSIONS})
    yield texture("TexNoise", inputs, output="Color")("texture/noise/color")
    yield texture("TexNoise", inputs)("texture/noise/unnormalized", normalize=False)
    for kind in NOISES:
        more = inputs | {"Lacunarity": 2.2, "Offset": 0.7, "Gain": 0.9}
        yield texture("TexNoise", more)(f"texture/noise/{kind.lower()}", noise_type=kind)
        old = {"Scale": 1.7, "Detail": 3.0, "Dimension": 0.8, "Offset": 0.7, "Gain": 0.9}
        yield texture("TexMusgrave", old)(f"texture/musgrave/{kind.lower()}", musgrave_type=kind)
    inputs = {"Scale": 1.7, "W": 0.3}
    yield from modes("texture/voronoi", texture("TexVoronoi", inputs), {"feature": FEATURES})
    yield from modes(
        "texture/voronoi",
        texture("TexVoronoi", inputs | {"Exponent": 0.7}),
        {"distance": METRICS, "voronoi_dimensions": DIMENSIONS},
    )
    for output in ("Color", "Position"):
        voronoi = texture("TexVoronoi", inputs, output)
        yield voronoi(f"texture/voronoi/{output.lower()}")
    detail = inputs | {"Detail": 2.0, "Roughness": 0.6, "Lacunarity": 2.2, "Randomness": 0.6}
    yield texture("TexVoronoi", detail)("texture/voronoi/detail", normalize=True)
    yield from modes(
        "texture/white_noise",
        lambda name, **p: shown(
            name, N("TexWhiteNoise", {"Vector": _cells(), "W": 0.3}, "Color", **p)
        ),
        {"noise_dimensions": DIMENSIONS},
    )
    yield from modes(
        "texture/gabor", texture("TexGabor", {"Scale": 1.5}), {"gabor_type": ("2D", "3D")}
    )


def _cells():
    """Few values, that all of a pixel's samples share."""
    return N("TexImage", {"Vector": UV}, image="ramp", interpolation="Closest")


def _patterns():
    wave = texture("TexWave", {"Scale": 0.8, "Distortion": 1.5, "Detail": 1.0})
    axes = ("X", "Y", "Z", "DIAGONAL")
    yield from modes(
        "texture/wave",
        wave,
        {"bands_direction": axes, "wave_profile": ("SIN", "SAW", "TRI")},
    )
    for axis in ("X", "Y", "Z", "SPHERICAL"):
        yield wave(f"texture/wave/rings_{axis.lower()}", wave_type="RINGS", rings_direction=axis)
    yield from modes(
        "texture/magic",
        texture("TexMagic", {"Scale": 0.7, "Distortion": 1.2}),
        {"turbulence_depth": (0, 2, 5)},
    )
    kinds = ("LINEAR", "QUADRATIC", "EASING", "DIAGONAL", "SPHERICAL", "QUADRATIC_SPHERE", "RADIAL")
    yield from modes("texture/gradient", texture("TexGradient"), {"gradient_type": kinds})
    red, blue = (0.8, 0.2, 0.1, 1.0), (0.1, 0.3, 0.8, 1.0)
    checks = texture("TexChecker", {"Color1": red, "Color2": blue, "Scale": 2.3})
    yield checks("texture/checker")
    yield texture("TexChecker", {"Scale": 2.3}, "Fac")("texture/checker/fac")
    bricks = {"Color1": red, "Color2": blue, "Mortar": (0.7, 0.7, 0.6, 1.0), "Scale": 2.0}
    bricks |= {"Mortar Size": 0.05, "Mortar Smooth": 0.3, "Bias": 0.2}
    yield texture("TexBrick", bricks)("texture/brick")
    yield texture("TexBrick", bricks)("texture/brick/offset", offset=0.3, offset_frequency=3)
    yield texture("TexBrick", bricks)("texture/brick/squash", squash=0.6, squash_frequency=2)
    yield texture("TexBrick", bricks, "Fac")("texture/brick/fac")


def _sky(**properties):
    shader = N("Background", {"Color": N("TexSky", **properties), "Strength": 0.3})
    return lambda stage: stage.world(shader)


def _skies():
    for kind in ("PREETHAM", "HOSEK_WILKIE", "NISHITA", "SINGLE_SCATTERING", "MULTIPLE_SCATTERING"):
        yield Row(f"texture/sky/{kind.lower()}", _sky(sky_type=kind))
    yield Row("texture/sky/low_sun", _sky(sun_elevation=0.1, sun_size=0.1))


def rows():
    yield from _images()
    yield from _noises()
    yield from _patterns()
    yield from _skies()
