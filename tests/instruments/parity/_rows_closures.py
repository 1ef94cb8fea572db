# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of closures under a lamp and a sky; the sphere shows all angles, the card its back."""

from __future__ import annotations

from tests.instruments.parity._nodes import COLORS, HUES, UV, N, lit

COPPER = (0.8, 0.4, 0.2, 1.0)
PALE = (0.7, 0.85, 0.9, 1.0)
ROUGHNESSES = (0.0, 0.1, 0.3, 0.6, 1.0)
DISTRIBUTIONS = ("GGX", "BECKMANN", "MULTI_GGX", "ASHIKHMIN_SHIRLEY")

# Inputs of the Principled BSDF, each on a base on which it shows.
PRINCIPLED = {
    "default": {},
    "metal": {"Metallic": 1.0, "Roughness": 0.3},
    "half_metal": {"Metallic": 0.5},
    "ior": {"IOR": 2.2},
    "low_ior": {"IOR": 1.05},
    "no_specular": {"Specular IOR Level": 0.0},
    "much_specular": {"Specular IOR Level": 1.0},
    "specular_tint": {"Specular Tint": COPPER, "Specular IOR Level": 1.0},
    "metal_tint": {"Metallic": 1.0, "Specular Tint": COPPER, "Roughness": 0.3},
    "alpha": {"Alpha": 0.4},
    "textured": {"Base Color": HUES, "Roughness": COLORS, "Metallic": COLORS},
    "glass": {"Transmission Weight": 1.0, "Roughness": 0.0},
    "frosted_glass": {"Transmission Weight": 1.0, "Roughness": 0.4},
    "half_glass": {"Transmission Weight": 0.5, "Roughness": 0.2},
    "glass_tint": {"Transmission Weight": 1.0, "Roughness": 0.2, "Specular Tint": COPPER},
    "diffuse_roughness": {"Diffuse Roughness": 1.0},
    "subsurface": {"Subsurface Weight": 1.0, "Subsurface Scale": 0.2},
    "subsurface_half": {"Subsurface Weight": 0.5, "Subsurface Anisotropy": 0.6},
    "anisotropic": {"Metallic": 1.0, "Roughness": 0.4, "Anisotropic": 0.8},
    "anisotropic_rotated": {
        "Metallic": 1.0,
        "Roughness": 0.4,
        "Anisotropic": 0.8,
        "Anisotropic Rotation": 0.2,
    },
    "sheen": {"Sheen Weight": 1.0, "Sheen Roughness": 0.5},
    "sheen_tint": {"Sheen Weight": 1.0, "Sheen Tint": COPPER, "Sheen Roughness": 0.2},
    "coat": {"Coat Weight": 1.0},
    "rough_coat": {"Coat Weight": 1.0, "Coat Roughness": 0.5},
    "coat_ior": {"Coat Weight": 1.0, "Coat IOR": 2.0},
    "coat_tint": {"Coat Weight": 1.0, "Coat Tint": COPPER},
    "coat_on_metal": {"Coat Weight": 0.6, "Metallic": 1.0, "Roughness": 0.5},
    "emission": {"Emission Color": COPPER, "Emission Strength": 0.7},
    "thin_film": {"Thin Film Thickness": 400.0, "Thin Film IOR": 1.4, "Roughness": 0.2},
    "thin_film_metal": {"Thin Film Thickness": 400.0, "Metallic": 1.0, "Roughness": 0.2},
    "thin_wall": {"Thin Wall": 1.0, "Transmission Weight": 1.0},
}


def label(name: str, **values) -> str:
    return name + "".join(f"/{key}={str(value).lower()}" for key, value in values.items())


def _over_roughness(name, kind, inputs, distributions=(None,), roughnesses=ROUGHNESSES):
    for distribution in distributions:
        mode = {"distribution": distribution} if distribution else {}
        for roughness in roughnesses:
            shader = N(kind, inputs | {"Roughness": roughness}, **mode)
            yield lit(label(name, **mode, roughness=roughness), shader)


def _plain():
    yield from _over_roughness(
        "closure/diffuse", "BsdfDiffuse", {"Color": COPPER}, (None,), (0, 0.3, 1)
    )
    yield from _over_roughness("closure/glossy", "BsdfGlossy", {"Color": COPPER}, DISTRIBUTIONS)
    glass = {"Color": PALE, "IOR": 1.45}
    yield from _over_roughness("closure/glass", "BsdfGlass", glass, DISTRIBUTIONS[:3])
    yield lit("closure/glass/ior=1.0", N("BsdfGlass", {"IOR": 1.0, "Roughness": 0.2}))
    yield lit("closure/glass/ior=0.7", N("BsdfGlass", {"IOR": 0.7, "Roughness": 0.2}))
    yield lit("closure/glass/ior=2.4", N("BsdfGlass", {"IOR": 2.4, "Roughness": 0.0}))
    yield from _over_roughness("closure/refraction", "BsdfRefraction", glass, DISTRIBUTIONS[:2])
    yield lit("closure/transparent", N("BsdfTransparent", {"Color": PALE}))
    yield lit("closure/translucent", N("BsdfTranslucent", {"Color": COPPER}))
    yield lit("closure/emission", N("Emission", {"Color": COPPER, "Strength": 0.7}))
    yield lit("closure/background_on_surface", N("Background", {"Color": HUES}))
    yield lit("closure/holdout", N("Holdout"))
    yield lit("closure/ray_portal", N("BsdfRayPortal"))
    yield lit("closure/color_as_shader", HUES)
    for component in ("DIFFUSE", "GLOSSY"):
        toon = N("BsdfToon", {"Color": COPPER, "Smooth": 0.2}, component=component)
        yield lit(label("closure/toon", component=component), toon)
    for distribution in ("MICROFIBER", "ASHIKHMIN"):
        yield from _over_roughness(
            "closure/sheen", "BsdfSheen", {"Color": COPPER}, (distribution,), (0.2, 0.7)
        )
    yield lit("closure/velvet", N("BsdfVelvet", {"Color": COPPER}))
    for component in ("Reflection", "Transmission"):
        hair = N("BsdfHair", {"Color": COPPER, "RoughnessU": 0.3}, component=component)
        yield lit(label("closure/hair", component=component), hair)
    for model in ("CHIANG", "HUANG"):
        yield lit(
            label("closure/principled_hair", model=model), N("BsdfHairPrincipled", model=model)
        )
    for method in ("BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN"):
        inputs = {"Color": COPPER, "Scale": 0.2}
        yield lit(
            label("closure/subsurface", falloff=method),
            N("SubsurfaceScattering", inputs, falloff=method),
        )
    for fresnel in ("F82", "PHYSICAL_CONDUCTOR"):
        shader = N("BsdfMetallic", {"Roughness": 0.3}, fresnel_type=fresnel)
        yield lit(label("closure/metallic", fresnel=fresnel), shader)
    film = {"Roughness": 0.2, "Thin Film Thickness": 400.0, "Thin Film IOR": 1.4}
    yield lit("closure/metallic/thin_film", N("BsdfMetallic", film))
    yield lit("closure/glass/thin_film", N("BsdfGlass", film))


def _anisotropic():
    tangent = N("Tangent", direction_type="RADIAL", axis="Z")
    for amount in (-0.6, 0.4, 0.9):
        inputs = {"Color": COPPER, "Roughness": 0.4, "Anisotropy": amount}
        name = label("closure/glossy", anisotropy=amount)
        yield lit(name, N("BsdfAnisotropic", inputs))
    turned = inputs | {"Rotation": 0.2, "Tangent": tangent}
    yield lit("closure/glossy/tangent", N("BsdfAnisotropic", turned))


def _combined():
    glossy, diffuse = N("BsdfGlossy", {"Roughness": 0.2}), N("BsdfDiffuse", {"Color": HUES})
    fresnel = N("Fresnel", {"IOR": 1.5})
    ramp = N("TexImage", {"Vector": UV}, image="ramp")
    for factor, name in ((0.3, "constant"), (ramp, "textured"), (fresnel, "fresnel")):
        yield lit(f"closure/mix/{name}", N("MixShader", {0: factor, 1: diffuse, 2: glossy}))
    clear = N("BsdfTransparent")
    cut = N("TexImage", {"Vector": UV}, "Alpha", image="cutout")
    yield lit("closure/mix/cutout", N("MixShader", {0: cut, 1: clear, 2: diffuse}))
    yield lit("closure/mix/one_side", N("MixShader", {0: 0.6, 2: diffuse}))
    dark = N("BsdfGlossy", {"Color": (0.2, 0.2, 0.2, 1.0), "Roughness": 0.2})
    yield lit("closure/add", N("AddShader", {0: diffuse, 1: dark}))
    backs = N("NewGeometry", output="Backfacing")
    yield lit("closure/mix/backfacing", N("MixShader", {0: backs, 1: diffuse, 2: glossy}))


def _principled():
    for name, inputs in PRINCIPLED.items():
        base = {"Base Color": COPPER} | inputs
        yield lit(f"closure/principled/{name}", N("BsdfPrincipled", base))
    roughnesses = {"Base Color": COPPER}
    yield from _over_roughness("closure/principled", "BsdfPrincipled", roughnesses)
    metal = {"Base Color": COPPER, "Metallic": 1.0}
    for distribution in ("GGX", "MULTI_GGX"):
        shader = N("BsdfPrincipled", metal | {"Roughness": 0.8}, distribution=distribution)
        yield lit(label("closure/principled/metal", distribution=distribution), shader)
    for method in ("BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN"):
        inputs = {"Base Color": COPPER, "Subsurface Weight": 1.0, "Subsurface Scale": 0.2}
        shader = N("BsdfPrincipled", inputs, subsurface_method=method)
        yield lit(label("closure/principled/subsurface", method=method), shader)


def _volumes():
    clear = N("BsdfGlass", {"Roughness": 0.0, "IOR": 1.3})
    absorbing = N("VolumeAbsorption", {"Color": COPPER, "Density": 0.8})
    yield lit("volume/absorption_in_glass", clear, Volume=absorbing)
    yield lit("volume/absorption_alone", None, Volume=absorbing)
    inputs = {"Color": (0, 0, 0, 1), "Absorption Color": COPPER, "Density": 0.8}
    yield lit("volume/principled_absorbs", clear, Volume=N("VolumePrincipled", inputs))
    yield lit("volume/scatter", None, Volume=N("VolumeScatter", {"Density": 0.5}))
    yield lit("volume/principled_scatters", None, Volume=N("VolumePrincipled", {"Density": 0.5}))
    glow = N("Emission", {"Color": COPPER, "Strength": 0.3})
    yield lit("volume/emission", None, Volume=glow)


def rows():
    yield from _plain()
    yield from _anisotropic()
    yield from _combined()
    yield from _principled()
    yield from _volumes()
