# SPDX-License-Identifier: GPL-3.0-or-later
"""What the bench checks of itself and of the methods, and says on its page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tests.instruments.bench import _metrics
from tests.instruments.bench._machine import BUSY_SHARE
from tests.instruments.bench._methods import CYCLES, METHODS, SMS, WITH_GLINTS
from tests.instruments.bench._summary import (
    BUDGET_TOLERANCE,
    REFERENCE_FACTOR,
    REGION_TITLES,
    Point,
    SceneResult,
)

SLOPE_Z = 3.0  # standard errors
SHARED_Z = 4.0
STEEPEST = 1.5  # what stratification of a few of many dimensions could give
BIAS_Z = 4.0


@dataclass(frozen=True)
class Check:
    name: str
    passed: bool
    text: str
    promise: bool = False  # what a method should do, not how sound the measurement is


def checks(scenes: Sequence[SceneResult], budget: float) -> list[Check]:
    """All that apply."""
    found = [
        *_slopes(scenes),
        *_seeds(scenes),
        _times(scenes, budget),
        _references(scenes),
        _quiet(scenes),
        _one_machine(scenes),
    ]
    return [*found, *_biases(scenes), *_promises(scenes, budget)]


def _path_traced(scenes: Sequence[SceneResult]) -> Iterator[tuple[str, SceneResult, list[Point]]]:
    """Title, scene and measurable points of each path tracer where no more is needed."""
    for scene in scenes:
        for name, curve in scene.curves.items():
            points = [p for p in curve.points if p.regions["image"].measurable()]
            if METHODS[name].path_traced and scene.path_tracing_suffices and points:
                yield f"{scene.name}, {METHODS[name].full_label}", scene, points


def _slopes(scenes: Sequence[SceneResult]) -> Iterator[Check]:
    """A path tracer's error falls as 1/time, or faster, as long as its samples are stratified."""
    for title, _, points in _path_traced(scenes):
        if len(points) < 2:
            continue
        slope = _metrics.log_slope(
            [p.render_seconds for p in points],
            [p.regions["image"].mse for p in points],
            [p.regions["image"].mse_error for p in points],
        )
        faster = slope.value + 1.0 < -SLOPE_Z * slope.error
        text = f"MSE ~ time^({slope.value:.3f} ± {slope.error:.3f})"
        text += ", faster: samples are stratified" if faster else ""
        passed = -STEEPEST <= slope.value <= -1.0 + SLOPE_Z * slope.error
        yield Check(f"{title}: error falls as 1/time", passed, text)


def _seeds(scenes: Sequence[SceneResult]) -> Iterator[Check]:
    """Over independent images it must hold to the letter: the MSE of the mean of n seeds is 1/n of
    theirs. Then they share nothing but the reference's own error, of which a bound is stored."""
    for title, scene, points in _path_traced(scenes):
        found = [errors for p in points if (errors := p.regions["image"]).shared]
        if not found:
            continue
        bound = scene.reference["mse"]["image"]
        passed = all(
            -SHARED_Z * error <= shared <= bound + SHARED_Z * error
            for shared, error in (errors.shared for errors in found)
        )
        largest = max(errors.shared[0] / errors.mse for errors in found)
        text = f"seeds share at most {largest:.1%} of their error"
        yield Check(f"{title}: the error of a mean of n seeds is 1/n of theirs", passed, text)


def _times(scenes: Sequence[SceneResult], budget: float) -> Check:
    """At the budget of the tables everyone took as long."""
    late = [
        f"{scene.name} {name} {point.render_seconds / budget - 1.0:+.0%}"
        for scene in scenes
        for name, curve in scene.curves.items()
        if curve.charted and (point := curve.at(budget)) and not point.in_time
    ]
    title = f"all charted times at {budget:g} s are within {BUDGET_TOLERANCE:.1%} of it"
    return Check(title, not late, "; ".join(late) or "yes")


def _references(scenes: Sequence[SceneResult]) -> Check:
    """How far below the smallest measured error each reference's own is."""
    near = []
    for scene in scenes:
        for region, own in scene.reference["mse"].items():
            curves = [curve for curve in scene.curves.values() if curve.charted]
            errors = [p.regions[region].mse for curve in curves for p in curve.points]
            if errors and own and min(errors) / own < REFERENCE_FACTOR:
                near.append(f"{scene.name}, {region}: {max(0.0, min(errors)) / own:.1f}x")
    title = f"references' own errors are {REFERENCE_FACTOR:g}x below the smallest measured ones"
    return Check(title, not near, "; ".join(near) or "yes")


def _points(scenes: Sequence[SceneResult]) -> Iterator[Point]:
    for scene in scenes:
        for curve in scene.curves.values():
            yield from curve.points


def _quiet(scenes: Sequence[SceneResult]) -> Check:
    """Who else was busy."""
    points = list(_points(scenes))
    disturbed = sum(point.others_share > BUSY_SHARE for point in points)
    text = f"{disturbed} of {len(points)} points were disturbed"
    text += "; --undisturbed renders them again" if disturbed else ""
    title = f"no other program took more than {BUSY_SHARE:.0%} of the processors' time"
    return Check(title, disturbed == 0, text)


def _one_machine(scenes: Sequence[SceneResult]) -> Check:
    """What is found again may have been rendered on a faster or a slower one."""
    counts = Counter(name for point in _points(scenes) for name in point.processors)
    text = "; ".join(f"{count} points on {name}" for name, count in counts.most_common())
    return Check("everything was rendered on the same processor", len(counts) <= 1, text)


def _biases(scenes: Sequence[SceneResult]) -> list[Check]:
    """Our unbiased methods have the reference's mean, after the longest time and in all seeds.

    Path tracing has not found enough of caustics to be judged: what it has missed shows neither in
    its mean nor in its variance.
    """
    wrong = []
    for scene in scenes:
        for name, curve in scene.curves.items():
            method = METHODS[name]
            sees_all = not method.path_traced or scene.path_tracing_suffices
            if method.family != "specula" or not method.unbiased or not sees_all:
                continue
            errors = curve.points[-1].regions["image"] if curve.points else None
            if errors and abs(errors.bias_z or 0.0) > BIAS_Z:
                wrong.append(f"{scene.name} {name} {errors.bias:+.2%} (z = {errors.bias_z:+.1f})")
    title = f"Specula's unbiased methods have the reference's mean (|z| < {BIAS_Z:g})"
    return [Check(title, not wrong, "; ".join(wrong) or "yes")]


# ---------------------------------------------------------------------------------------- promises


@dataclass(frozen=True)
class Promise:
    """That the squared error of the best of `methods` is at most `bound` times that of the best of
    `against` after the same time."""

    who: str
    methods: tuple[str, ...]  # those that were rendered count
    than: str
    against: tuple[str, ...]  # only where all of them were rendered
    bound: float
    region: str
    scenes: tuple[str, ...] = ()  # (): all
    every_budget: bool = False  # else the longest alone

    def title(self, trimmed: bool) -> str:
        pixels = "trimmed" if trimmed else "all pixels"
        bound = f"{self.bound:g}x" if self.bound >= 1.0 else f"1/{1.0 / self.bound:g} of"
        return (
            f"{self.who}: at most {bound} {self.than}'s error, "
            f"{REGION_TITLES[self.region]} ({pixels})"
        )


BOTH, LIGHT, LUX_LIGHT, YAN = "sms-lt", "lt", "lux-light", "glints-yan"
PLANE, PLANE_AND_RING = ("reflective_plane",), ("reflective_plane", "ring")
# Yan's are no method of ours, whoever wrote them down.
OURS = tuple(
    name
    for name, method in METHODS.items()
    if method.family == "specula" and name != YAN and not method.hidden
)
PROMISES = (
    Promise(
        "SMS unbiased + LT",
        (BOTH,),
        "the better of SMS and LT",
        (SMS, LIGHT),
        1.15,
        "image",
        every_budget=True,
    ),
    *(
        Promise(who, (method,), than, (against,), bound, "direct", scenes)
        for who, method in (("SMS unbiased + LT", BOTH), ("light tracing", LIGHT))
        for than, against, bound, scenes in (
            ("SMS unbiased", SMS, 1.0 / 100.0, PLANE_AND_RING),
            ("LuxCore light tracing", LUX_LIGHT, 1.0 / 5.0, PLANE),
        )
    ),
    *(
        Promise("the best of ours", OURS, than, (against,), bound, "glints", WITH_GLINTS)
        for than, against, bound in (
            ("Yan et al.", YAN, 1.0 / 5.0),
            ("Cycles path tracing", CYCLES, 1.0 / 50.0),
        )
    ),
)


def _promises(scenes: Sequence[SceneResult], budget: float) -> Iterator[Check]:
    """Each with all pixels and without the worst; none where nothing of it was rendered."""
    for promise in PROMISES:
        concerned = [scene for scene in scenes if _concerns(promise, scene)]
        if concerned:
            for trimmed in (False, True):
                found = [_kept(promise, scene, budget, trimmed) for scene in concerned]
                passed = all(kept for kept, _ in found)
                text = "; ".join(text for _, text in found)
                yield Check(promise.title(trimmed), passed, text, promise=True)


def _concerns(promise: Promise, scene: SceneResult) -> bool:
    def there(name: str) -> bool:
        return name in scene.curves and scene.curves[name].charted

    return (
        (not promise.scenes or (scene.is_example and scene.name in promise.scenes))
        and promise.region in scene.regions
        and any(map(there, promise.methods))
        and all(map(there, promise.against))
    )


def _kept(promise: Promise, scene: SceneResult, budget: float, trimmed: bool) -> tuple[bool, str]:
    """Whether it holds on a scene, and the figure of the time at which it holds least. What cannot
    be compared at any time does not hold."""
    budgets = [budget]
    if promise.every_budget:
        budgets = sorted({point.budget for c in scene.curves.values() for point in c.points})
    shares = {
        seconds: share
        for seconds in budgets
        if (share := _share(promise, scene, seconds, trimmed)) is not None
    }
    unknown = ", ".join(f"{seconds:g} s" for seconds in budgets if seconds not in shares)
    if not shares:
        return False, f"{scene.name}: nothing to compare at {unknown}"
    worst = max(shares, key=lambda seconds: shares[seconds][0])
    share, name, near = shares[worst]
    kept = share <= promise.bound
    text = f"{scene.name} {_factor(share)} at {worst:g} s"
    text += f" by {METHODS[name].label}" if len(promise.methods) > 1 else ""
    text += ", less than the reference is good for" if near else ""
    text += "" if kept else ", TOO MUCH"
    failing = sum(share > promise.bound for share, *_ in shares.values())
    text += f" (at {failing} of {len(shares)} times)" if failing and len(shares) > 1 else ""
    return kept, text + (f" (nothing to compare at {unknown})" if unknown else "")


def _share(
    promise: Promise, scene: SceneResult, budget: float, trimmed: bool
) -> tuple[float, str, bool] | None:
    """Error over the other's, whose method it is, and whether the reference's own error may be part
    of one; None where nothing can be compared."""
    found = []
    for name in promise.methods:
        ratios = [
            scene.equal_time(name, other, promise.region, budget, trimmed)
            for other in promise.against
        ]
        if all(ratios):
            found.append((1.0 / min(ratios), name))
    if not found:
        return None
    share, name = min(found)
    regions = (scene.curves[n].at(budget).regions[promise.region] for n in (name, *promise.against))
    return share, name, any(region.near_reference(trimmed) for region in regions)


def _factor(share: float) -> str:
    """Such as `1.1x` or `1/320`."""
    return f"{share:.3g}x" if share > 0.5 else f"1/{1.0 / share:.3g}"
