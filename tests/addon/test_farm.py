# SPDX-License-Identifier: GPL-3.0-or-later
"""The farms' templates, with stand-ins for their programs: every sample of every frame once."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tools import venvs

FARM = Path(__file__).resolve().parents[2] / "docs" / "farm"

# Runs an array job's script for each task at once, and prints the job's number.
SBATCH = """#!/bin/bash
script=$(cat)
array=0-0
for argument in "$@"; do case $argument in --array=*) array=${argument#*=} ;; esac; done
for ((i = ${array%-*}; i <= ${array#*-}; i++)); do
    SLURM_ARRAY_TASK_ID=$i bash -c "$script" || exit
done
echo 7
"""
RECORDER = """#!/bin/bash
echo "$(basename "$0") $*" >> "$RECORD"
"""


def program(folder: Path, name: str, text: str) -> None:
    path = folder / name
    path.write_text(text)
    path.chmod(0o755)


@pytest.fixture
def farm(tmp_path):
    """A folder with parts of frames 3 and 4, and programs that record how they are called."""
    programs, out = tmp_path / "bin", tmp_path / "out"
    programs.mkdir()
    program(programs, "sbatch", SBATCH)
    program(programs, "blender", RECORDER)
    program(programs, "python3", RECORDER)
    out.mkdir()
    for frame in (3, 4):
        for begin in (0, 33, 66):
            (out / f"{frame:04}_View Layer_{begin}.part").touch()
    return tmp_path


def calls(farm: Path, command: list) -> list[str]:
    """Of Blender and Python, by a command that finds the stand-ins first."""
    record = farm / "record"
    env = os.environ | {
        "PATH": f"{farm / 'bin'}:{os.environ['PATH']}",
        "RECORD": str(record),
        "SPECULA_PATH": "/addons",
    }
    subprocess.run(command, env=env, check=True, timeout=60)
    return record.read_text().splitlines()


def check_calls(lines: list[str]) -> None:
    """Each frame's 100 samples are there once, in three parts, and are merged."""
    renders = [line for line in lines if line.startswith("blender ")]
    for frame in (3, 4):
        ranges = [line.split()[-1] for line in renders if f" -f {frame} -- " in line]
        assert ranges == ["0:33", "33:66", "66:100"]
    merges = [line for line in lines if line.startswith("python3 -m specula.merge")]
    assert len(merges) == 2
    assert all(line.count(".part") == 3 and line.endswith(".exr") for line in merges)
    assert lines[-1] in merges


def test_slurm_divides_samples_and_merges(farm):
    check_calls(calls(farm, [FARM / "slurm.sh", "a.blend", "3", "4", "100", "3", farm / "out"]))


def test_openjd_divides_samples_and_merges(farm):
    """By the program that the specification's authors give out, which checks the template, too."""
    (farm / "a.blend").touch()
    python = venvs.openjd_python()
    openjd = [python, python.parent / "openjd"]
    template = FARM / "openjd.yaml"
    subprocess.run([*openjd, "check", template], check=True, timeout=60)
    values = {
        "SceneFile": farm / "a.blend",
        "OutFolder": farm / "out",
        "Frames": "3,4",
        "Samples": 100,
        "Parts": 3,
        "Addons": "/addons",
    }
    given = [word for name, value in values.items() for word in ("-p", f"{name}={value}")]
    run = [*openjd, "run", template, "--step", "Merge", "--run-dependencies", *given]
    check_calls(calls(farm, run))


FLAMENCO = """
const made = [];
const author = {
    Task: (name, type) => ({ name, type, commands: [], needs: [],
        addCommand(c) { this.commands.push(c); }, addDependency(t) { this.needs.push(t.name); } }),
    Command: (name, parameters) => ({ name, parameters }),
};
const frameChunker = (frames) => frames.split(",");
compileJob({ settings: { frames: "3,4", samples: 100, parts: 3, out: "/out", addons: "/addons",
    blendfile: "a.blend" }, addTask(t) { made.push(t); } });
console.log(JSON.stringify(made));
"""


@pytest.mark.skipif(shutil.which("node") is None, reason="there is no node to run the job type")
def test_flamenco_divides_samples_and_merges(tmp_path):
    script = tmp_path / "job.js"
    script.write_text((FARM / "specula_divided.js").read_text() + FLAMENCO)
    made = subprocess.run(["node", script], capture_output=True, text=True, check=True, timeout=60)
    tasks = json.loads(made.stdout)
    assert [task["type"] for task in tasks] == [*["blender"] * 3, "misc"] * 2
    for merge in tasks[3::4]:
        assert len(merge["needs"]) == 3
    ranges = [task["commands"][0]["parameters"]["args"][-1] for task in tasks[:3]]
    assert ranges == ["0:33", "33:66", "66:100"]
