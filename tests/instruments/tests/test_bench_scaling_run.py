# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev bench scaling` from end to end, on small normal maps."""

from __future__ import annotations

import csv
import json
import subprocess

import pytest

from tools.common import ROOT

pytestmark = pytest.mark.slow  # they start Blender

TEXELS = [128**2, 256**2, 512**2]
TEXEL_BYTES = 16  # four floats


def bench(*arguments: str) -> subprocess.CompletedProcess:
    command = [str(ROOT / "dev"), "bench", "scaling", *arguments]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scaling")
    result = bench("--only", "map", "--quick", "--seconds", "0.2", "--out", str(folder))
    assert result.returncode == 0, result.stderr
    assert result.stdout.splitlines()[-1] == str(folder / "index.html")
    return folder


@pytest.fixture(scope="module")
def dimension(folder):
    return json.loads((folder / "scaling.json").read_text())["dimensions"][0]


def medians(dimension, quantity: str) -> list[float]:
    return [spread["median"] for spread in dimension["quantities"][quantity]["y"]]


def test_memory_grows_by_the_copies_of_the_map(dimension):
    """Blender, the export and the core hold one each."""
    assert [point["value"] for point in dimension["points"]] == TEXELS
    memory = medians(dimension, "memory")
    copies = (memory[-1] - memory[0]) / (TEXEL_BYTES * (TEXELS[-1] - TEXELS[0]))
    assert 1.8 < copies < 4.0


def test_the_manifold_costs_something_and_finds_light(dimension):
    plain, sms, own = (medians(dimension, name) for name in ("pt", "sms", "manifold"))
    assert own == pytest.approx([a - b for a, b in zip(sms, plain, strict=True)])
    assert min(plain) > 0.0
    assert min(own) > 0.0
    # The same waves, whatever resolves them.
    assert medians(dimension, "found") == pytest.approx([0.44] * 3, abs=0.04)


def test_the_page_holds_everything(folder):
    page = (folder / "index.html").read_text()
    assert page.count("data:image/svg+xml;base64,") == 1
    for text in ("http://", "https://", 'src="charts', "$"):
        assert text not in page
    assert {path.name for path in (folder / "charts").iterdir()} == {"map.png", "map.svg"}
    with open(folder / "scaling.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["value"]) for row in rows if row["quantity"] == "sms"] == TEXELS


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["--rounds", "0"], 2, "--rounds must be at least 1"),
        (["--seconds", "-1"], 2, "--seconds must be positive"),
        (["--only", "lihgts"], 1, "no dimension 'lihgts'"),
    ],
)
def test_bad_arguments_are_refused(arguments, code, message):
    result = bench(*arguments)
    assert result.returncode == code
    assert message in result.stderr
