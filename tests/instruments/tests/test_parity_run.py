# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev parity` from end to end: what is alike, what is not supported, what a camera refuses."""

from __future__ import annotations

import json
import subprocess

import pytest

from tests.instruments.parity import _verdict
from tools.common import ROOT

pytestmark = pytest.mark.slow  # it starts Blender

ROWS = {
    "closure/diffuse/roughness=0": _verdict.ALIKE,
    "texture/image": _verdict.ALIKE,
    "pass/normal": _verdict.ALIKE,
    "pass/vector": _verdict.WARNED,
    "camera/panorama/mirrorball": _verdict.ALIKE,
    "object/shadow_catcher": _verdict.WARNED,
    "volume/scatter": _verdict.WARNED,
}


@pytest.mark.parametrize("blender", ["3.4", "5.0"])
def test_rows_of_each_kind(tmp_path, blender):
    command = [ROOT / "dev", "parity", "--blender", blender, "--out", str(tmp_path)]
    code = subprocess.run(
        [*command, "--only", ",".join(ROWS)], capture_output=True, text=True
    ).returncode
    rows = json.loads((tmp_path / "results.json").read_text())["rows"]
    assert {found["row"]["name"]: found["verdict"] for found in rows} == ROWS
    assert code == 0
