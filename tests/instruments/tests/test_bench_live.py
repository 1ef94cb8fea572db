# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev bench live`: what it tells, and a run from end to end."""

from __future__ import annotations

import json
import subprocess

import pytest

from tests.instruments.bench import live
from tools.common import ROOT


def test_rows_are_medians_beside_each_other():
    steps = {
        "SPECULA": {"camera": {"first": [50.0, 60.0, 900.0], "held": [3.0]}},
        "CYCLES": {"camera": {"first": [120.0], "held": [0.0]}},
    }
    first, held = live.rows("pool", steps)
    assert first.split() == [
        "pool",
        "camera",
        "first",
        "60.0",
        "ms,",
        "Cycles",
        "120.0,",
        "ratio",
        "0.50,",
        "wanted",
        "100",
    ]
    assert held.split() == ["pool", "camera", "held", "3.0", "ms,", "Cycles", "0.0"]


@pytest.mark.slow  # it starts Blender
def test_a_small_run(tmp_path):
    command = [str(ROOT / "dev"), "bench", "live", "--only", "hills", "--turns", "1"]
    command += ["--rounds", "1", "--out", str(tmp_path)]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    found = json.loads((tmp_path / "live.json").read_text())["ms"]["hills"]
    assert found.keys() == {"SPECULA", "CYCLES"}
    for steps in found.values():
        assert list(steps) == ["enter", "camera", "material", "object", "interrupt"]
        for values in steps.values():
            (first,), (held,) = values["first"], values["held"]
            assert 0.0 < held <= first
