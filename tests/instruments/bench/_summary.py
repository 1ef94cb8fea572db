# SPDX-License-Identifier: GPL-3.0-or-later
"""From images to curves: the errors of each method at each budget, and who may be compared."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field

import numpy as np

from tests.instruments.bench import _metrics
from tests.instruments.bench._methods import CYCLES, METHODS, SMS, other_model
from tests.instruments.bench._metrics import Errors, Estimate
from tests.instruments.bench._scenes import Scene
from tests.instruments.bench._schedule import Outcome
from tests.instruments.bench._store import Record, Task

TIME_TOLERANCE = 0.05  # within which two times are equal
BUDGET_TOLERANCE = TIME_TOLERANCE / 2.0  # two of them may be off in opposite directions
# From where on another renderer's mean is that of another model, not noise.
MODEL_DIFFERENCE, MODEL_STRUCTURE, MODEL_Z = 0.02, 0.05, 4.0
# What errors keep, at least, after so many times the time, if they are not noise: that would
# keep a quarter.
STANDSTILL, STANDSTILL_TIMES = 0.5, 4.0
# The regions that are shown, of those that a scene has.
REGION_TITLES = {
    "image": "whole image",
    "caustics": "caustics",
    "direct": "caustics that the camera sees directly",
    "glints": "glints",
}
REFERENCE_FACTOR = 20.0  # by which a reference's error is to be below what is measured


@dataclass(frozen=True)
class RegionErrors:
    """Of one method at one budget in one region. `mse_error` is the larger of two standard errors:
    over the seeds, and over the pixels. Biases are those of the mean image of all seeds."""

    mse: float
    mse_error: float
    mse_trimmed: float
    rel_mse: float
    rel_mse_trimmed: float
    bias: float
    bias_z: float | None  # None: not to be told of a single seed
    bias_trimmed: float
    bias_trimmed_z: float | None
    # What the seeds share of their squared error, and its standard error; None for a single seed.
    shared: tuple[float, float] | None
    # The reference's own squared error, which is subtracted already.
    reference_mse: float = 0.0
    reference_mse_trimmed: float = 0.0

    def squared(self, trimmed: bool) -> float:
        """The mean squared error of all pixels, or without the worst."""
        return self.mse_trimmed if trimmed else self.mse

    def measurable(self, trimmed: bool = False) -> bool:
        """Whether anything is left beside the reference's own error."""
        return self.squared(trimmed) > 0.0

    def near_reference(self, trimmed: bool = False) -> bool:
        """Whether the reference is too noisy for this error: part of it may be the reference's."""
        own = self.reference_mse_trimmed if trimmed else self.reference_mse
        return self.squared(trimmed) < REFERENCE_FACTOR * own


@dataclass(frozen=True)
class Point:
    """A method at one budget: means over the seeds."""

    budget: float
    seeds: int
    render_seconds: float
    load_seconds: float
    wall_seconds: float
    samples: float
    peak_memory: float  # bytes
    others_share: float  # the largest of any seed
    processors: tuple[str, ...]  # that the seeds were rendered on
    flip: Estimate
    regions: dict[str, RegionErrors]
    success_rate: float | None  # of walks
    trials: float | None  # of one estimate of a probability
    # Of the manifold's light (luminance), what came from estimates that stopped at the limit of
    # trials, which is too little.
    capped_energy_share: float | None

    @property
    def in_time(self) -> bool:
        return abs(self.render_seconds / self.budget - 1.0) <= BUDGET_TOLERANCE


@dataclass
class Curve:
    """A method on a scene."""

    method: str
    points: list[Point] = field(default_factory=list)
    failure: str = ""
    differs: str = ""  # why it is not charted: it renders something else, or nothing
    time_to_target: dict[str, str] = field(default_factory=dict)  # by region, s

    @property
    def charted(self) -> bool:
        return bool(self.points) and not self.differs

    def at(self, budget: float) -> Point | None:
        return next((point for point in self.points if point.budget == budget), None)


@dataclass
class SceneResult:
    name: str
    size: tuple[int, int]
    regions: dict[str, float]  # name -> share of the pixels
    reference: dict  # what the file says of its making, and `mse` by region
    exposure: float
    curves: dict[str, Curve]
    target: dict[str, float] = field(default_factory=dict)  # MSE by region
    notes: list[str] = field(default_factory=list)
    is_example: bool = True  # one of blend_scenes/
    caustics_known: bool = True  # else the regions say nothing of them

    @property
    def path_tracing_suffices(self) -> bool:
        return self.caustics_known and "caustics" not in self.regions

    def baseline(self, name: str, region: str, budget: float) -> str | None:
        """A method, or the best of a renderer ("luxcore")."""
        return name if name in METHODS else self.best_of(name, region, budget)

    def equal_time(
        self, method: str, baseline: str, region: str, budget: float, trimmed: bool = False
    ) -> float | None:
        """How many times smaller the MSE of `method` is than that of `baseline` after the same
        time; None where one is missing or not comparable."""
        points = []
        for name in (method, baseline):
            curve = self.curves.get(name)
            point = curve.at(budget) if curve and curve.charted else None
            if not point or region not in point.regions:
                return None
            points.append(point)
        mine, other = points
        if abs(mine.render_seconds / other.render_seconds - 1.0) > TIME_TOLERANCE:
            return None
        errors = mine.regions[region], other.regions[region]
        if not all(error.measurable(trimmed) for error in errors):
            return None
        return errors[1].squared(trimmed) / errors[0].squared(trimmed)

    def near_reference(self, methods: Sequence[str], region: str, budget: float) -> bool:
        """Whether the error of any of these is one that the reference's may be part of."""
        points = (self.curves[name].at(budget) for name in methods)
        return any(point.regions[region].near_reference() for point in points)

    def best_of(self, family: str, region: str, budget: float) -> str | None:
        """The charted method of a renderer with the smallest error that can be compared."""
        found = {
            name: point.regions[region].mse
            for name, curve in self.curves.items()
            if METHODS[name].family == family and curve.charted
            if (point := curve.at(budget)) and point.in_time
            if region in point.regions and point.regions[region].measurable()
        }
        return min(found, key=found.get) if found else None


def scene_result(
    scene: Scene,
    methods: Sequence[str],
    budgets: Sequence[float],
    outcome: Outcome,
) -> SceneResult:
    """Everything about one scene."""
    reference, masks = scene.reference, scene.regions
    factor = _metrics.exposure(reference.mean)
    result = SceneResult(
        scene.name,
        scene.size,
        {name: 1.0 if mask is None else float(mask.mean()) for name, mask in masks.items()},
        reference.about
        | {
            "mse": {name: float(_inside(reference.variance, m).mean()) for name, m in masks.items()}
        },
        factor,
        {},
        is_example=scene.is_example,
        caustics_known=scene.caustics_known,
    )
    if not scene.caustics_known:
        result.notes.append(
            "the reference does not tell where caustics are, so that path tracers, which may miss "
            "them, are not checked against it"
        )
    digest = reference.about.get("sceneDigest")
    if digest and digest != scene.digest:
        result.notes.append("the reference was made of another version of the .blend file")
    for name in methods:
        curve = result.curves[name] = Curve(name)
        curve.failure = outcome.failures.get((scene.name, name), "")
        without_samples = ""
        for budget in sorted(budgets):
            rendered = seeds_of(outcome.records, scene.name, name, budget)
            if found := with_samples(rendered):
                curve.points.append(_point(scene, name, budget, found, factor))
            elif rendered:
                without_samples = f"it has no sample after {budget:g} s"
        curve.differs = (
            outcome.untranslated.get((scene.name, name), "")
            or ("" if curve.points else without_samples)
            or other_model(name, scene)
            or _difference(curve, scene)
            or _standstill(curve)
        )
    _set_targets(result, max(budgets))
    return result


def seeds_of(
    records: Mapping[Task, Record], scene: str, method: str, budget: float
) -> list[Record]:
    """All of one point."""
    return [
        record
        for task, record in records.items()
        if (task.scene.name, task.method, task.budget) == (scene, method, budget)
    ]


def with_samples(records: Sequence[Record]) -> list[Record]:
    """Those with a picture: photons may take all the time there is."""
    return [record for record in records if record.report["samples"] > 0]


def _inside(image: np.ndarray, mask: np.ndarray | None) -> np.ndarray:
    return image if mask is None else image[mask]


def _point(
    scene: Scene, method: str, budget: float, records: Sequence[Record], factor: float
) -> Point:
    reference = scene.reference
    images = [record.image() for record in records]
    mean_image = sum(images) / len(images)
    regions = {}
    for name, mask in scene.regions.items():
        each = [
            _metrics.errors(image, reference.mean, reference.variance, mask) for image in images
        ]
        whole = _metrics.errors(mean_image, reference.mean, reference.variance, mask)
        shared = None
        if len(images) > 1:
            inside = [_inside(image, mask) for image in images]
            shared = _metrics.shared_error(inside, _inside(reference.mean, mask))
        regions[name] = _region(each, whole, shared, METHODS[method].correlated)

    def mean(key: str) -> float:
        return float(np.mean([record.report[key] for record in records]))

    return Point(
        budget=budget,
        seeds=len(records),
        render_seconds=mean("render_seconds"),
        load_seconds=mean("load_seconds"),
        wall_seconds=float(np.mean([record.wall_seconds for record in records])),
        samples=mean("samples"),
        peak_memory=mean("peak_memory"),
        others_share=max(record.others_share for record in records),
        processors=tuple(sorted({record.processor for record in records})),
        flip=_metrics.estimate([_metrics.flip(im, reference.mean, factor) for im in images]),
        regions=regions,
        success_rate=share(records, "walks_converged", "walks"),
        trials=share(records, "trials", "trial_estimates"),
        capped_energy_share=share(records, "capped_energy", "manifold_energy"),
    )


def _region(
    each: Sequence[Errors], whole: Errors, shared: tuple[float, float] | None, correlated: bool
) -> RegionErrors:
    def mean(key: str) -> float:
        return _metrics.estimate([getattr(errors, key) for errors in each]).mean

    def z(key: str) -> float | None:
        block_z = getattr(whole, f"{key}_z")
        biases = [getattr(errors, key) for errors in each]
        return _metrics.cautious_z(block_z, biases) if correlated else block_z

    over_seeds = _metrics.estimate([errors.mse for errors in each]).error or 0.0
    over_pixels = mean("mse_error") / math.sqrt(len(each))
    return RegionErrors(
        mse=mean("mse"),
        mse_error=max(over_seeds, over_pixels),
        mse_trimmed=mean("mse_trimmed"),
        rel_mse=mean("rel_mse"),
        rel_mse_trimmed=mean("rel_mse_trimmed"),
        bias=whole.bias,
        bias_z=z("bias"),
        bias_trimmed=whole.bias_trimmed,
        bias_trimmed_z=z("bias_trimmed"),
        shared=shared,
        reference_mse=mean("reference_mse"),
        reference_mse_trimmed=mean("reference_mse_trimmed"),
    )


def share(records: Sequence[Record], key: str, of: str) -> float | None:
    """Sum of a statistic over that of another; None where it was not counted."""
    stats = [record.report.get("stats") or {} for record in records]
    whole = sum(stat.get(of, 0.0) for stat in stats)
    return sum(stat.get(key, 0.0) for stat in stats) / whole if whole else None


def _difference(curve: Curve, scene: Scene) -> str:
    """Why another renderer's image is one of something else; empty if it is not.

    An unbiased one is looked at where there are no caustics: there it converges. What it has not
    found of the caustics yet is noise. One that is biased by design is looked at as a whole.
    """
    method = METHODS[curve.method]
    if method.family == "specula" or not curve.points:
        return ""
    if method.unbiased and not scene.caustics_known:
        return ""
    regions = curve.points[-1].regions
    looked_at = ["rest"] if method.unbiased and "rest" in regions else ["image", "caustics"]
    for name in looked_at:
        if name not in regions:
            continue
        errors = regions[name]
        where = {"image": "it", "caustics": "in the caustics it", "rest": "beside caustics it"}
        if abs(errors.bias) > MODEL_DIFFERENCE and abs(errors.bias_z or 0.0) > MODEL_Z:
            text = (
                f"{where[name]} differs by {errors.bias:+.1%} on average (z = {errors.bias_z:+.0f})"
            )
        elif method.leaves_out and (share := _systematic(errors, scene, name)) > MODEL_STRUCTURE:
            text = (
                f"{where[name]} differs by {share:.0%} (root mean square) in the same way each time"
            )
        else:
            continue
        return f"{text}; {method.leaves_out}" if method.leaves_out else text
    return ""


def _standstill(curve: Curve) -> str:
    """Why the image of a method that leaves something out is of something else, though a single
    seed may not show it: its error does not fall with time. Empty if it does."""
    method = METHODS[curve.method]
    if method.family == "specula" or not method.leaves_out or not curve.points:
        return ""
    first, last = curve.points[0], curve.points[-1]
    times = last.render_seconds / first.render_seconds
    before, after = (point.regions["image"].mse for point in (first, last))
    if times < STANDSTILL_TIMES or after <= STANDSTILL * before:
        return ""
    return (
        f"after {times:.1f} times the time {after / before:.0%} of its squared error are left; "
        f"{method.leaves_out}"
    )


def _systematic(errors: RegionErrors, scene: Scene, region: str) -> float:
    """What all seeds have in common beside the reference's own error, relative to the picture's
    root mean square; 0 if it is not significant."""
    if errors.shared is None:
        return 0.0
    mask = scene.regions[region]
    shared, deviation = errors.shared
    common = shared - float(_inside(scene.reference.variance, mask).mean())
    if common < MODEL_Z * deviation:
        return 0.0
    return math.sqrt(common / float((_inside(scene.reference.mean, mask) ** 2).mean()))


def _set_targets(result: SceneResult, budget: float) -> None:
    """The target is the median of the errors after the longest time: some reach it, some do not."""
    for region in result.regions:
        curves = [curve for curve in result.curves.values() if curve.charted]
        last = [point.regions[region].mse for c in curves if (point := c.at(budget))]
        last = [mse for mse in last if mse > 0.0]
        if not last:
            continue
        target = result.target[region] = float(np.median(last))
        for curve in curves:
            times = [point.render_seconds for point in curve.points]
            values = [point.regions[region].mse for point in curve.points]
            curve.time_to_target[region] = _metrics.time_to_reach(target, times, values)


def rows_of(results: Sequence[SceneResult]) -> Iterator[dict]:
    """Of the CSV: one for each scene, method, budget and region. `cycles_over_this` and the like
    say how many times smaller the MSE is than that of others after the same time."""
    for result in results:
        for name, curve in result.curves.items():
            for point in curve.points:
                values = asdict(point) | {"processors": "; ".join(point.processors)}
                regions = values.pop("regions")
                flip = values.pop("flip")
                for region, errors in regions.items():
                    shared, shared_error = errors.pop("shared") or (None, None)
                    ratios = {
                        f"{label}_over_this": (other := result.baseline(key, region, point.budget))
                        and result.equal_time(name, other, region, point.budget)
                        for label, key in (("cycles", CYCLES), ("luxcore", "luxcore"), ("sms", SMS))
                    }
                    yield (
                        {
                            "scene": result.name,
                            "method": name,
                            "charted": curve.charted,
                            "why_not": curve.differs,
                        }
                        | values
                        | {"flip": flip["mean"], "flip_error": flip["error"], "region": region}
                        | errors
                        | {"shared": shared, "shared_error": shared_error}
                        | ratios
                        | {"seconds_to_target": curve.time_to_target.get(region)}
                    )
