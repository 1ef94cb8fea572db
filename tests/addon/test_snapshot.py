# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshots: which parts of a scene the next one shares, and what it looks like."""

import dataclasses

import numpy as np
import pytest
from scenes import IDENTITY, camera, emission, glowing_triangle, triangle

from specula import abi, native
from specula.export import desc
from specula.export.log import ExportLog
from specula.upload import Snapshot, snapshot, upload

COLOR = np.array([[[200, 100, 50]]], np.uint8)


@pytest.fixture
def added(monkeypatch):
    """Kinds of the parts that were given to the core, not kept."""
    kinds = []
    add = native.Scene.add

    def recorded(self, kind, struct):
        kinds.append(kind)
        return add(self, kind, struct)

    monkeypatch.setattr(native.Scene, "add", recorded)
    return kinds


def built(made: Snapshot) -> Snapshot:
    assert made.builds(60_000)
    return made


def picture(scene: native.Scene) -> np.ndarray:
    with native.Session(scene, native.render_settings(method=abi.Method.PT, samples=1)) as session:
        while session.wait(1000).state == abi.RenderState.RUNNING:
            pass
        return session.read(abi.Pass.COMBINED, 8, 4)


def image(**source) -> desc.ImageDesc:
    return desc.ImageDesc("image", color_space=desc.ColorSpace.LINEAR, **source)


def glowing_image(index: int) -> desc.MaterialDesc:
    material = emission((1.0, 1.0, 1.0), f"image {index}")
    material.nodes.append(desc.NodeDesc("Texture", "image_texture", image=index))
    material.links.append(desc.LinkDesc(2, "Color", 1, "Color"))
    return material


def moved(scene_desc: desc.SceneDesc, z: float) -> desc.SceneDesc:
    """The same parts, instanced elsewhere."""
    place = IDENTITY.copy()
    place[2, 3] = z
    instances = [dataclasses.replace(one, transform=place) for one in scene_desc.instances]
    return dataclasses.replace(scene_desc, instances=instances)


def test_only_the_camera_needs_no_other_snapshot():
    scene_desc = glowing_triangle()
    first = built(snapshot(scene_desc, None, None))
    assert snapshot(dataclasses.replace(scene_desc, camera=camera(z=7.0)), None, first) is first
    second = built(snapshot(moved(scene_desc, 1.0), None, first))
    assert second is not first
    first.close()
    second.close()


def test_parts_are_given_once_and_give_up_their_arrays(added):
    scene_desc = glowing_triangle()
    first = built(snapshot(scene_desc, None, None))
    assert sorted(added) == ["instance", "material", "mesh"]
    assert scene_desc.meshes[0].positions is None
    added.clear()
    second = built(snapshot(moved(scene_desc, 1.0), None, first))
    first.close()
    assert added == ["instance"]
    with upload(moved(glowing_triangle(), 1.0)) as anew:
        anew.commit()
        assert np.array_equal(picture(second.scene), picture(anew))
    second.close()


def test_an_image_that_moves_takes_its_materials_along(added):
    red, green = (image(pixels=COLOR[..., order].copy()) for order in ([0, 1, 2], [2, 0, 1]))
    scene_desc = glowing_triangle()
    scene_desc.images = [red, green]
    scene_desc.materials = [glowing_image(1)]
    first = built(snapshot(scene_desc, None, None))
    before = picture(first.scene)
    added.clear()
    scene_desc = dataclasses.replace(scene_desc, images=[green], materials=[glowing_image(0)])
    second = built(snapshot(scene_desc, None, first))
    assert sorted(added) == ["instance", "material"]
    assert np.array_equal(picture(second.scene), before)
    first.close()
    second.close()


def test_a_file_that_cannot_be_read_is_told_each_time(tmp_path):
    path = tmp_path / "image.png"
    path.write_bytes(b"no image")
    scene_desc = glowing_triangle()
    scene_desc.images = [image(path=str(path))]
    scene_desc.materials = [glowing_image(0)]
    before = None
    for _ in range(3):
        log = ExportLog()
        made = built(snapshot(scene_desc, log, before))
        assert len(log.warnings) == 1 and "magenta" in log.warnings[0]
        assert made is not before
        assert picture(made.scene)[20, :3] == pytest.approx((1.0, 0.0, 1.0))
        if before:
            before.close()
        before = made
    before.close()


def test_a_scene_that_is_refused_leaves_the_one_before(added):
    scene_desc = glowing_triangle()
    first = built(snapshot(scene_desc, None, None))
    shown = picture(first.scene)
    broken = triangle("broken")
    broken.triangles[0, 0] = 7
    wrong = dataclasses.replace(scene_desc, meshes=[*scene_desc.meshes, broken])
    with pytest.raises(native.NativeError, match="broken"):
        snapshot(wrong, None, first)
    assert np.array_equal(picture(first.scene), shown)
    first.close()


def test_one_that_is_cancelled_keeps_the_arrays_for_the_next():
    scene_desc = glowing_triangle()
    given_up = snapshot(scene_desc, None, None)
    given_up.cancel()
    given_up.close()
    assert scene_desc.meshes[0].positions is not None
    first = built(snapshot(scene_desc, None, None))
    with upload(glowing_triangle()) as anew:
        anew.commit()
        assert np.array_equal(picture(first.scene), picture(anew))
    first.close()
