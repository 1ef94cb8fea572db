# SPDX-License-Identifier: GPL-3.0-or-later
"""What one cell of a contact sheet shows and says, as [Zeltner20] prints it below its crops."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.images._reference import Reference
from tests.instruments.bench import _metrics
from tests.instruments.bench._figure_plan import Panel, Row
from tests.instruments.bench._page import number
from tests.instruments.bench._store import Record
from tests.instruments.bench._summary import share


@dataclass(frozen=True)
class Cell:
    """What a panel shows: a picture, and what is known of it."""

    row: Row
    panel: Panel
    image: np.ndarray  # (H, W, 3), linear, bottom row first; the crop unless the panel is the whole
    record: Record | None  # None: the picture is the stored reference
    reference: Reference | None = None  # that the picture is, or is held against

    @property
    def errors(self) -> _metrics.Errors:
        """Of a crop."""
        height, width, _ = self.reference.mean.shape
        part = self.row.view.crop((width, height))
        return _metrics.errors(self.image, self.reference.mean[part], self.reference.variance[part])


def caption(cell: Cell) -> list[str]:
    """Lines below a cell, the first its name."""
    if cell.panel.role == "whole":
        return [cell.row.label or cell.row.view.scene, "whole picture"]
    if cell.record is None:
        about = cell.reference.about
        return [
            cell.panel.label,
            f"{about.get('method', 'given')}, {about.get('samples', '?')} spp",
        ]
    # More seconds than asked for where preparation and one sample took longer.
    report = cell.record.report
    work = f"{report['samples']:.3g} spp, {report['render_seconds']:.1f} s"
    if cell.panel.role == "reference":
        return ["Longer render", f"automatic, {work}"]
    lines = [cell.panel.label, work]
    if rates := walks(cell.record):
        lines.append(rates)
    if cell.reference:
        lines.append(f"MSE {number(cell.errors.mse)} ({number(cell.errors.mse_trimmed)})")
    return lines


def walks(record: Record) -> str:
    """Success rate and mean trials, as far as there were any."""
    rates = []
    if (success := share([record], "walks_converged", "walks")) is not None:
        rates.append(f"SR {success:.1%}")
    if (trials := share([record], "trials", "trial_estimates")) is not None:
        rates.append(f"BT {trials:.2f}")
    return "   ".join(rates)
