# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact sheets: rows of crops with their captions."""

from __future__ import annotations

import io
from collections.abc import Sequence

import matplotlib.pyplot as plt
from matplotlib.patches import Rectangle

from tests.instruments.bench._charts import STYLE
from tests.instruments.bench._figure_cell import Cell, caption
from tests.instruments.bench._figure_plan import Figure
from tests.instruments.bench._metrics import display

CELL, CAPTION, TITLE = 1.9, 0.72, 0.42  # inches: side of a picture, text below it and above all
GAP = 0.08  # inches
DPI = 130
FRAME = "#E69F00"


def sheet(figure: Figure, cells: Sequence[Sequence[Cell | None]]) -> bytes:
    """PNG of rows of cells; None is left blank."""
    rows, columns = len(cells), max(map(len, cells))
    width, height = columns * (CELL + GAP) + GAP, TITLE + rows * (CELL + CAPTION)
    with plt.rc_context(STYLE | {"axes.grid": False}):
        drawing = plt.figure(figsize=(width, height))
        drawing.text(GAP / width, 1.0 - 0.12 / height, figure.title, va="top", fontsize=12)
        for i, line in enumerate(cells):
            for j, cell in enumerate(line):
                if cell:
                    top = height - TITLE - i * (CELL + CAPTION)
                    place(drawing, cell, GAP + j * (CELL + GAP), top)
        buffer = io.BytesIO()
        drawing.savefig(buffer, dpi=DPI, format="png", metadata={"Software": None})
        plt.close(drawing)
    return buffer.getvalue()


def place(drawing: plt.Figure, cell: Cell, left: float, top: float) -> None:
    """The picture and its caption; the corner in inches from the bottom left."""
    width, height = drawing.get_size_inches()
    bottom = top - CELL
    draw(
        drawing.add_axes((left / width, bottom / height, CELL / width, CELL / height)),
        cell,
    )
    name, *numbers = caption(cell)
    for text, below, style in (
        (name, 0.05, {"fontsize": 8.5, "weight": "bold"}),
        ("\n".join(numbers), 0.21, {"fontsize": 7.5}),
    ):
        drawing.text(left / width, (bottom - below) / height, text, va="top", **style)


def draw(axis, cell: Cell) -> None:
    """The crop, pixel by pixel; or the whole with the crop's frame."""
    axis.set_axis_off()
    axis.set_anchor("N")
    whole = cell.panel.role == "whole"
    axis.imshow(
        display(cell.image, cell.row.view.exposure),
        origin="lower",
        interpolation="antialiased" if whole else "nearest",
    )
    if whole:
        height, width, _ = cell.image.shape
        rows, columns = cell.row.view.crop((width, height))
        corner = (columns.start - 0.5, rows.start - 0.5)
        side = columns.stop - columns.start
        axis.add_patch(Rectangle(corner, side, side, fill=False, edgecolor=FRAME, linewidth=1.2))
