# SPDX-License-Identifier: GPL-3.0-or-later
"""The page: one HTML file with everything in it."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template

from tests.instruments.bench._checks import BIAS_Z, Check
from tests.instruments.bench._methods import METHODS
from tests.instruments.bench._metrics import CAUSTICS_SHARE, WORST
from tests.instruments.bench._standings import BASELINES, standing
from tests.instruments.bench._summary import (
    REFERENCE_FACTOR,
    REGION_TITLES,
    Curve,
    Point,
    SceneResult,
)

HERE = Path(__file__).resolve().parent
TEMPLATE, STYLE = HERE / "page.html", HERE / "page.css"
NONE = "&ndash;"
NEAR = "&deg;"  # marks what the reference's own error may be part of


@dataclass(frozen=True)
class Picture:
    label: str
    png: bytes
    note: str = ""


def render(
    about: dict,
    scenes: Sequence[SceneResult],
    checks: Sequence[Check],
    charts: Mapping[str, Sequence[str]],
    pictures: Mapping[str, Sequence[Picture]],
) -> str:
    """The page's text; `charts` are SVG texts by scene."""
    budget = max(about["budgets"])
    return Template(TEMPLATE.read_text()).substitute(
        style=STYLE.read_text(),
        about=_about(about),
        summary=_summary_table(scenes, budget),
        checks=_checks_list([check for check in checks if not check.promise]),
        promises=_checks_list([check for check in checks if check.promise]),
        factor=f"{REFERENCE_FACTOR:g}",
        near=NEAR,
        worst=f"{WORST:.1%}",
        share=f"{CAUSTICS_SHARE:.0%}",
        budget=f"{budget:g}",
        links=" · ".join(f'<a href="#{escape(s.name)}">{escape(s.name)}</a>' for s in scenes),
        scenes="\n".join(
            _scene(scene, budget, charts[scene.name], pictures[scene.name]) for scene in scenes
        ),
    )


def _about(about: dict) -> str:
    seconds = ", ".join(f"{budget:g}" for budget in about["budgets"])
    missing = "".join(f" {label} is left out: {why}." for label, why in about["missing"].items())
    quick = " A quick look: few seeds and short times." if about["quick"] else ""
    return escape(
        f"{about['date']}, {about['processor']}, {about['threads']} threads, load average "
        f"{about['load_average']:.1f} at the start. Times: {seconds} s; seeds: {about['seeds']}."
        f"{quick}{missing} Command: {about['command']}"
    )


# ------------------------------------------------------------------------------------------- tables


def table(head: Sequence[str], rows: Sequence[Sequence[str]], caption: str = "") -> str:
    """Cells are HTML; the first of a row is its heading."""
    title = f"<caption>{caption}</caption>" if caption else ""
    columns = "".join(f'<th scope="col">{cell}</th>' for cell in head)
    body = "\n".join(
        f'<tr><th scope="row">{row[0]}</th>{"".join(f"<td>{cell}</td>" for cell in row[1:])}</tr>'
        for row in rows
    )
    return (
        f'<div class="wide"><table>{title}<thead><tr>{columns}</tr></thead>'
        f"<tbody>\n{body}\n</tbody></table></div>"
    )


def _summary_table(scenes: Sequence[SceneResult], budget: float) -> str:
    """Each method against the three baselines."""
    shown = [region for region in REGION_TITLES if any(region in scene.regions for scene in scenes)]
    head = ["method"]
    head += [f"{label},<br>{REGION_TITLES[r]}" for label in BASELINES.values() for r in shown]
    rows = []
    for name in dict.fromkeys(name for scene in scenes for name in scene.curves):
        cells = [escape(METHODS[name].full_label)]
        for against in BASELINES:
            for region in shown:
                found = standing(scenes, name, against, region, budget)
                cells.append(_standing_cell(found, name == against))
        rows.append(cells)
    return table(head, rows)


def _standing_cell(found, same: bool) -> str:
    if same:
        return "1"
    if not found:
        return NONE
    text = f"<b>{ratio(found.mean)}</b>{_near(found.near_reference > 0)}"
    if found.scenes > 1:
        text += (
            f"<br><small>{ratio(found.low)} to {ratio(found.high)}, {found.scenes} scenes</small>"
        )
    return text


def _checks_list(checks: Sequence[Check]) -> str:
    if not checks:
        return "<p>None of what they speak of was rendered.</p>"
    rows = [
        f'<li class="{"pass" if check.passed else "fail"}"><b>{"pass" if check.passed else "FAIL"}'
        f"</b> {escape(check.name)}: {escape(check.text)}</li>"
        for check in checks
    ]
    return "<ul class='checks'>" + "\n".join(rows) + "</ul>"


# -------------------------------------------------------------------------------------------- scene


def _scene(
    scene: SceneResult, budget: float, charts: Sequence[str], pictures: Sequence[Picture]
) -> str:
    reference = scene.reference
    lines = [
        f"{scene.size[0]} x {scene.size[1]} pixels; reference: {reference.get('method', 'given')}, "
        f"{reference.get('samples', '?')} samples per pixel, mean squared error "
        f"{_own_errors(reference['mse'])}, which is subtracted; "
        f"pictures: exposure {scene.exposure:.3g}"
    ]
    if "caustics" in scene.regions:
        lines.append(f"caustics: {scene.regions['caustics']:.1%} of the pixels")
    lines += scene.notes
    left_out = [
        f"<li>{escape(METHODS[name].full_label)} is "
        f"{'incomplete' if curve.charted else 'not charted'}: "
        f"{escape(curve.failure or curve.differs)}</li>"
        for name, curve in scene.curves.items()
        if curve.failure or curve.differs
    ]
    drawn = "\n".join(
        f'<img class="chart" alt="Error over time" src="{data_url(svg.encode(), "svg+xml")}">'
        for svg in charts
    )
    return "\n".join(
        [
            f'<section id="{escape(scene.name)}"><h2>{escape(scene.name)}</h2>',
            f"<p>{escape('; '.join(lines))}.</p>",
            f"<ul>{''.join(left_out)}</ul>" if left_out else "",
            drawn,
            f"<h3>After {budget:g} s</h3>",
            '<div class="crops">' + "\n".join(map(_figure, pictures)) + "</div>",
            *(
                _region_table(scene, budget, region)
                for region in REGION_TITLES
                if region in scene.regions
            ),
            _work_table(scene, budget),
            "</section>",
        ]
    )


def _figure(picture: Picture) -> str:
    note = f"<br><small>{escape(picture.note)}</small>" if picture.note else ""
    return (
        f'<figure><img alt="{escape(picture.label)}" src="{data_url(picture.png, "png")}">'
        f"<figcaption>{escape(picture.label)}{note}</figcaption></figure>"
    )


def data_url(content: bytes, kind: str) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"


def _region_table(scene: SceneResult, budget: float, region: str) -> str:
    """Errors in one region after the longest time, and what they are against others'."""
    target = scene.target.get(region)
    head = ["method", "MSE", "MSE,<br>trimmed", "relMSE", "relMSE,<br>trimmed"]
    head += ["bias (z)", "bias (z),<br>trimmed"]
    head += [f"{text}<br>/ this" for text in ("Cycles PT", "LuxCore", "SMS")]
    head.append(f"s to MSE<br>{number(target)}" if target else "s to target")
    rows = []
    for name, curve, point in _last_points(scene, budget):
        errors = point.regions[region]
        cells = [_label(name, curve)]
        cells += [
            _with_error(errors.mse, errors.mse_error) + _near(errors.near_reference()),
            number(errors.mse_trimmed) + _near(errors.near_reference(trimmed=True)),
            number(errors.rel_mse),
            number(errors.rel_mse_trimmed),
        ]
        cells.append(_bias(errors.bias, errors.bias_z))
        cells.append(_with_z(errors.bias_trimmed, errors.bias_trimmed_z))
        for against in BASELINES:
            baseline = scene.baseline(against, region, budget)
            value = scene.equal_time(name, baseline, region, budget) if baseline else None
            near = value and scene.near_reference((name, baseline), region, budget)
            cells.append(ratio(value) + _near(near) if value else NONE)
        cells.append(
            escape(curve.time_to_target[region]) if region in curve.time_to_target else NONE
        )
        rows.append(cells)
    own = number(scene.reference["mse"][region])
    caption = f"Errors at equal time, {budget:g} s, {REGION_TITLES[region]}; reference's own: {own}"
    return table(head, rows, caption)


def _work_table(scene: SceneResult, budget: float) -> str:
    """What was done in that time."""
    head = ["method", "FLIP", "render s", "load s", "wall s", "samples<br>per pixel"]
    head += [
        "walks that<br>succeed",
        "Bernoulli<br>trials",
        "manifold's light from<br>capped estimates",
        "peak<br>memory",
    ]
    rows = [
        [
            _label(name, curve),
            f"{point.flip.mean:.4f}" + (f" ± {point.flip.error:.4f}" if point.flip.error else ""),
            f"{point.render_seconds:.2f}" + ("" if point.in_time else " !"),
            f"{point.load_seconds:.2f}",
            f"{point.wall_seconds:.2f}",
            f"{point.samples:.1f}",
            NONE if point.success_rate is None else f"{point.success_rate:.1%}",
            NONE if point.trials is None else f"{point.trials:.2f}",
            NONE if point.capped_energy_share is None else f"{point.capped_energy_share:.3%}",
            f"{point.peak_memory / 1e6:.0f} MB",
        ]
        for name, curve, point in _last_points(scene, budget)
    ]
    return table(head, rows, f"Time and work at {budget:g} s")


def _last_points(scene: SceneResult, budget: float) -> list[tuple[str, Curve, Point]]:
    return [(n, curve, point) for n, curve in scene.curves.items() if (point := curve.at(budget))]


def _label(name: str, curve: Curve) -> str:
    return escape(METHODS[name].full_label) + (" *" if curve.differs else "")


def _with_error(value: float, error: float) -> str:
    """The error in percent: powers of ten are hard to read against each other."""
    return f"{number(value)} <small>± {error / value:.0%}</small>" if value > 0.0 else number(value)


def _near(near: bool) -> str:
    return NEAR if near else ""


def _own_errors(by_region: Mapping[str, float]) -> str:
    """A reference's, such as `1e-05 (whole image), 2e-05 (caustics)`."""
    shown = [(REGION_TITLES[name], mse) for name, mse in by_region.items() if name in REGION_TITLES]
    return ", ".join(f"{number(mse)} ({title})" for title, mse in shown)


def _bias(value: float, z: float | None) -> str:
    text = _with_z(value, z)
    return f"<b>{text}</b>" if abs(z or 0.0) > BIAS_Z else text


def _with_z(value: float, z: float | None) -> str:
    return f"{value:+.2%} ({NONE if z is None else f'{z:+.1f}'})"


def number(value: float | None) -> str:
    """Three digits."""
    return NONE if value is None else f"{value:.3g}"


def ratio(value: float) -> str:
    """Two digits; whole numbers from ten on."""
    return f"{value:.0f}" if value >= 10.0 else f"{value:.2g}"
