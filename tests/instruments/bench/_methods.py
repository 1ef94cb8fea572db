# SPDX-License-Identifier: GPL-3.0-or-later
"""The methods that are compared: a row for each, ours and the others'."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from tests.instruments.bench import _children, _luxcore
from tests.instruments.bench._scenes import Scene
from tools import venvs
from tools.common import DevError


@dataclass(frozen=True)
class Family:
    """A renderer: where its child processes run (of _children.HOSTS), and which script."""

    label: str
    where: str
    script: str
    line: str  # style of its lines in charts, as Matplotlib names them
    described: bool = False  # the script reads what Specula exports, not the .blend

    def missing(self) -> str:
        """Why it cannot run here; empty if it can. Sets up what it runs in."""
        if not (_children.HERE / self.script).exists():
            return "there is no program for it in tests/instruments/bench/"
        try:
            _children.HOSTS[self.where](self.script, Path())
        except DevError as error:
            return str(error)
        return ""


FAMILIES = {
    "specula": Family("Specula", "specula in bpy", "_image_job.py", "-"),
    "cycles": Family(f"Cycles {venvs.BPY_VERSION}", "bpy", "_image_job.py", "--"),
    "luxcore": Family("LuxCore", "luxcore", "_luxcore_job.py", ":", described=True),
}

# Groups of at most eight methods, each of another colour, that share a chart, and their titles.
GROUPS = {
    "best": "ours and the others'",
    "variants": "constraints and stages",
    "sets": "numbers of walks of the biased method",
    "light": "manifold sampling, light tracing, and both",
    "starts": "random walks and MNEE seeds",
    "luxcore": "LuxCore",
    "glints": "ways to average glints over a pixel (where none is named: the search of all parts)",
}
WITH_GLINTS = ("kettle", "shoes")  # of the example scenes
PLAIN = {"glints": "OFF"}  # of materials: path traced like anything else

# Okabe and Ito's colours, which colour-blind readers can tell apart, without their yellow, which
# is too pale for a line.
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILLION, PURPLE, GREY = "#0072B2", "#D55E00", "#CC79A7", "#767676"

# Of Specula; a scene may say otherwise.
DEFAULT_WALK = {"constraint": "ANGLE_DIFFERENCE", "two_stage": True}
# Of Cycles: what would change its mean, and has no counterpart in Specula.
NOTHING_TAKEN_AWAY = {
    "sample_clamp_direct": 0.0,
    "sample_clamp_indirect": 0.0,
    "blur_glossy": 0.0,
    "light_sampling_threshold": 0.0,
}

BIASED_GLINTS = ("WALKS_BIASED", "YAN")
MNEE_NOTE = (
    "Cycles' walks ignore normal maps, refract only, and drop reflected caustics at receivers"
)


@dataclass(frozen=True)
class Method:
    name: str  # on the command line and in files
    label: str
    family: str  # of FAMILIES
    job: dict = field(hash=False)  # what the child is told beside scene, time and seed
    groups: tuple[str, ...]
    color: str
    marker: str
    unbiased: bool = True
    path_traced: bool = False  # its error falls as 1/time from the first sample on
    correlated: bool = False  # errors of pixels that are far apart depend on each other
    leaves_out: str = ""  # light paths that it does not have by design
    hidden: bool = False  # runs only if it is named: for tests of the bench itself
    scenes: tuple[str, ...] = ()  # of the example scenes those on which it is anything new; (): all

    @property
    def line(self) -> str:
        return FAMILIES[self.family].line

    @property
    def full_label(self) -> str:
        return f"{FAMILIES[self.family].label} {self.label}"


def _specula(
    name, label, groups, color, marker, light_factor=1.0, scenes=(), materials=None, **settings
) -> Method:
    method = settings["method"]
    biased = method.endswith("_BIASED") or settings.get("glint_method") in BIASED_GLINTS
    job = {"engine": "SPECULA", "method": method, "specula": settings, "light_factor": light_factor}
    if materials:
        job["materials"] = materials
    return Method(
        name,
        label,
        "specula",
        job,
        groups,
        color,
        marker,
        unbiased=not biased and light_factor == 1.0,
        path_traced=method == "PT",
        hidden=light_factor != 1.0,
        scenes=scenes,
    )


def _unbiased(
    name, label, groups, color, marker, constraint, two_stage, light_tracing="OFF"
) -> Method:
    settings = {
        "method": "SMS_UNBIASED",
        "constraint": constraint,
        "two_stage": two_stage,
        "light_tracing": light_tracing,
    }
    return _specula(name, label, groups, color, marker, **settings)


def _biased(walks: int, color: str, marker: str, *groups: str, light_tracing="OFF") -> Method:
    settings = {"method": "SMS_BIASED", "set_size": walks, **DEFAULT_WALK}
    name, label = f"biased-{walks}", f"SMS biased, {walks} walks"
    if light_tracing != "OFF":
        name, label = f"{name}-lt", f"{label} + LT"
    settings["light_tracing"] = light_tracing
    return _specula(name, label, groups, color, marker, **settings)


def _mnee_seeds(name, label, color, marker, method) -> Method:
    return _specula(name, label, ("starts",), color, marker, method=method, light_tracing="OFF")


def _glints(name, label, color, marker, glint_method, **settings) -> Method:
    """As sheets-lt, but for the glints, for which that has the search."""
    return _specula(
        name,
        label,
        ("glints",),
        color,
        marker,
        scenes=WITH_GLINTS,
        method="SHEETS",
        light_tracing="ON",
        glint_method=glint_method,
        **settings,
    )


def _cycles(name, label, color, marker, **changes) -> Method:
    settings = {"use_guiding": name == "cycles-guiding"} | NOTHING_TAKEN_AWAY
    job = {"engine": "CYCLES", "cycles": settings}
    biased = "shadow_caustics" in changes
    return Method(
        name,
        label,
        "cycles",
        job | changes,
        {"cycles-pt": ("best", "glints"), "cycles-mnee": ("best", "starts")}.get(name, ("best",)),
        color,
        marker,
        unbiased=not biased,
        path_traced=name == "cycles-pt",
        leaves_out=MNEE_NOTE if biased else "",
    )


def _lux(name, label, color, marker, *groups, unbiased=True, correlated=False) -> Method:
    return Method(
        name,
        label,
        "luxcore",
        {"method": name},
        groups,
        color,
        marker,
        unbiased=unbiased,
        correlated=correlated,
    )


METHODS = {
    method.name: method
    for method in (
        _specula(
            "pt",
            "path tracing",
            ("best", "variants", "light", "starts", "glints"),
            *(BLACK, "o"),
            method="PT",
        ),
        _specula("lt", "light tracing", ("light",), ORANGE, "v", method="LT"),
        _unbiased(
            "sms",
            "SMS unbiased",
            ("best", "variants", "sets", "light", "starts", "luxcore"),
            *(VERMILLION, "s", "ANGLE_DIFFERENCE", True),
        ),
        _unbiased(
            "sms-lt",
            "SMS unbiased + LT",
            ("light",),
            *(PURPLE, "P", "ANGLE_DIFFERENCE", True),
            light_tracing="ON",
        ),
        _specula(
            "sheets",
            "light sheets",
            ("light",),
            *(SKY, "D"),
            method="SHEETS",
            light_tracing="OFF",
        ),
        _specula(
            "sheets-lt",
            "light sheets + LT",
            ("light", "glints"),
            *(GREEN, "*"),
            method="SHEETS",
            light_tracing="ON",
        ),
        _specula("auto", "automatic", ("best", "luxcore"), GREEN, "P", method="AUTO"),
        _unbiased(
            "sms-one", "SMS, one stage", ("variants",), ORANGE, "p", "ANGLE_DIFFERENCE", False
        ),
        _unbiased("sms-half", "SMS, half-vector", ("variants",), BLUE, "^", "HALF_VECTOR", True),
        _unbiased(
            "sms-half-one",
            "SMS, half-vector, one stage",
            ("variants",),
            *(SKY, "h", "HALF_VECTOR", False),
        ),
        _biased(4, SKY, "v", "sets"),
        _biased(8, BLUE, ">", "sets"),
        _biased(16, GREEN, "D", "sets", "starts"),
        _biased(16, BLUE, "<", "light", light_tracing="ON"),
        _biased(32, PURPLE, "p", "sets"),
        _mnee_seeds("mnee", "MNEE unbiased", BLUE, "P", "MNEE"),
        _mnee_seeds("mnee-biased", "MNEE biased", SKY, "^", "MNEE_BIASED"),
        _specula(
            "pt-plain",
            "plain path tracing",
            ("glints",),
            *(GREY, "s"),
            scenes=WITH_GLINTS,
            materials=PLAIN,
            method="PT",
        ),
        _glints("glints-walks", "glints by walks", VERMILLION, "^", "WALKS"),
        _glints("glints-walks-8", "glints by 8 walks", SKY, ">", "WALKS_BIASED", set_size=8),
        _glints("glints-yan", "glints by Gaussians", PURPLE, "X", "YAN"),
        _cycles("cycles-pt", "path tracing", BLUE, "o"),
        _cycles("cycles-guiding", "path guiding", SKY, "^"),
        _cycles("cycles-mnee", "shadow caustics", PURPLE, "X", shadow_caustics=True),
        _lux("lux-light", "light tracing", GREY, "h", "best", "light", "luxcore"),
        _lux("lux-cache", "photon cache", BLUE, "P", "luxcore", unbiased=False, correlated=True),
        _lux("lux-bidir-sobol", "bidirectional", SKY, "<", "luxcore"),
        _lux(
            "lux-bidir-metropolis",
            "bidir. Metropolis",
            *(ORANGE, ">", "best", "luxcore"),
            correlated=True,
        ),
        # Two percent too dark: the bias must show.
        _specula("pt-dim", "dimmed", (), GREY, "x", light_factor=0.98, method="PT"),
    )
}

QUICK = (
    *("pt", "lt", "sms", "sheets-lt", "auto", "biased-16"),
    *("cycles-pt", "cycles-mnee", "lux-light"),
)
SMS, CYCLES = "sms", "cycles-pt"  # what each method is held against, beside the best of LuxCore


def other_model(method: str, scene: Scene) -> str:
    """Why a method would not render the same thing, by what is known; empty if it would."""
    if METHODS[method].family == "luxcore" and scene.is_example:
        return _luxcore.DIFFERENT_MODELS.get(scene.name, "")
    return ""


def suited(names: Iterable[str], scene: Scene) -> list[str]:
    """Those that would not only repeat another one on this scene."""
    return [
        name
        for name in names
        if not (METHODS[name].scenes and scene.is_example) or scene.name in METHODS[name].scenes
    ]


def missing(names: Iterable[str]) -> dict[str, str]:
    """Families among the methods `names` that cannot run here, and why."""
    families = dict.fromkeys(METHODS[name].family for name in names)
    return {family: why for family in families if (why := FAMILIES[family].missing())}
