# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact sheets like the figures of the paper that Specula implements.

Each sheet puts crops of one scene side by side, rendered in the same time by different methods or
settings, with the success rate of the walks and the mean number of Bernoulli trials below. At the
end it writes DIR/NAME.png for each figure and DIR/index.html with all of them.

What is rendered is kept in build/bench/error and found again. Where no reference is stored, there
is a render of the whole picture in eight times the seconds. The exit code is 0 if every render came
to an image.
"""

from __future__ import annotations

import argparse
import os
import shlex
import sys
import time
from collections.abc import Sequence
from html import escape
from pathlib import Path
from string import Template

from tests.instruments.bench import (
    _figure_plan,
    _machine,
    _metrics,
    _page,
    _program,
    _scenes,
    _store,
)
from tests.instruments.bench._children import Progress
from tests.instruments.bench._figure_cell import Cell
from tests.instruments.bench._figure_plan import Figure, Panel, Row, Shot
from tests.instruments.bench._figure_sheet import sheet
from tests.instruments.bench._ratios import MeasurementError
from tests.instruments.bench._schedule import OVERHEAD
from tests.instruments.bench._store import Record
from tools.common import BUILD

DEFAULT_OUT = BUILD / "bench" / "figures"
SECONDS = 8.0
TEMPLATE = Path(__file__).with_name("figures.html")


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./dev bench figures",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--out", type=Path, default=DEFAULT_OUT, metavar="DIR", help="(%(default)s)"
    )
    names = ", ".join(_figure_plan.FIGURES)
    parser.add_argument("--figures", metavar="NAMES", help=f"of: {names} (default all)")
    parser.add_argument(
        "--seconds", type=float, default=SECONDS, help="of rendering, each (%(default)g)"
    )
    parser.add_argument(
        "--size", type=int, help="pixels along the longer side (default 256, as references have)"
    )
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    args = parser.parse_args()
    if args.seconds <= 0.0:
        parser.error("--seconds must be positive")
    if args.size is not None and args.size < 16:
        parser.error("--size must be at least 16")
    return args


def render_all(shots: Sequence[Shot]) -> tuple[dict[str, Record], list[str]]:
    """Records by `key`, each picture once, those of an earlier run again; and why others failed."""
    found, todo, failures = {}, {}, []
    for shot in shots:
        if record := _store.find(shot):
            found[key(shot)] = record
        else:
            todo[key(shot)] = shot
    progress = Progress("figures", (shot.budget + OVERHEAD for shot in todo.values()))
    for number, (name, shot) in enumerate(todo.items(), 1):
        progress.show(f"{number}/{len(todo)} {shot.name}")
        try:
            found[name] = _store.render(shot)
        except MeasurementError as error:
            failures.append(str(error))
        progress.advance(shot.budget + OVERHEAD)
    progress.clear()
    return found, failures


def key(shot: Shot) -> str:
    """The same for the same picture."""
    return repr(shot.job)


def cell(
    row: Row,
    panel: Panel,
    records: dict[str, Record],
    seconds: float,
    longer: int | None,
    threads: int,
) -> Cell | None:
    """What a panel shows, once all is rendered; None if its render failed."""
    shot = _figure_plan.shot(row, panel, seconds, longer, threads)
    record = records.get(key(shot)) if shot else None
    if shot and not record:
        return None
    held = _figure_plan.has_reference(row, panel, longer)
    reference = _scenes.example(row.view.scene).reference if held else None
    image = record.image() if record else reference.mean
    if panel.role == "reference":
        height, width, _ = image.shape
        image = image[row.view.crop((width, height))]
    return Cell(row, panel, image, record, reference)


def section(figure: Figure, png: bytes) -> str:
    return (
        f'<section id="{escape(figure.name)}"><h2>{escape(figure.title)}</h2>'
        f"<p>{escape(figure.text)}</p>"
        f'<img class="sheet" alt="{escape(figure.title)}" src="{_page.data_url(png, "png")}">'
        "</section>"
    )


def write(folder: Path, about: str, sheets: dict[Figure, bytes]) -> Path:
    """Writes everything; returns the page."""
    folder.mkdir(parents=True, exist_ok=True)
    for figure, png in sheets.items():
        (folder / f"{figure.name}.png").write_bytes(png)
    page = folder / "index.html"
    page.write_text(
        Template(TEMPLATE.read_text()).substitute(
            style=_page.STYLE.read_text(),
            about=escape(about),
            worst=f"{_metrics.WORST:.1%}",
            figures="\n".join(section(figure, png) for figure, png in sheets.items()),
        )
    )
    return page


def main() -> int:
    args = arguments()
    figures = _figure_plan.chosen(args.figures)
    _program.freeze_library("figures")
    started = time.gmtime()
    choice = (args.seconds, args.size, args.threads)
    records, failures = render_all(_figure_plan.shots(figures, *choice))
    for why in failures:
        _program.warn("figures", why)
    others = max((record.others_share for record in records.values()), default=0.0)
    _program.warn_of_others("figures", others)
    sheets = {
        figure: sheet(
            figure,
            [[cell(row, panel, records, *choice) for panel in row.panels] for row in figure.rows],
        )
        for figure in figures
    }
    about = (
        f"{time.strftime('%Y-%m-%d %H:%M UTC', started)}, {_machine.processor()}, {args.threads} "
        f"threads, {args.seconds:g} s of rendering each. Other programs took up to {others:.0%} of "
        f"the processors' time meanwhile. Command: ./dev bench figures {shlex.join(sys.argv[1:])}"
    )
    print(write(args.out, about.strip(), sheets))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(_program.run(main))
