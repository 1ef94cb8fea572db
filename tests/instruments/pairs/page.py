# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a page that shows pairs of pictures, as HTML."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from tests.instruments.bench._page import ratio
from tests.instruments.pairs.comparison import Comparison


def badge(verdict: str, bad: bool) -> str:
    return f'<b class="{"bad" if bad else "good"}">{escape(verdict)}</b>'


def figures(pictures: Mapping[str, str]) -> str:
    """By label: path from the page."""
    return "".join(
        f'<figure><img loading="lazy" alt="{label}" src="{escape(path)}">'
        f"<figcaption>{label}</figcaption></figure>"
        for label, path in pictures.items()
    )


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
