# SPDX-License-Identifier: GPL-3.0-or-later
"""What `./dev bench figures` renders, crops and prints below its pictures."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from tests.images._reference import Reference
from tests.instruments.bench import _figure_plan, _scenes
from tests.instruments.bench._description import abi
from tests.instruments.bench._figure_cell import Cell, caption
from tests.instruments.bench._figure_plan import (
    AUTOMATIC,
    FIGURES,
    LONG,
    PATH_TRACING,
    REFERENCE,
    WHOLE,
    Row,
    View,
)
from tests.instruments.bench._store import Record
from tools.common import DevError

SECONDS, THREADS = 8.0, 2
ROWS = [row for figure in FIGURES.values() for row in figure.rows]
PANELS = [panel for row in ROWS for panel in row.panels if panel.role == "crop"]


def view(scene="ring", size=(8, 4), centre=(0.5, 0.5), side=0.5):
    return View(scene, size, centre, side)


def row(*panels, scene="ring", size=(256, 256), edits=None):
    return Row(view(scene, size), panels, edits or {})


# --------------------------------------------------------------------------------------- the plan


def test_every_figure_has_its_scenes():
    assert all(_scenes.example(row.view.scene) for row in ROWS)
    assert {name: figure.name for name, figure in FIGURES.items()} == {n: n for n in FIGURES}


def test_settings_are_those_that_blender_knows():
    for panel in PANELS:
        settings = panel.settings
        assert settings["method"] in abi.Method.__members__
        assert settings.get("light_tracing", "OFF") in abi.LightTracing.__members__
        assert settings.get("constraint", "HALF_VECTOR") in abi.Constraint.__members__


def test_the_paper_s_methods_stand_without_light_paths():
    for panel in PANELS:
        if panel.settings["method"].startswith(("SMS_", "MNEE")):
            assert panel.settings["light_tracing"] == "OFF"


def test_rows_have_the_size_of_their_references():
    for line in ROWS:
        scene = _scenes.example(line.view.scene)
        if scene.reference_path.exists():
            assert line.view.size == scene.size


def test_figures_are_chosen_by_name():
    assert _figure_plan.chosen(None) == list(FIGURES.values())
    assert [figure.name for figure in _figure_plan.chosen("slab, ring,slab")] == ["slab", "ring"]
    with pytest.raises(DevError, match="no figure 'rings'"):
        _figure_plan.chosen("rings")
    with pytest.raises(DevError, match="names none"):
        _figure_plan.chosen(",")


def test_stored_references_are_not_rendered():
    line = row(WHOLE, PATH_TRACING, REFERENCE)
    shots = [_figure_plan.shot(line, panel, SECONDS, None, THREADS) for panel in line.panels]
    assert [shot is None for shot in shots] == [True, False, True]
    assert shots[1].job["seconds"] == SECONDS
    assert shots[1].job["border"] == [64, 64, 192, 192]


@pytest.mark.parametrize(
    ("line", "longer"),
    [
        (row(), 128),  # of another size
        (row(edits={"hidden": ["Ring"]}), None),  # of another scene
    ],
)
def test_what_is_not_stored_takes_a_long_render(line, longer):
    shot = _figure_plan.shot(line, REFERENCE, SECONDS, longer, THREADS)
    assert shot.budget == LONG * SECONDS
    assert shot.settings == AUTOMATIC.settings
    assert shot.edits == line.edits  # all of the picture


def test_a_scene_without_a_reference_takes_a_long_render(monkeypatch, tmp_path):
    scene = dataclasses.replace(_scenes.example("ring"), reference_path=tmp_path / "ring.exr")
    monkeypatch.setattr(_scenes, "example", lambda _: scene)
    assert _figure_plan.shot(row(), REFERENCE, SECONDS, None, THREADS).budget == LONG * SECONDS


def test_pictures_differ_by_their_edits():
    jobs = [
        _figure_plan.shot(line, panel, SECONDS, None, THREADS).job
        for line in FIGURES["roughness"].rows
        for panel in line.panels
    ]
    assert len({repr(job) for job in jobs}) == len(jobs)


def test_sizes_keep_their_shape():
    assert view(size=(256, 144)).scaled(None) == (256, 144)
    assert view(size=(256, 144)).scaled(512) == (512, 288)


@pytest.mark.parametrize("size", [(256, 256), (256, 144), (97, 64)])
def test_crops_are_squares_inside_the_picture(size):
    for centre in ((0.0, 0.0), (0.5, 0.5), (1.0, 1.0)):
        for side in (0.1, 0.38, 1.0):
            rows, columns = view(centre=centre, side=side).crop(size)
            assert rows.stop - rows.start == columns.stop - columns.start > 0
            assert rows.start >= 0
            assert columns.start >= 0
            assert rows.stop <= size[1]
            assert columns.stop <= size[0]


def test_crops_lie_around_their_centre():
    assert view(centre=(0.5, 0.25), side=0.25).crop((80, 40)) == (slice(0, 20), slice(30, 50))


# -------------------------------------------------------------------------------------- captions


def record(**stats):
    return Record(
        {"samples": 12.5, "render_seconds": 8.04, "stats": stats}, 9.0, 0.0, "one", Path()
    )


def test_captions_tell_what_walks_did():
    stats = {"walks": 400, "walks_converged": 100, "trials": 30, "trial_estimates": 8}
    cell = Cell(row(), AUTOMATIC, np.zeros((4, 8, 3)), record(**stats))
    assert caption(cell) == ["Automatic", "12.5 spp, 8.0 s", "SR 25.0%   BT 3.75"]


def test_captions_say_nothing_of_what_was_not_counted():
    cell = Cell(row(), PATH_TRACING, np.zeros((4, 8, 3)), record(walks=0, trial_estimates=0))
    assert caption(cell) == ["Path tracing", "12.5 spp, 8.0 s"]


def test_captions_of_references_say_how_they_were_made():
    image = np.zeros((4, 8, 3))
    stored = Reference(image, image, {"method": "SHEETS", "samples": "486"})
    assert caption(Cell(row(), REFERENCE, image, None, stored)) == ["Reference", "SHEETS, 486 spp"]
    rendered = caption(Cell(row(), REFERENCE, image, record()))
    assert rendered == ["Longer render", "automatic, 12.5 spp, 8.0 s"]


def test_errors_are_those_of_the_crop():
    mean = np.ones((256, 256, 3))
    mean[64:192, 64:192] = 2.0
    reference = Reference(mean, np.full_like(mean, 0.05), {})
    cell = Cell(row(), PATH_TRACING, np.full((128, 128, 3), 2.5), record(), reference)
    assert cell.errors.mse == pytest.approx(0.25 - 0.05)
    assert caption(cell)[-1] == "MSE 0.2 (0.2)"
