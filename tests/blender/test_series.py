# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that are edited, exported by what has changed, and rendered as if built from nothing."""

import os

import bpy
import numpy as np
import pytest
from _edits import Edits, make_scene
from scenes import add_mesh, add_node, new_material, surface

from specula import abi, native
from specula.export.cache import ExportCache, KeptMesh, identities
from specula.export.log import ExportLog
from specula.export.scene import export_scene
from specula.export.settings import export_settings
from specula.series import Series
from specula.upload import upload

EDITS = 1000 if "SPECULA_TEST_NIGHTLY" in os.environ else 320
SIZE = (24, 18)
MILLISECONDS = 60_000  # that a scene may take to be built
FLAT = 24 << 20  # bytes that the last two thirds of all edits may add


class Follower:
    """Takes every update of the scene, as a viewport does."""

    def __init__(self):
        self.series = Series()
        self.log = ExportLog()
        self._handlers = bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post

    def __enter__(self):
        for handlers in self._handlers:
            handlers.append(self.hear)
        return self

    def __exit__(self, *_):
        for handlers in self._handlers:
            handlers.remove(self.hear)
        self.series.close()

    def hear(self, scene, depsgraph):
        self.log = ExportLog()
        self.series.begin(depsgraph, self.log)  # while the state before may still be built

    @property
    def native_scene(self) -> native.Scene:
        return built(self.series)

    def picture(self, settings) -> np.ndarray:
        return rendered(self.native_scene, settings)


def built(series: Series) -> native.Scene:
    scene = series.built(MILLISECONDS)
    assert scene is not None
    return scene


def rendered(scene: native.Scene, settings) -> np.ndarray:
    with native.Session(scene, settings) as session:
        while session.wait(1000).state == abi.RenderState.RUNNING:
            pass
        return session.read(abi.Pass.COMBINED, *SIZE)


def from_nothing(settings) -> tuple[np.ndarray, list[str]]:
    log = ExportLog()
    with upload(export_scene(bpy.context.evaluated_depsgraph_get(), log), log) as scene:
        scene.commit()
        return rendered(scene, settings), log.warnings


def final(tmp_path) -> np.ndarray:
    """What F12 renders, bottom row first."""
    render = bpy.context.scene.render
    render.filepath = str(tmp_path / "final.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(render.filepath, check_existing=False)
    pixels = np.array(image.pixels[:], np.float32).reshape(-1, 4)
    bpy.data.images.remove(image)
    return pixels


def resident_bytes() -> int:
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.fixture
def edited_scene():
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.use_persistent_data = True
    scene.specula.method = "PT"
    make_scene()
    return scene


@pytest.mark.parametrize("with_undo", [True, False])
def test_every_edit_renders_as_if_built_from_nothing(edited_scene, tmp_path, with_undo):
    # After an undo the graph that Blender keeps may hold old materials (docs/limits.md).
    edited_scene.render.use_persistent_data = not with_undo
    edits = Edits(1, with_undo)
    settings = export_settings(edited_scene, False, bpy.context.view_layer)
    made, memory, changed, before = {}, 0, 0, None
    with Follower() as follower:
        for number in range(EDITS):
            name = edits.one()
            bpy.context.view_layer.update()
            made[name] = made.get(name, 0) + 1
            picture = follower.picture(settings)
            expected, warnings = from_nothing(settings)
            assert np.array_equal(picture, expected), f"edit {number}: {name}"
            assert follower.log.warnings == warnings, f"edit {number}: {name}"
            changed += before is None or not np.array_equal(picture, before)
            before = picture
            if number % 10 == 9:
                # The viewport animates a material that has come into use at the next frame only.
                bpy.context.scene.frame_set(bpy.context.scene.frame_current)
                picture = follower.picture(settings)
                assert np.array_equal(picture, final(tmp_path)), f"edit {number}: {name}"
            if number == EDITS // 3:
                memory = resident_bytes()
        assert resident_bytes() - memory < FLAT
    assert len(made) > 20
    assert changed > EDITS // 2, "edits do not show"


def test_what_is_kept_of_a_mesh_is_that_of_those_who_showed_it():
    """Another's may lie at the place of one that is gone."""
    first, second = add_mesh("First"), add_mesh("Second")
    bpy.context.view_layer.update()
    depsgraph, cache, log = bpy.context.evaluated_depsgraph_get(), ExportCache(), ExportLog()
    kept = KeptMesh(None, frozenset(), [], identities((first,)))
    cache.begin(depsgraph)
    cache.keep_mesh("place", kept)
    cache.end()
    bpy.context.view_layer.update()
    cache.begin(bpy.context.evaluated_depsgraph_get())
    assert cache.mesh("place", (second,), frozenset(), log) is None
    assert cache.mesh("place", (first,), frozenset(), log) is kept


@pytest.fixture
def calls(monkeypatch):
    """Kinds and names of the parts that an edited scene was given anew."""
    given = []
    add, edited = native.Scene.add, native.Scene.edited

    def recorded(self, kind, struct):
        if hasattr(self, "is_edited"):
            given.append(f"{kind} {struct.name.decode()}")
        return add(self, kind, struct)

    def noted(before):
        scene = edited(before)
        scene.is_edited = True
        return scene

    monkeypatch.setattr(native.Scene, "add", recorded)
    monkeypatch.setattr(native.Scene, "edited", noted)
    return given


def parts(calls: list[str]) -> set[str]:
    """Those of what later scenes may share."""
    return {call for call in calls if call.split()[0] in ("mesh", "image", "material")}


def test_only_what_has_changed_is_given_to_the_core(edited_scene, calls):
    material = new_material("Own")
    shader = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    obj = add_mesh("Quad", material=material)
    bpy.context.view_layer.update()
    with Follower() as follower:

        def update():
            bpy.context.view_layer.update()
            assert follower.native_scene  # built before the next edit

        obj.location.x = 0.2
        update()
        assert "mesh Quad" in calls
        calls.clear()
        obj.location.x = 0.3
        update()
        assert parts(calls) == set()
        calls.clear()
        shader.inputs[0].default_value = (1, 0, 0, 1)
        update()
        assert parts(calls) == {"material Own"}
        calls.clear()
        obj.data.vertices[0].co.x += 0.1
        obj.data.update()
        update()
        assert parts(calls) == {"mesh Quad"}
        calls.clear()
        before = follower.native_scene
        bpy.context.scene.camera.location.x += 0.1
        update()
        assert follower.native_scene is before
        assert calls == []


def test_a_failure_does_not_outlive_its_cause(edited_scene, monkeypatch):
    settings = export_settings(edited_scene, False, bpy.context.view_layer)
    series = Series()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    series.begin(depsgraph, ExportLog())
    built(series)
    ends_commit = native.Scene.ends_commit

    def fails(self, milliseconds):
        raise native.NativeError("no memory left")

    monkeypatch.setattr(native.Scene, "ends_commit", fails)
    bpy.context.scene.objects["Floor"].location.x += 1.0
    bpy.context.view_layer.update()
    series.begin(depsgraph, ExportLog())
    with pytest.raises(native.NativeError):
        series.built()
    assert series.built() is None
    monkeypatch.setattr(native.Scene, "ends_commit", ends_commit)
    series.begin(depsgraph, ExportLog())
    assert np.array_equal(rendered(built(series), settings), from_nothing(settings)[0])
    series.close()


def test_a_state_that_is_given_up_leaves_nothing_out(edited_scene):
    settings = export_settings(edited_scene, False, bpy.context.view_layer)
    series = Series()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    series.begin(depsgraph, ExportLog())
    shown = built(series)
    add_mesh("New", material=new_material("New"))
    bpy.context.view_layer.update()
    series.begin(depsgraph, ExportLog())
    series.cancel()
    assert series.built() is shown
    bpy.data.objects["New"].location.x = 0.4
    bpy.context.view_layer.update()
    series.begin(depsgraph, ExportLog())  # its mesh is none that Blender tells of again
    assert np.array_equal(rendered(built(series), settings), from_nothing(settings)[0])
    series.close()


def test_two_viewports_do_not_disturb_each_other(edited_scene):
    settings = export_settings(edited_scene, False, bpy.context.view_layer)
    edits = Edits(seed=2)
    with Follower() as first:
        edits.one()
        bpy.context.view_layer.update()
        with Follower() as second:
            for _ in range(12):
                edits.move()
                bpy.context.view_layer.update()
                edits.one()
                bpy.context.view_layer.update()
                expected, _ = from_nothing(settings)
                assert np.array_equal(first.picture(settings), expected)
                assert np.array_equal(second.picture(settings), expected)
        edits.move()
        bpy.context.view_layer.update()
        assert np.array_equal(first.picture(settings), from_nothing(settings)[0])


def test_a_file_that_is_loaded_again_is_what_it_was(edited_scene, tmp_path):
    settings = export_settings(edited_scene, False, bpy.context.view_layer)
    series = Series()
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    saved, _ = from_nothing(settings)
    mesh = bpy.data.objects["Floor"].data
    mesh.vertices[0].co.z += 3.0
    mesh.update()
    series.begin(bpy.context.evaluated_depsgraph_get(), ExportLog())
    assert not np.array_equal(rendered(built(series), settings), saved)
    bpy.ops.wm.open_mainfile(filepath=path)
    series.begin(bpy.context.evaluated_depsgraph_get(), ExportLog())
    assert np.array_equal(rendered(built(series), settings), saved)
    series.close()


def test_persistent_data_renders_an_animation_as_single_frames(edited_scene, tmp_path):
    render = bpy.context.scene.render
    for frame in (1, 4, 5, 9):
        bpy.context.scene.frame_set(frame)
        render.use_persistent_data = True
        kept = final(tmp_path)
        render.use_persistent_data = False
        assert np.array_equal(kept, final(tmp_path)), frame
