# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders that are divided among processes, killed, gone on with, and merged."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import numpy as np
import pytest
from layers import read_layers, render_layers
from scenes import add_camera, add_light, add_mesh, add_node, new_material, surface

from specula import divided, merge, parts

TOTAL = 24


@pytest.fixture
def lit_mirror(monkeypatch):
    """A mirror that throws a lamp on the floor: walks, sheets and light paths."""
    white, silver = new_material("white"), new_material("silver")
    add_node(white, "ShaderNodeBsdfDiffuse", surface(white))
    node = add_node(silver, "ShaderNodeBsdfGlossy", surface(silver))
    node.inputs["Roughness"].default_value = 0.0
    add_mesh("Floor", material=white)
    mirror = add_mesh("Mirror", material=silver)
    mirror.location, mirror.rotation_euler = (1, 0, 1), (0, -np.pi / 2, 0)
    add_light(energy=10, shadow_soft_size=0.1).location = (-0.5, 0, 1)
    add_camera((0, 0, 5))
    scene = bpy.context.scene
    scene.world = None
    scene.specula.samples = TOTAL
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_diffuse_indirect = layer.specula.use_pass_caustics = True
    monkeypatch.setattr(sys, "argv", ["blender"])
    return scene


def render_part(path: Path, first: int, end: int, monkeypatch, tmp_path):
    samples = f"{first}:{end}"
    arguments = ["--specula-part", str(path), "--specula-samples", samples]
    monkeypatch.setattr(sys, "argv", ["blender", "--", *arguments])
    return render_layers(tmp_path)[0]


def test_merged_ranges_are_one_render_to_the_bit(lit_mirror, tmp_path, monkeypatch):
    whole = tmp_path / "whole.part"
    layers = render_part(whole, 0, TOTAL, monkeypatch, tmp_path)
    lit_mirror.render.threads_mode, lit_mirror.render.threads = "FIXED", 1
    pieces = []
    for first, end in ((17, TOTAL), (0, 5), (5, 17)):
        pieces.append(tmp_path / f"{first}.part")
        render_part(pieces[-1], first, end, monkeypatch, tmp_path)
    merged, picture = tmp_path / "merged.part", tmp_path / "merged.exr"
    assert merge.main([*map(str, pieces), "--part", str(merged), "-o", str(picture)]) == 0
    assert merged.read_bytes() == whole.read_bytes()
    found, _ = read_layers(picture)
    assert set(found) == set(layers)
    for name, pixels in layers.items():
        np.testing.assert_array_equal(found[name], pixels, name)
    assert layers["ViewLayer.Caustics"].any()


def test_the_picture_is_that_of_an_ordinary_render(lit_mirror, tmp_path, monkeypatch):
    """Not to the bit: samples of an ordinary render learn from those before them."""
    lit_mirror.specula.samples = 256
    ordinary = render_layers(tmp_path)[0]["ViewLayer.Combined"]
    part = render_part(tmp_path / "a.part", 0, 256, monkeypatch, tmp_path)["ViewLayer.Combined"]
    np.testing.assert_allclose(part[..., :3].mean(), ordinary[..., :3].mean(), rtol=0.01)


def test_missing_samples_are_told(lit_mirror, tmp_path, monkeypatch, capsys):
    for first in (0, 16):
        render_part(tmp_path / f"{first}.part", first, first + 8, monkeypatch, tmp_path)
    files = [str(tmp_path / "0.part"), str(tmp_path / "16.part")]
    assert merge.main([*files, "-o", str(tmp_path / "out.exr")]) == merge.INCOMPLETE
    assert "0:8, 16:24 of 24 samples" in capsys.readouterr().err


@pytest.mark.parametrize("changed", ["scene", "seed", "number of samples"])
def test_other_pictures_are_refused_by_name(lit_mirror, tmp_path, monkeypatch, capsys, changed):
    render_part(tmp_path / "a.part", 0, 8, monkeypatch, tmp_path)
    if changed == "scene":
        bpy.data.objects["Mirror"].location.x += 0.01
    elif changed == "seed":
        lit_mirror.specula.seed = 7
    else:
        lit_mirror.specula.samples = TOTAL + 1
    render_part(tmp_path / "b.part", 8, 16, monkeypatch, tmp_path)
    out = tmp_path / "out.exr"
    assert merge.main([str(tmp_path / "a.part"), str(tmp_path / "b.part"), "-o", str(out)]) == 1
    assert f"b.part: of another {changed}" in capsys.readouterr().err
    assert not out.exists()
    with pytest.raises(RuntimeError, match=f"of another {changed}"):
        render_part(tmp_path / "a.part", 0, 16, monkeypatch, tmp_path)


def test_damage_and_doubles_are_refused(lit_mirror, tmp_path, monkeypatch):
    path = tmp_path / "a.part"
    render_part(path, 0, 8, monkeypatch, tmp_path)
    with pytest.raises(parts.PartError, match="sample 0 is there already"):
        parts.merge([path, path])
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    with pytest.raises(parts.PartError, match="checksum"):
        parts.read_part(path)
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(parts.PartError, match="checksum"):
        parts.read_part(path)
    path.write_bytes(b"hello")
    with pytest.raises(parts.PartError, match="no part"):
        parts.read_part(path)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--specula-part", "a", "--specula-samples", "8"],
        ["--specula-part", "a", "--specula-samples", "8:8"],
        ["--specula-samples", "0:8"],
    ],
)
def test_orders_that_make_no_sense_are_refused(arguments):
    with pytest.raises(parts.PartError):
        divided.order(arguments)


# Run in a Blender of its own, to be killed.
WORKER = """
import sys, bpy
bpy.ops.preferences.addon_enable(module="specula")
bpy.ops.wm.open_mainfile(filepath=sys.argv[sys.argv.index("--") + 1])
bpy.ops.render.render()
"""


@pytest.mark.slow
def test_killed_workers_lose_nothing_but_time(lit_mirror, tmp_path, monkeypatch):
    whole, part = tmp_path / "whole.part", tmp_path / "killed.part"
    lit_mirror.specula.samples = 400
    lit_mirror.render.resolution_x = lit_mirror.render.resolution_y = 128
    file = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    render_part(whole, 0, 400, monkeypatch, tmp_path)
    script = tmp_path / "worker.py"
    script.write_text(WORKER)
    arguments = [str(file), "--specula-part", str(part), "--specula-checkpoint", "0.2"]
    if bpy.app.binary_path:
        command = [bpy.app.binary_path, "-b", "--python-exit-code", "1", "-P", script, "--"]
    else:
        command = [sys.executable, script, "--"]
    kills, samples = 0, 0
    while True:
        worker = subprocess.Popen([*command, *arguments], stdout=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        while worker.poll() is None and time.monotonic() < deadline:
            there = parts.read_part(part).samples if part.exists() else 0
            if kills < 3 and there > samples:
                samples = there
                os.kill(worker.pid, signal.SIGKILL)
                kills += 1
                break
            time.sleep(0.02)
        if worker.wait(timeout=60) == 0:
            break
        assert worker.returncode == -signal.SIGKILL
    assert kills == 3
    assert part.read_bytes() == whole.read_bytes()
