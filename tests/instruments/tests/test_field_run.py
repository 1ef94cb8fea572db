# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev field` from end to end: a scene, a file that is none, and one that stands still."""

from __future__ import annotations

import json
import shutil
import subprocess

import pytest

from tests.instruments.field._measure import NEITHER, STILL, WELL
from tools.common import ROOT

pytestmark = pytest.mark.slow  # they start Blender

DEV = str(ROOT / "dev")
CORNELL = ROOT / "blend_scenes" / "cornell.blend"


def rendered(folder, *arguments: str) -> tuple[int, dict[str, dict]]:
    """Exit code, and scenes by the stem of their file."""
    command = [DEV, "field", str(folder), "--out", str(folder / "out"), "--size", "48"]
    command += ["--samples", "8", *arguments]
    code = subprocess.run(command, capture_output=True, text=True).returncode
    scenes = json.loads((folder / "out" / "results.json").read_text())["scenes"]
    return code, {
        scene["blend"].rpartition("/")[2].removesuffix(".blend"): scene for scene in scenes
    }


@pytest.mark.parametrize("blender", ["3.4", "5.0"])
def test_a_scene_and_a_file_that_is_none(tmp_path, blender):
    shutil.copy(CORNELL, tmp_path)
    (tmp_path / "broken.blend").write_text("not a scene")
    code, scenes = rendered(tmp_path, "--blender", blender)
    assert code == 0
    assert scenes["broken"]["verdict"] == NEITHER
    cornell = scenes["cornell"]
    assert cornell["verdict"] == WELL
    assert cornell["comparison"]["ratio"] == pytest.approx(1.0, abs=0.02)
    for row in cornell["specula"]["renders"]:
        assert 0.0 < row["first_sample_seconds"] < row["call_seconds"]
        assert row["samples"] == 8.0
    for path in cornell["pictures"].values():
        assert (tmp_path / "out" / path).stat().st_size > 0


def test_what_does_not_end_is_killed(tmp_path):
    shutil.copy(CORNELL, tmp_path)
    arguments = ["--seconds", "60", "--samples", str(1 << 20), "--hard-limit", "6"]
    code, scenes = rendered(tmp_path, *arguments)
    assert code == 1
    assert scenes["cornell"]["verdict"] == STILL
    assert scenes["cornell"]["specula"]["wall_seconds"] < 30.0


def test_scenes_are_made(tmp_path):
    subprocess.run([DEV, "field", "--make", str(tmp_path)], check=True, capture_output=True)
    made = list(tmp_path.glob("*.blend"))
    assert len(made) >= 40
    assert all(path.stat().st_size > 10_000 for path in made)
