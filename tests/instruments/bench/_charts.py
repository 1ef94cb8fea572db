# SPDX-License-Identifier: GPL-3.0-or-later
"""Charts of error against time, and pictures, as PNG and SVG."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, NullFormatter

from tests.instruments.bench._methods import GROUPS, METHODS, Method
from tests.instruments.bench._metrics import display
from tests.instruments.bench._summary import REFERENCE_FACTOR, REGION_TITLES, Curve, SceneResult

PANEL_WIDTH, HEIGHT = 5.2, 4.4  # inches
MARKER, STAR = 7.0, 11.0  # points; a star's arms are thin
BESIDE = {"textcoords": "offset points", "va": "center", "fontsize": 8}  # of a number at a marker
STYLE = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "svg.fonttype": "path",  # the same on every machine
    "svg.hashsalt": "specula",
}


def charted_groups(scene: SceneResult) -> dict[str, list[Curve]]:
    """Group -> its curves. A group that shows nothing new is left out."""
    found, shown = {}, set()
    for group in GROUPS:
        curves = [c for n, c in scene.curves.items() if c.charted and group in METHODS[n].groups]
        if not {curve.method for curve in curves} <= shown:
            found[group] = curves
            shown |= {curve.method for curve in curves}
    return found


def glint_curves(scene: SceneResult) -> list[Curve]:
    """Those of the chart of glints; none where a scene has no insets with them."""
    if "glints" not in scene.regions:
        return []
    return [c for n, c in scene.curves.items() if c.charted and "glints" in METHODS[n].groups]


def error_chart(scene: SceneResult, curves: Sequence[Curve], title: str) -> plt.Figure:
    """MSE over render time, logarithmic, a panel for each region."""
    regions = [name for name in REGION_TITLES if name in scene.regions]
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            1, len(regions), figsize=(PANEL_WIDTH * len(regions), HEIGHT), squeeze=False
        )
        for axis, region in zip(axes[0], regions, strict=True):
            _panel(axis, scene, curves, region)
        axes[0][0].set_ylabel("mean squared error")
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.suptitle(f"{scene.name}: {title}", x=0.01, ha="left", fontsize=12)
        columns = 2 * len(regions)
        rows = -(-len(handles) // columns)
        bottom = 0.03 + 0.055 * rows
        figure.legend(handles, labels, loc="lower center", ncols=columns, frameon=False)
        figure.tight_layout(rect=(0, bottom, 1, 1))
    return figure


def glints_chart(scene: SceneResult, curves: Sequence[Curve], title: str) -> plt.Figure:
    """RMSE of the insets with glints over render time; and what memory each method took at most,
    whose rows are the legend of both."""
    with plt.rc_context(STYLE):
        figure, (errors, memory) = plt.subplots(1, 2, figsize=(PANEL_WIDTH * 2, HEIGHT))
        _panel(errors, scene, curves, "glints", root=True)
        errors.set_ylabel("root of the mean squared error")
        errors.set_title("the insets with glints", loc="left", fontsize=10, color="#444444")
        for row, curve in enumerate(curves):
            method, megabytes = METHODS[curve.method], curve.points[-1].peak_memory / 1e6
            memory.plot([0.0, megabytes], [row, row], color=method.color, linestyle=method.line)
            memory.plot(megabytes, row, color=method.color, **_marker(method))
            memory.annotate(f"{megabytes:.0f}", (megabytes, row), (8, 0), **BESIDE, color="#444444")
        memory.set_yticks(range(len(curves)), [METHODS[c.method].full_label for c in curves])
        memory.invert_yaxis()
        memory.set_xlim(left=0.0)
        memory.margins(x=0.12)
        memory.set_title("peak memory of the process, MB", loc="left", fontsize=10, color="#444444")
        figure.suptitle(f"{scene.name}: {title}", x=0.01, ha="left", fontsize=12)
        figure.tight_layout()
    return figure


def _panel(
    axis, scene: SceneResult, curves: Sequence[Curve], region: str, root: bool = False
) -> None:
    """MSE over time, or its root; hollow where the reference's own error may be part of it."""
    lowest, highest, times = np.inf, 0.0, []
    for curve in curves:
        method = METHODS[curve.method]
        points = [p for p in curve.points if p.regions[region].measurable()]
        if not points:
            continue
        x = np.array([p.render_seconds for p in points])
        y = np.array([p.regions[region].mse for p in points])
        error = np.array([p.regions[region].mse_error for p in points])
        if root:
            y, error = np.sqrt(y), error / (2.0 * np.sqrt(y))
        axis.errorbar(
            x,
            y,
            yerr=[np.minimum(error, 0.9 * y), error],  # a logarithm has no zero
            color=method.color,
            **_marker(method),
            linestyle=method.line,
            label=method.full_label,
            linewidth=1.8,
            capsize=3,
        )
        near = np.array([p.regions[region].near_reference() for p in points])
        axis.plot(
            x[near],
            y[near],
            color=method.color,
            **_marker(method),
            linestyle="none",
            markerfacecolor="white",
            zorder=3,
        )
        lowest, highest = min(lowest, y.min()), max(highest, y.max())
        times += x.tolist()
    axis.set_xscale("log", base=2)
    axis.set_yscale("log")
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set_xlabel("seconds of rendering")
    axis.set_title(REGION_TITLES[region], loc="left", fontsize=10, color="#444444")
    if times:
        _guides(axis, scene, region, (min(times), max(times)), (lowest, highest), root)


def _marker(method: Method) -> dict:
    """In Matplotlib's words."""
    return {"marker": method.marker, "markersize": STAR if method.marker == "*" else MARKER}


def _guides(axis, scene: SceneResult, region: str, times, errors, root: bool) -> None:
    """The slope of 1/time, and where the reference's own error begins to matter."""
    x = np.array(times)
    power = 0.5 if root else 1.0
    axis.plot(x, 1.6 * errors[1] * (x[0] / x) ** power, color="#999999", linewidth=1.0, zorder=1)
    axis.annotate(
        "1/√time" if root else "1/time",
        (x[0], 1.6 * errors[1]),
        **{"color": "#666666", "fontsize": 8, "va": "bottom", "ha": "left"},
    )
    floor = (REFERENCE_FACTOR * scene.reference["mse"][region]) ** power
    bottom, top = axis.get_ylim()
    if floor > bottom:
        axis.axhspan(bottom, min(floor, top), color="#eeeeee", zorder=0)
        axis.set_ylim(bottom, top)
        axis.annotate(
            f"hollow: less than {REFERENCE_FACTOR:g} x the reference's own squared error",
            (0.01, 0.01),
            xycoords="axes fraction",
            **{"color": "#666666", "fontsize": 8, "va": "bottom", "ha": "left"},
        )


def save(figure: plt.Figure, path: Path) -> str:
    """Writes PATH.png and PATH.svg; returns the SVG's text."""
    png, svg = (path.with_name(f"{path.name}.{kind}") for kind in ("png", "svg"))
    figure.savefig(png, dpi=150, bbox_inches="tight")
    figure.savefig(svg, metadata={"Date": None}, bbox_inches="tight")
    plt.close(figure)
    return svg.read_text()


def png(image: np.ndarray, exposure: float, scale: int = 1) -> bytes:
    """Of a linear image, bottom row first; pixels are repeated, not smoothed."""
    shown = np.kron(display(image, exposure)[::-1], np.ones((scale, scale, 1), np.float32))
    buffer = io.BytesIO()
    plt.imsave(buffer, shown, format="png")
    return buffer.getvalue()


def crop_window(image: np.ndarray, caustics: np.ndarray | None, side: int) -> tuple[int, int]:
    """Row and column (from the bottom left) of the square of `side` pixels in which the caustics
    vary most; without caustics, of the middle."""
    height, width, _ = image.shape
    rows, columns = max(1, height - side + 1), max(1, width - side + 1)
    if caustics is None:
        return rows // 2, columns // 2
    light = caustics.sum(axis=2)
    light = np.minimum(light, np.percentile(light, 99.0))  # a few blinding pixels must not decide
    bottom, left = min(side, height), min(side, width)

    def window_means(values: np.ndarray) -> np.ndarray:
        sums = np.pad(values.cumsum(0).cumsum(1), ((1, 0), (1, 0)))
        upper, lower = sums[bottom:], sums[:-bottom]
        totals = upper[:, left:] - upper[:, :-left] - lower[:, left:] + lower[:, :-left]
        return totals / (bottom * left)

    variances = window_means(light**2) - window_means(light) ** 2
    row, column = np.unravel_index(np.argmax(variances), variances.shape)
    return int(row), int(column)
