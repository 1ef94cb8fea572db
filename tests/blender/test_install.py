# SPDX-License-Identifier: GPL-3.0-or-later
"""The packaged zip, installed as an artist does into a clean profile, renders as the tree does."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import bpy
import numpy as np
import pytest
from scenes import add_camera, add_light, add_mesh, add_node, add_uv, new_material, surface

ROOT = Path(__file__).parents[2]
IS_MODULE = not bpy.app.binary_path  # PyPI's bpy: extensions; else Debian's Blender: add-ons
SECONDS = 300  # the first package compiles the core

# bpy's own libraries where an official Blender has them: in the scope that is searched first.
INSTALL_EXTENSION = """
import os, sys
sys.setdlopenflags(os.RTLD_NOW | os.RTLD_GLOBAL)
import bpy
sys.setdlopenflags(os.RTLD_NOW)
bpy.ops.extensions.package_install_files(filepath={zip!r}, repo="user_default")
"""

INSTALL_ADDON = """
import bpy
bpy.ops.preferences.addon_install(filepath={zip!r})
bpy.ops.preferences.addon_enable(module="specula")
bpy.ops.wm.save_userpref()
"""

RENDER = """
bpy.ops.wm.open_mainfile(filepath={blend!r})
bpy.context.scene.render.engine = "SPECULA"
bpy.context.scene.render.filepath = {image!r}
bpy.ops.render.render(write_still=True)
"""

# Paths of the libraries in the process, one a line, and its end before bpy takes itself down.
TELL = """
import os, sys
for path in sorted({line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}):
    print("mapped", path)
sys.stdout.flush()
os._exit(0)
"""


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    """The zip that `./dev package` makes."""
    folder = tmp_path_factory.mktemp("package")
    command = [str(ROOT / "dev"), "package", "--out", str(folder)]
    subprocess.run(command, check=True, timeout=SECONDS)
    (path,) = folder.iterdir()
    return path


@pytest.fixture
def profile(tmp_path):
    """Folder of a clean profile."""
    folder = tmp_path / "profile"
    folder.mkdir()
    return folder


def environment(profile) -> dict[str, str]:
    """For a Blender that has nothing of the tree, of a user or of the calling Blender."""
    ours = ("BLENDER_", "SPECULA_", "LD_", "PYTHON")
    env = {name: value for name, value in os.environ.items() if not name.startswith(ours)}
    return env | {"BLENDER_USER_RESOURCES": str(profile)}


@pytest.fixture
def textured_scene(tmp_path):
    """A quad with a picture from a file, in the light of a lamp; pictures are written as floats."""
    scene = bpy.context.scene
    add_camera((0, 0, 3))
    add_light(energy=100.0).location = (0, 0, 3)
    picture = bpy.data.images.new("Picture", 8, 8)
    picture.pixels = np.random.default_rng(7).uniform(size=8 * 8 * 4).tolist()
    picture.filepath_raw, picture.file_format = str(tmp_path / "picture.png"), "PNG"
    picture.save()
    material = new_material()
    diffuse = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    texture = add_node(material, "ShaderNodeTexImage", diffuse.inputs["Color"])
    texture.image = bpy.data.images.load(str(tmp_path / "picture.png"))
    add_uv(add_mesh("Quad", material=material).data)
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    return scene


def pixels(path) -> np.ndarray:
    image = bpy.data.images.load(str(path))
    return np.array(image.pixels[:])


def child(profile, *command) -> str:
    """Output of a Blender with that profile, which must succeed."""
    result = subprocess.run(
        command, env=environment(profile), capture_output=True, text=True, timeout=SECONDS
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def install_and_render(archive, profile, folder) -> set[Path]:
    """Renders scene.blend of `folder` to installed.exr; returns the libraries in the process."""
    blend, image = str(folder / "scene.blend"), str(folder / "installed.exr")
    if IS_MODULE:
        script = folder / "script.py"
        script.write_text(
            INSTALL_EXTENSION.format(zip=str(archive))
            + RENDER.format(blend=blend, image=image)
            + TELL
        )
        output = child(profile, sys.executable, str(script))
    else:
        blender = [bpy.app.binary_path, "--background"]
        install = INSTALL_ADDON.format(zip=str(archive))
        child(profile, *blender, "--python-exit-code", "1", "--python-expr", install)
        still = [blend, "--engine", "SPECULA", "--render-output", str(folder / "installed_")]
        output = child(profile, *blender, *still, "--render-frame", "1", "--python-expr", TELL)
        (folder / "installed_0001.exr").rename(image)
    lines = [line.split() for line in output.splitlines()]
    return {Path(line[1]) for line in lines if line[:1] == ["mapped"]}


def test_an_installed_package_renders_as_the_tree_does(archive, textured_scene, profile, tmp_path):
    textured_scene.render.filepath = str(tmp_path / "tree.exr")
    bpy.ops.render.render(write_still=True)
    libraries = install_and_render(archive, profile, tmp_path)
    (core,) = [path for path in libraries if path.name.startswith("libspecula-")]
    assert core.is_relative_to(profile)
    if IS_MODULE:  # Debian's Blender has the same libraries itself
        beside = {path.name for path in libraries if path.parent == core.parent}
        assert {"libembree3.so.3", "libfmt.so.9"} <= beside
        assert not any(path.name.startswith("libOpenImageIO.so.2") for path in libraries)
    tree = pixels(tmp_path / "tree.exr")
    assert tree.max() > 0.5
    np.testing.assert_allclose(pixels(tmp_path / "installed.exr"), tree, rtol=1e-4, atol=1e-5)


def test_the_package_tells_the_licences_of_what_it_brings(archive):
    with zipfile.ZipFile(archive) as content:
        names = {Path(name).name for name in content.namelist() if "/lib/" in name}
        notice = content.read("specula/NOTICE").decode()
    brought = {name for name in names if not name.startswith("libspecula-")}
    assert brought == {"libembree3.so.3", "libtbb.so.12", "libfmt.so.9"}
    assert all(f"  {name}: source package " in notice for name in brought)
    for text in ("Apache License", "Permission is hereby granted", "Redistribution and use"):
        assert text in notice
