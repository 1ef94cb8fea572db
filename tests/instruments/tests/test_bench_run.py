# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev bench` from end to end, on a box that path tracing masters."""

from __future__ import annotations

import csv
import json
import subprocess
from pathlib import Path

import pytest

from tests.images._cases import CORNELL
from tests.images._reference import FOLDER, read
from tools import venvs
from tools.common import ROOT

pytestmark = pytest.mark.slow  # they start Blender

DEV = str(ROOT / "dev")
DIM = 0.98  # on the light of the method pt-dim
BIAS_Z = 4.0
SECONDS = 1.0


def bench(folder) -> subprocess.CompletedProcess:
    command = [DEV, "bench", "--out", str(folder)]
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


def exposed(folder, exposure: float) -> tuple[Path, Path]:
    """A copy of the box with this exposure, and its reference after a second."""
    # A dot in the name must not cost a chart its own.
    blend, image = folder / f"box.x{exposure:g}.blend", folder / f"{exposure:g}.exr"
    script = folder / "expose.py"
    script.write_text(
        "import bpy\n"
        f"bpy.ops.wm.open_mainfile(filepath={str(ROOT / 'blend_scenes' / 'cornell.blend')!r})\n"
        f"bpy.context.scene.cycles.film_exposure = {exposure}\n"
        f"bpy.ops.wm.save_as_mainfile(filepath={str(blend)!r})\n"
    )
    subprocess.run([DEV, "bpy", str(script)], capture_output=True, check=True)
    command = [DEV, "bench", "reference", str(blend), "--out", str(image), "--size", "64x64"]
    command += ["--method", "PT", "--seconds", "1"]
    subprocess.run(command, capture_output=True, check=True)
    return blend, image


def test_a_reference_has_the_exposure_of_the_film(tmp_path):
    """As every picture that Blender receives."""
    once, (blend, image) = read(exposed(tmp_path, 1.0)[1]), exposed(tmp_path, 2.0)
    twice = read(image)
    assert twice.mean.mean() == pytest.approx(2.0 * once.mean.mean(), rel=0.005)
    of_a_sample = [found.samples * found.variance.mean() for found in (once, twice)]
    assert of_a_sample[1] == pytest.approx(4.0 * of_a_sample[0], rel=0.1)
    command = [DEV, "bench", "--blend", str(blend), "--reference", str(image), "--seeds", "1"]
    command += ["--methods", "pt", "--budgets", "0.5", "--out", str(tmp_path / "out")]
    subprocess.run(command, capture_output=True, check=True)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())["scenes"][0]
    assert abs(last_errors(summary["curves"]["pt"])["bias"]) < 0.005
    assert "path tracers" in summary["notes"][0]  # PT does not tell where caustics are
    assert (tmp_path / "out" / "charts" / "box.x2_best.svg").exists()


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
