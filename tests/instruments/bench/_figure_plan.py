# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pictures stand on which sheet: the figures of [Zeltner20], with scenes of this project."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from tests.instruments.bench import _program, _scenes
from tests.instruments.bench._scenes import Scene
from tools.common import DevError

SEED = 1  # of every picture: each is rendered once
LONG = 8.0  # times the seconds of others has a picture that stands for a reference


@dataclass(frozen=True)
class Panel:
    """One cell of a sheet: a crop, or the whole of the reference with the crop's frame."""

    label: str
    settings: dict = field(default_factory=dict, hash=False)  # of scene.specula
    edits: dict = field(default_factory=dict, hash=False)  # of the scene, as _image_job has them
    role: str = "crop"  # or "reference", "whole"


@dataclass(frozen=True)
class View:
    """A square part of one of blend_scenes/."""

    scene: str
    size: tuple[int, int]  # of the whole picture, in pixels
    centre: tuple[float, float]  # of the part, as shares of width and height from the bottom left
    side: float  # of the part, as a share of the longer side
    exposure: float = 1.0  # factor

    def scaled(self, longer: int | None) -> tuple[int, int]:
        """Width and height with `longer` pixels along the longer side; None: as `size` says."""
        factor = longer / max(self.size) if longer else 1.0
        width, height = (max(1, round(factor * pixels)) for pixels in self.size)
        return width, height

    def crop(self, size: tuple[int, int]) -> tuple[slice, slice]:
        """Rows and columns, from the bottom left, of the part of a picture of `size`; inside."""
        side = min(max(1, round(self.side * max(size))), *size)
        left, bottom = (
            min(max(0, round(share * pixels - 0.5 * side)), pixels - side)
            for share, pixels in zip(self.centre, size, strict=True)
        )
        return slice(bottom, bottom + side), slice(left, left + side)


@dataclass(frozen=True)
class Row:
    """Panels that show the same part at the same exposure."""

    view: View
    panels: tuple[Panel, ...]
    edits: dict = field(default_factory=dict, hash=False)
    label: str = ""


@dataclass(frozen=True)
class Figure:
    name: str  # on the command line and of the file
    title: str
    text: str  # what to look at
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Shot:
    """A picture to be rendered, as _store.Image says."""

    scene: Scene
    size: tuple[int, int]
    settings: dict = field(hash=False)
    edits: dict = field(hash=False)  # as _image_job has them
    budget: float  # s of rendering
    threads: int

    @property
    def name(self) -> str:
        return f"figure_{self.scene.name}_{self.settings['method'].lower()}_{self.budget:g}s"

    @property
    def family(self) -> str:
        return "specula"

    @property
    def job(self) -> dict:
        return self.edits | {
            "engine": "SPECULA",
            "method": self.settings["method"],
            "specula": self.settings,
            "scene": str(self.scene.blend),
            "size": self.size,
            "threads": self.threads,
            "seconds": self.budget,
            "seed": SEED,
        }


# ------------------------------------------------------------------------------------- methods

WHOLE = Panel("Crop", role="whole")
REFERENCE = Panel("Reference", role="reference")


def walks(label: str, method: str, constraint: str, two_stage: bool, **settings) -> Panel:
    """The manifold by itself: what light paths find is left to the path tracer."""
    return Panel(
        label,
        {
            "method": method,
            "light_tracing": "OFF",
            "constraint": constraint,
            "two_stage": two_stage,
            **settings,
        },
    )


def unbiased(
    label: str, constraint: str = "ANGLE_DIFFERENCE", two_stage: bool = True, **settings
) -> Panel:
    return walks(label, "SMS_UNBIASED", constraint, two_stage, **settings)


def biased(
    label: str,
    set_size: int,
    constraint: str = "ANGLE_DIFFERENCE",
    two_stage: bool = True,
    **settings,
) -> Panel:
    return walks(label, "SMS_BIASED", constraint, two_stage, set_size=set_size, **settings)


PATH_TRACING = Panel("Path tracing", {"method": "PT"})
MNEE = Panel("MNEE", {"method": "MNEE", "light_tracing": "OFF"})
MNEE_BIASED = Panel("MNEE, biased", {"method": "MNEE_BIASED", "light_tracing": "OFF"})
SHEETS = Panel("Light sheets", {"method": "SHEETS", "light_tracing": "OFF"})
AUTOMATIC = Panel("Automatic", {"method": "AUTO", "light_tracing": "AUTO"})

# ------------------------------------------------------------------------------------- figures

SQUARE, WIDE = (256, 256), (256, 144)
PLANE = View("reflective_plane", SQUARE, (0.47, 0.28), 0.38)
SPHERE = View("refractive_sphere", SQUARE, (0.52, 0.48), 0.4)
POOL = View("swimming_pool", WIDE, (0.36, 0.36), 0.28, exposure=0.7)
RING = View("ring", SQUARE, (0.57, 0.59), 0.38)
DISPLACED, MAPPED = (View("displaced", WIDE, (x, 0.36), 0.4) for x in (0.34, 0.72))
SLAB = View("slab", SQUARE, (0.5, 0.33), 0.42)
ROUGHNESSES = (0.0, 0.01, 0.02, 0.05, 0.1, 0.2)


def row(view: View, *panels: Panel) -> Row:
    return Row(view, panels)


def rough(method: Panel) -> Row:
    """The golden panel, smooth as the scene has it, to rough."""
    panels = (
        Panel(
            f"{method.label}, roughness {value:g}",
            method.settings,
            {"roughness": {"Gold": value}} if value else {},
        )
        for value in ROUGHNESSES
    )
    return row(PLANE, *panels)


def relief(label: str, view: View, hidden: str) -> Row:
    """One of the two panels of the same relief, the other left out."""
    panels = (WHOLE, PATH_TRACING, unbiased("SMS unbiased"), AUTOMATIC, REFERENCE)
    return Row(view, panels, {"hidden": [hidden]}, label)


FIGURES = {
    figure.name: figure
    for figure in (
        Figure(
            "ring",
            "Solutions inside a ring (after Fig. 4)",
            "Inside the cusp a point sees several solutions, outside of it one. A biased set of M "
            "walks loses those that it does not find.",
            (
                row(
                    RING,
                    WHOLE,
                    unbiased("SMS unbiased"),
                    *(biased(f"SMS biased, M = {count}", count) for count in (1, 4, 16)),
                    REFERENCE,
                ),
            ),
        ),
        Figure(
            "sphere",
            "From MNEE to two-stage walks (after Fig. 6)",
            "Each column adds to the one before it. Above unbiased, below biased with M = 16: as "
            "more walks succeed, trials become fewer and the bias smaller.",
            (
                row(
                    SPHERE,
                    WHOLE,
                    MNEE,
                    unbiased("SMS", "HALF_VECTOR", False),
                    unbiased("+ angle difference", "ANGLE_DIFFERENCE", False),
                    unbiased("+ two stages", "ANGLE_DIFFERENCE", True),
                ),
                row(
                    SPHERE,
                    REFERENCE,
                    MNEE_BIASED,
                    biased("SMS biased", 16, "HALF_VECTOR", False),
                    biased("+ angle difference", 16, "ANGLE_DIFFERENCE", False),
                    biased("+ two stages", 16, "ANGLE_DIFFERENCE", True),
                ),
            ),
        ),
        Figure(
            "constraints",
            "Half-vector against angle difference (after Fig. 8)",
            "Walks of one stage, unbiased.",
            tuple(
                row(
                    view,
                    WHOLE,
                    unbiased("Half-vector", "HALF_VECTOR", False),
                    unbiased("Angle difference", "ANGLE_DIFFERENCE", False),
                    REFERENCE,
                )
                for view in (PLANE, SPHERE)
            ),
        ),
        Figure(
            "two_stage",
            "One stage against two (after Fig. 9)",
            "On casters with a normal map, unbiased. The first stage walks on the smooth surface.",
            tuple(
                row(
                    view,
                    WHOLE,
                    unbiased("One stage", two_stage=False),
                    unbiased("Two stages", two_stage=True),
                    REFERENCE,
                )
                for view in (PLANE, POOL)
            ),
        ),
        Figure(
            "main",
            "All methods (after Fig. 14)",
            "Automatic is what renders use: light sheets, with light paths where they pay.",
            tuple(
                row(
                    view,
                    WHOLE,
                    PATH_TRACING,
                    MNEE,
                    unbiased("SMS unbiased"),
                    biased("SMS biased, M = 16", 16),
                    AUTOMATIC,
                    REFERENCE,
                )
                for view in (PLANE, SPHERE, POOL)
            ),
        ),
        Figure(
            "displacement",
            "Displacement against normal map (after Fig. 16)",
            "The same relief, above as geometry of 135 200 triangles, below as a normal map on one "
            "quad.",
            (
                relief("Displaced", DISPLACED, "Mapped panel"),
                relief("Normal map", MAPPED, "Displaced panel"),
            ),
        ),
        Figure(
            "roughness",
            "Casters from smooth to rough (after Fig. 17)",
            "The golden panel's roughness, as Blender has it. Walks have a facet drawn for each "
            "estimate; the automatic method has light paths beside them.",
            (rough(PATH_TRACING), rough(unbiased("SMS unbiased")), rough(AUTOMATIC)),
        ),
        Figure(
            "slab",
            "Through a slab of wavy glass (after Fig. 18)",
            "Light is refracted twice; walks look for such chains alone, as those of the paper.",
            (
                row(
                    SLAB,
                    WHOLE,
                    PATH_TRACING,
                    MNEE,
                    unbiased("SMS unbiased", chain_family="TT"),
                    biased("SMS biased, M = 16", 16, chain_family="TT"),
                    SHEETS,
                    AUTOMATIC,
                    REFERENCE,
                ),
            ),
        ),
    )
}


def chosen(names: str | None) -> list[Figure]:
    """Those of a list separated by commas; all of them for None."""
    if names is None:
        return list(FIGURES.values())
    wanted = _program.split(names)
    if not wanted:
        raise DevError("--figures names none")
    for name in wanted:
        if name not in FIGURES:
            raise DevError(f"no figure '{name}'; there are: {' '.join(FIGURES)}")
    return [FIGURES[name] for name in wanted]


def shot(line: Row, panel: Panel, seconds: float, longer: int | None, threads: int) -> Shot | None:
    """What to render for a panel; None where the reference is stored.

    A crop is all that is rendered of its picture: time goes into what is shown.
    """
    scene, size = _scenes.example(line.view.scene), line.view.scaled(longer)
    edits = line.edits | panel.edits
    if panel.role == "crop":
        rows, columns = line.view.crop(size)
        edits |= {"border": [columns.start, rows.start, columns.stop, rows.stop]}
        return Shot(scene, size, panel.settings, edits, seconds, threads)
    if has_reference(line, panel, longer):
        return None
    return Shot(scene, size, AUTOMATIC.settings, edits, LONG * seconds, threads)


def has_reference(line: Row, panel: Panel, longer: int | None) -> bool:
    """Whether one is stored that shows the same scene at the same size."""
    scene = _scenes.example(line.view.scene)
    if line.edits or panel.edits or not scene.reference_path.exists():
        return False
    return line.view.scaled(longer) == scene.size


def shots(
    figures: Iterable[Figure], seconds: float, longer: int | None, threads: int
) -> list[Shot]:
    """All to be rendered, in the order of the sheets; pictures that several show stay several."""
    return [
        wanted
        for figure in figures
        for line in figure.rows
        for panel in line.panels
        if (wanted := shot(line, panel, seconds, longer, threads))
    ]
