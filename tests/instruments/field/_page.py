# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of pairs, and the same as JSON."""

from __future__ import annotations

import dataclasses
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template

import numpy as np
import OpenImageIO as oiio

from tests.instruments.bench import _metrics
from tests.instruments.bench._page import NONE, STYLE, ratio, table
from tests.instruments.field._measure import BAD, DARK, VERDICTS, Child, Comparison, Picture, kind

TEMPLATE = Path(__file__).with_name("page.html")
STRONG = 0.5  # (a - b) / (a + b) that is shown in full colour: three times the light


@dataclass(frozen=True)
class Scene:
    """One file's result."""

    blend: str
    verdict: str  # of VERDICTS
    specula: Child
    cycles: Child
    comparison: Comparison | None
    pictures: dict[str, str]  # label -> path from the page

    @property
    def order(self) -> tuple:
        """Worst first."""
        severity = self.comparison.severity if self.comparison else 0.0
        return VERDICTS.index(self.verdict), -severity, self.blend


# ----------------------------------------------------------------------------------------- pictures


def draw(
    folder: Path, stem: str, specula: Picture | None, cycles: Picture | None
) -> dict[str, str]:
    """Writes PNG files into folder/pictures, both of one exposure; returns label -> path."""
    shown = {}
    measure = next((p for p in (cycles, specula) if p and np.isfinite(p.mean).all()), None)
    exposure = _metrics.exposure(measure.mean) if measure else 1.0
    for label, picture in (("Specula", specula), ("Cycles", cycles)):
        if picture:
            shown[label] = _metrics.display(np.nan_to_num(picture.mean), exposure)
    if specula and cycles:
        shown["difference"] = difference(specula.mean, cycles.mean)
    paths = {}
    for label, image in shown.items():
        paths[label] = f"pictures/{stem}-{label.lower()}.png"
        write_png(folder / paths[label], image)
    return paths


def difference(image: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """sRGB: white where both are alike, red where `image` is brighter, blue where it is darker,
    magenta where it is not finite."""
    light, other = image @ _metrics.LUMINANCE, expected @ _metrics.LUMINANCE
    total = np.abs(light) + np.abs(other) + DARK * max(float(np.abs(other).mean()), 1e-30)
    amount = np.clip((light - other) / total / STRONG, -1.0, 1.0)
    brighter, darker = np.maximum(amount, 0.0), np.maximum(-amount, 0.0)
    shown = np.stack([1.0 - darker, 1.0 - darker - brighter, 1.0 - brighter], axis=-1)
    shown[~np.isfinite(light)] = (1.0, 0.0, 1.0)
    return shown.astype(np.float32)


def write_png(path: Path, image: np.ndarray) -> None:
    """Of sRGB values, bottom row first."""
    path.parent.mkdir(parents=True, exist_ok=True)
    pixels = np.ascontiguousarray(np.round(255.0 * image[::-1]), np.uint8)
    output = oiio.ImageOutput.create(str(path))
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint8")
    if not output or not output.open(str(path), spec) or not output.write_image(pixels):
        raise OSError(f"{path}: {output.geterror() if output else oiio.geterror()}")
    output.close()


# --------------------------------------------------------------------------------------------- page


def write(folder: Path, about: str, limit: float, scenes: Sequence[Scene]) -> Path:
    """index.html and results.json; returns the page."""
    scenes = sorted(scenes, key=lambda scene: scene.order)
    folder.mkdir(parents=True, exist_ok=True)
    document = {
        "about": about,
        "verdicts": verdict_counts(scenes),
        "warnings": warning_counts(scenes),
        "scenes": [dataclasses.asdict(scene) for scene in scenes],
    }
    replace(folder / "results.json", json.dumps(document, indent=1) + "\n")
    page = folder / "index.html"
    replace(page, render(about, limit, scenes))
    return page


def replace(path: Path, text: str) -> None:
    """Whoever reads it meanwhile sees the old one."""
    fresh = path.with_suffix(".new")
    fresh.write_text(text)
    fresh.replace(path)


def verdict_counts(scenes: Sequence[Scene]) -> dict[str, int]:
    counts = Counter(scene.verdict for scene in scenes)
    return {name: counts[name] for name in VERDICTS}


def warning_counts(scenes: Sequence[Scene]) -> dict[str, int]:
    """Kind of warning -> files that have it, most first."""
    counts = Counter(text for s in scenes for text in {kind(w) for w in s.specula.warnings})
    return dict(sorted(counts.items(), key=lambda item: (-item[1], item[0])))


def render(about: str, limit: float, scenes: Sequence[Scene]) -> str:
    return Template(TEMPLATE.read_text()).substitute(
        style=STYLE.read_text(),
        about=escape(about),
        verdicts=table(
            ["", "files"],
            [[badge(name), str(n)] for name, n in verdict_counts(scenes).items()],
            f"{len(scenes)} files",
        ),
        warnings=table(
            ["Specula warns", "files"],
            [[escape(text), str(number)] for text, number in warning_counts(scenes).items()],
        ),
        scenes="\n".join(section(scene, limit) for scene in scenes),
    )


def badge(verdict: str) -> str:
    return f'<b class="{"bad" if verdict in BAD else "good"}">{escape(verdict)}</b>'


def section(scene: Scene, limit: float) -> str:
    """One file: its pictures, and what is known of it."""
    figures = "".join(
        f'<figure><img loading="lazy" alt="{label}" src="{escape(path)}">'
        f"<figcaption>{label}</figcaption></figure>"
        for label, path in scene.pictures.items()
    )
    return (
        f'<section class="scene"><h3>{badge(scene.verdict)} {escape(scene.blend)}</h3>'
        f'<div class="crops">{figures}{children(scene, limit)}</div>'
        f"<p>{comparison_text(scene.comparison)}</p>"
        f"{troubles(scene)}{warnings(scene.specula)}</section>"
    )


def children(scene: Scene, limit: float) -> str:
    rows = [
        [
            name,
            escape(child.outcome),
            "killed" if child.code is None else str(child.code),
            seconds(child.worst("first_sample_seconds")),
            f"{seconds(child.worst('render_seconds'))} / {limit:g}",
            seconds(child.worst("call_seconds")),
            f"{child.cpu_seconds:.1f}",
            number(child.worst("samples")),
            f"{child.peak_memory / 1e6:.0f} MB",
            f"{child.others_share:.0%}",
        ]
        for name, child in (("Specula", scene.specula), ("Cycles", scene.cycles))
    ]
    head = [
        "",
        "outcome",
        "exit code",
        "first<br>sample, s",
        "render s<br>/ limit",
        "whole<br>call, s",
    ]
    head += ["processor s<br>in all", "samples", "peak<br>memory", "other<br>programs"]
    return table(head, rows)


def seconds(value: float | None) -> str:
    return NONE if value is None else f"{value:.1f}"


def number(value: float | None) -> str:
    return NONE if value is None else f"{value:.1f}"


def comparison_text(found: Comparison | None) -> str:
    if not found:
        return "Not compared."
    if found.not_finite:
        return f"{found.not_finite} values of Specula's picture are not finite."
    caustics = (
        f"; caustics are {found.caustics:.0%} of Specula's light, mean without them "
        f"{ratio3(found.bare_ratio)}"
        if found.caustics > 0.0
        else ""
    )
    return (
        f"Specula / Cycles: mean <b>{ratio3(found.ratio)}</b> ± {found.ratio_error:.3f}, median "
        f"block {ratio3(found.median_ratio)}; <b>{found.differing:.0%}</b> of the blocks differ "
        f"beyond noise{caustics}."
    )


def ratio3(value: float) -> str:
    """Three digits behind the point, where the ratio is near 1."""
    return f"{value:.3f}" if value < 10.0 else ratio(value)


def troubles(scene: Scene) -> str:
    lines = []
    for name, child in (("Specula", scene.specula), ("Cycles", scene.cycles)):
        if child.why:
            lines.append(f"<p>{name} {escape(child.outcome)}: {escape(child.why)}</p>")
            lines.append(f"<pre>{escape(chr(10).join(child.last_lines))}</pre>")
    return "".join(lines)


def warnings(child: Child) -> str:
    if not child.warnings:
        return ""
    items = "".join(f"<li>{escape(text)}</li>" for text in child.warnings)
    return f"<details><summary>{len(child.warnings)} warnings</summary><ul>{items}</ul></details>"
