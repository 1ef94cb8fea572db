# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of ./dev parity that need no Blender: the table, the statistics, what is said of a row,
and that a row which ends its process does not take the others along."""

import json
import sys
from fnmatch import fnmatchcase

import numpy as np
import OpenImageIO as oiio
import pytest

from tests.instruments.bench import _children
from tests.instruments.pairs.comparison import compare, noise, picture
from tests.instruments.parity import _known, _passes, _verdict, parity
from tests.instruments.parity._rows import ROWS
from tests.instruments.parity._verdict import TOLERANCE, Outcome, verdict

SIZE = 96
NOISE = 0.05  # of a pixel of a render, relative


# ------------------------------------------------------------------------------------------- table


def test_names_of_rows_and_of_their_files_are_unique():
    assert len(ROWS) >= 200
    assert len({parity.stem(name) for name in ROWS}) == len(ROWS)
    assert not any("," in name for name in ROWS)  # it separates patterns


def test_rows_are_chosen_by_name_by_part_of_it_or_by_pattern():
    assert parity.select("math/add") == ["math/add"]
    assert set(parity.select("math/ad")) == {"math/add", "vector_math/add"}
    assert parity.select("math/ad?") == ["math/add"]
    assert parity.select(None) == list(ROWS)
    assert parity.select("no such row") == []


def test_passes_are_read_by_name_and_without_them_nothing(tmp_path):
    path = str(tmp_path / "layers.exr")
    names = [f"Layer.{rest}" for rest in ("Depth.Z", "Normal.Z", "Normal.X", "Normal.Y")]
    spec = oiio.ImageSpec(2, 3, len(names), "float")
    spec.channelnames = names
    pixels = np.arange(6.0 * len(names), dtype=np.float32).reshape(3, 2, len(names)) - 9.0
    output = oiio.ImageOutput.create(path)
    output.open(path, spec)
    output.write_image(pixels)
    output.close()
    upright = pixels[::-1]
    depth, normal, mist = (_passes.read(path, name, (3, 2)) for name in ("Depth", "Normal", "Mist"))
    np.testing.assert_array_equal(depth, np.repeat(upright[..., :1], 3, axis=2))
    np.testing.assert_array_equal(normal, upright[..., [2, 3, 1]])
    assert mist.shape == (3, 2, 3) and not mist.any()
    np.testing.assert_array_equal(_passes.comparable("Normal", normal), 0.5 + 0.5 * normal)
    assert _passes.comparable("Depth", depth + 1e10).max() == _passes.FARTHEST


@pytest.mark.parametrize("table", [_known.BY_DESIGN, _known.FAILING])
def test_what_is_listed_exists_and_has_a_reason(table):
    for pattern, why in table.items():
        assert any(fnmatchcase(name, pattern) for name in ROWS), pattern
        assert why


# -------------------------------------------------------------------------------------- statistics


def renders(seed: int, factor=1.0) -> list[dict]:
    """Two noisy renders of a slope, times `factor`, with so much noise as parity asks for."""
    rng = np.random.default_rng(seed)
    light = np.linspace(0.2, 1.0, SIZE)[:, None, None] * np.ones((SIZE, SIZE, 3)) * factor
    return [{"Combined": light * (1.0 + NOISE * rng.normal(size=light.shape))} for _ in range(2)]


def compared(factor=1.0, seed: int = 2):
    return compare(picture(renders(seed, factor)), picture(renders(1)), TOLERANCE)


def test_the_noise_is_what_parity_asks_for():
    assert noise(picture(renders(1))) == pytest.approx(0.005, rel=0.15)


@pytest.mark.parametrize("seed", range(2, 22))
def test_noise_alone_is_no_difference(seed):
    assert not compared(seed=seed).differs


@pytest.mark.parametrize("factor", [0.985, 1.015])
def test_a_shift_of_all_light_by_a_percent_and_a_half_is_found(factor):
    found = compared(factor)
    assert found.light_differs
    assert found.ratio == pytest.approx(factor, abs=4.0 * found.ratio_error)


@pytest.mark.parametrize("factor", [0.95, 1.05])
def test_a_shift_of_a_part_by_a_twentieth_is_found(factor):
    """A tenth of the blocks: the mean tells nothing."""
    part = np.ones((SIZE, SIZE, 1))
    part[:32, :32] = factor
    found = compared(part)
    assert not found.light_differs
    assert found.differing > TOLERANCE.share


# ---------------------------------------------------------------------------------------- verdict

SAME, OTHER = compared(), compared(1.2)
DESIGN = "setting/clamp_direct"


@pytest.mark.parametrize(
    ("row", "comparison", "expected"),
    [
        (Outcome("math/add", "done"), SAME, _verdict.ALIKE),
        (Outcome("math/add", "done"), OTHER, _verdict.DIFFERS),
        (Outcome("math/add", "done", warnings=["no"]), OTHER, _verdict.WARNED),
        (Outcome("math/add", "done", warnings=["no"]), SAME, _verdict.ALIKE),
        (Outcome(DESIGN, "done"), OTHER, _verdict.DESIGN),
        (Outcome(DESIGN, "done"), SAME, _verdict.ALIKE),
        (Outcome("math/add", "absent", "no Math"), None, _verdict.ABSENT),
        (
            Outcome("math/add", "failed", "camera: type PANO is not supported"),
            None,
            _verdict.WARNED,
        ),
        (Outcome("math/add", "failed", "KeyError"), None, _verdict.FAILED),
        (Outcome("math/add", "crashed"), None, _verdict.CRASHED),
    ],
)
def test_verdicts(row, comparison, expected):
    assert verdict(row, comparison) == expected


def test_a_list_that_is_out_of_date_is_told():
    assert "and is not" in _verdict.remark(Outcome(DESIGN, "done"), _verdict.ALIKE)
    assert _verdict.remark(Outcome("math/add", "done"), _verdict.ALIKE) == ""


# --------------------------------------------------------------------------------------- processes

# Every row is a picture of noise; those whose name says so end the process.
CHILD = """
import faulthandler, json, os, signal, sys, time
import numpy as np
job = json.load(open(sys.argv[1]))
rows = []
rng = np.random.default_rng(1)
for name, path in job["rows"]:
    rows.append({"name": name, "outcome": "begun"})
    json.dump(rows, open(job["result"], "w"))
    if name == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if name == "stand":
        faulthandler.dump_traceback_later(0.2, exit=True)
        time.sleep(60)
    arrays = {}
    for engine in ("CYCLES", "SPECULA"):
        arrays[engine + "/mean"] = rng.uniform(0.9, 1.1, (16, 16, 3))
        arrays[engine + "/variance"] = np.full((16, 16, 3), 0.2**2 / 12.0)
        arrays[engine + "/splats"] = 0
    np.savez(path, **arrays)
    rows[-1]["outcome"] = "done"
    json.dump(rows, open(job["result"], "w"))
"""


@pytest.fixture
def options(monkeypatch, tmp_path):
    """Rows are rendered by CHILD."""
    script = tmp_path / "child.py"
    script.write_text(CHILD)
    monkeypatch.setitem(
        _children.HOSTS, "python", lambda _, job: ([sys.executable, str(script), str(job)], {})
    )
    (tmp_path / "work").mkdir()
    return parity.Options("python", "PT", 1, 0.1, 2, 5.0, 1, tmp_path)


def test_a_row_that_ends_its_process_does_not_take_the_others_along(options):
    names = ["first", "crash", "second", "stand", "last"]
    results = parity.examine(names, options, "about")
    assert [(found.row.name, found.verdict) for found in results] == [
        ("first", _verdict.ALIKE),
        ("crash", _verdict.CRASHED),
        ("second", _verdict.ALIKE),
        ("stand", _verdict.STILL),
        ("last", _verdict.ALIKE),
    ]
    document = json.loads((options.out / "results.json").read_text())
    assert [row["row"]["name"] for row in document["rows"][:2]] == ["crash", "stand"]
    page = (options.out / "index.html").read_text()
    assert page.index("</b> crash") < page.index("</b> first")
    for path in results[0].pictures.values():
        assert (options.out / path).stat().st_size > 0
