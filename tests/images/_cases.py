# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes, how they are changed so that path tracing converges, and how much is rendered."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Case:
    """A scene of blend_scenes/ at low resolution.

    Numbers of samples are those that give the tests their power in the time that they may take.
    `detects` is the relative error of all caustics that is found in every variant by itself,
    `detects_together` that which is found when all variants share it; large where solutions with
    small basins give rare bright samples. `detects_joint` and `detects_light` are the same with
    light tracing beside the manifold, and alone; None where it finds next to nothing, since the
    camera sees the receivers through the casters. `detects_sheets`: of both renders with sheets.
    """

    name: str
    size: tuple[int, int]  # pixels
    reference_samples: int
    samples: int  # of an unbiased render
    biased_samples: int = 0
    light_factor: float = 1.0  # on the size of every lamp
    sun: float = 0.0  # W/m^2; all lamps become suns, 0: they stay
    texels: int = 1  # the world's image is averaged over squares of so many
    max_bounces: int = 12  # fewer where what follows is noise that no manifold sampling can help
    glints: str = "AUTO"  # of all materials
    detects: float = 0.10
    detects_together: float = 0.05
    detects_joint: float = 0.15
    detects_light: float | None = None
    detects_sheets: float = 0.2


CASES = {
    case.name: case
    for case in (
        Case(
            "ring",
            (64, 64),
            20480,
            512,
            64,
            light_factor=10.0,
            max_bounces=2,
            detects_light=0.15,
        ),
        Case(
            "reflective_plane",
            (64, 64),
            20480,
            384,
            64,
            light_factor=20.0,
            max_bounces=3,
            detects=0.3,
            detects_together=0.12,
            detects_light=0.3,
            detects_sheets=0.6,
        ),
        Case(
            "refractive_sphere",
            (64, 64),
            16384,
            384,
            32,
            light_factor=10.0,
            max_bounces=3,
            detects=0.4,
            detects_together=0.15,
            detects_joint=0.8,
            detects_sheets=0.8,
        ),
        Case(
            "swimming_pool",
            (96, 54),
            12288,
            256,
            64,
            texels=16,
            max_bounces=3,
            detects=0.17,
            detects_together=0.08,
            detects_joint=0.4,
            detects_sheets=0.3,
        ),
        Case(
            "displaced",
            (48, 27),
            32768,
            256,
            64,
            light_factor=10.0,
            max_bounces=3,
            detects=0.6,
            detects_together=0.25,
            detects_joint=0.3,
            detects_light=0.4,
            detects_sheets=0.2,
        ),
        Case(
            "slab",
            (40, 40),
            32768,
            256,
            32,
            light_factor=10.0,
            max_bounces=3,
            detects=1.0,
            detects_together=0.4,
            detects_joint=0.15,
            detects_light=0.1,
            detects_sheets=0.15,
        ),
        Case("cornell", (64, 64), 8192, 1024),
    )
}
# Lights that path tracing cannot hit, and only caustics that the camera sees directly.
DELTA_LIGHTS = {
    "point": Case("ring", (64, 64), 0, 256, light_factor=0.0, max_bounces=1, detects=0.1),
    "sun": Case("ring", (64, 64), 0, 256, sun=10.0, max_bounces=1, detects=0.1),
}
# All methods at once, as artists render.
AUTOMATIC = Case("shop_window", (64, 48), 8192, 64, light_factor=20.0, max_bounces=4)
# Rough casters with normal maps: light paths find their caustics, glints what the camera sees.
GLITTERING = {
    case.name: case
    for case in (
        Case("shoes", (40, 40), 16384, 112, light_factor=10.0, max_bounces=3, detects_light=1.0),
        Case("kettle", (40, 40), 16384, 192, texels=8, max_bounces=3, detects_light=0.5),
    )
}
WITH_CASTERS = tuple(case for case in CASES.values() if case.biased_samples)
CORNELL = CASES["cornell"]

# The seed of a render is the test's plus a number of its own; none is that of a reference.
REFERENCE_SEED = 1000
SEED_STEP = 100  # between the seeds of two variants; --seed is smaller

CYCLES_SAMPLES = 8192
CYCLES_PARTS = 8  # renders with a seed each, from which the variance is estimated


@dataclass(frozen=True)
class Variant:
    """An unbiased manifold."""

    constraint: str
    two_stage: bool
    light_tracing: bool = False

    @property
    def name(self) -> str:
        stages = "two stages" if self.two_stage else "one stage"
        text = f"{self.constraint.lower().replace('_', ' ')}, {stages}"
        return f"{text}, light tracing" if self.light_tracing else text

    def settings(self, case: Case) -> dict:
        return {
            "method": "SMS_UNBIASED",
            "light_tracing": "ON" if self.light_tracing else "OFF",
            "constraint": self.constraint,
            "two_stage": self.two_stage,
            "samples": case.samples,
        }


VARIANTS = tuple(
    Variant(constraint, two_stage)
    for constraint in ("HALF_VECTOR", "ANGLE_DIFFERENCE")
    for two_stage in (False, True)
)
JOINT = Variant("ANGLE_DIFFERENCE", True, light_tracing=True)
LIGHT_TRACING = "light tracing"  # without manifold
SHEETS = {"light sheets": "OFF", "light sheets, light tracing": "ON"}
MNEE_SEEDS = "MNEE seeds"
SET_SIZES = (4, 16)  # of the biased estimator


def biased_name(set_size: int) -> str:
    return f"biased, {set_size} walks"


def renders(case: Case, seed: int) -> dict[str, dict]:
    """What the tests render of a scene with casters."""
    result = {variant.name: variant.settings(case) for variant in VARIANTS}
    for set_size in SET_SIZES:
        result[biased_name(set_size)] = {
            "method": "SMS_BIASED",
            "light_tracing": "OFF",
            "set_size": set_size,
            "samples": case.biased_samples,
        }
    result[JOINT.name] = JOINT.settings(case)
    result[LIGHT_TRACING] = {"method": "LT", "samples": case.samples}
    for name, light_tracing in SHEETS.items():
        result[name] = {
            "method": "SHEETS",
            "light_tracing": light_tracing,
            "samples": case.samples,
        }
    result[MNEE_SEEDS] = {"method": "MNEE", "light_tracing": "OFF", "samples": case.samples}
    for index, settings in enumerate(result.values()):
        settings["seed"] = seed + SEED_STEP * index
        settings["max_bounces"] = case.max_bounces
    return result
