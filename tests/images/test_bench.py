# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev bench` from end to end, on a box that path tracing masters."""

from __future__ import annotations

import csv
import json
import subprocess

import pytest

from tests.images._cases import CORNELL
from tests.images._reference import FOLDER
from tools import venvs
from tools.common import ROOT

DIM = 0.98  # on the light of the method pt-dim
BIAS_Z = 4.0
SECONDS = 1.0


def bench(folder) -> subprocess.CompletedProcess:
    command = [str(ROOT / "dev"), "bench", "--out", str(folder)]
    command += ["--blend", str(ROOT / "blend_scenes" / f"{CORNELL.name}.blend")]
    command += ["--reference", str(FOLDER / f"{CORNELL.name}.exr")]
    command += ["--methods", "pt,pt-dim", "--budgets", f"{SECONDS / 2:g},{SECONDS:g}"]
    result = subprocess.run([*command, "--seeds", "2"], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    return result


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bench")
    bench(folder)
    return folder


@pytest.fixture(scope="module")
def curves(folder):
    return json.loads((folder / "summary.json").read_text())["scenes"][0]["curves"]


def last_errors(curve: dict) -> dict:
    return curve["points"][-1]["regions"]["image"]


def test_two_percent_of_missing_light_show_as_bias(curves):
    errors = last_errors(curves["pt-dim"])
    assert errors["bias_z"] < -BIAS_Z
    assert errors["bias"] == pytest.approx(DIM - 1.0, abs=0.008)


def test_right_light_shows_no_bias(curves):
    errors = last_errors(curves["pt"])
    assert abs(errors["bias_z"]) < BIAS_Z
    assert abs(errors["bias"]) < 0.008


def test_renders_keep_to_their_time_and_errors_fall(curves):
    first, last = curves["pt"]["points"]
    for point in (first, last):
        assert point["render_seconds"] == pytest.approx(point["budget"], rel=0.05)
        assert point["wall_seconds"] > point["render_seconds"] + point["load_seconds"]
    assert last["samples"] > 1.2 * first["samples"]
    assert last["regions"]["image"]["mse"] < first["regions"]["image"]["mse"]
    assert last["flip"]["mean"] < first["flip"]["mean"]


def test_the_build_that_is_compared_with_has_path_guiding():
    """Without it Cycles would ignore the setting, and path tracing be charted twice."""
    code = "import bpy, _cycles; print(_cycles.with_path_guiding)"
    command = [str(venvs.bpy_python()), "-c", code]
    output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert output.split()[-1] == "True"


def test_the_page_holds_everything(folder):
    page = (folder / "index.html").read_text()
    assert page.count("data:image/svg+xml;base64,") == 1  # pt-dim is in none
    assert page.count("data:image/png;base64,") == 4  # reference, its crop, a crop for each method
    for text in ("http://", "https://", 'src="charts'):
        assert text not in page
    with open(folder / "summary.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["method"], row["budget"]) for row in rows] == [
        (method, budget) for method in ("pt", "pt-dim") for budget in ("0.5", "1.0")
    ]


def test_what_was_rendered_is_found_again(folder, tmp_path):
    again = bench(tmp_path)
    assert "bench: [" not in again.stderr  # the progress of a render
    old, new = (json.loads((path / "summary.json").read_text()) for path in (folder, tmp_path))
    assert new["scenes"] == old["scenes"]
