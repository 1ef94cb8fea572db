# SPDX-License-Identifier: GPL-3.0-or-later
"""The real core, found through SPECULA_LIBRARY_DIR, without Blender."""

import re
import subprocess
import time

import numpy as np
import pytest
from scenes import IDENTITY, camera, emission, glowing_triangle, triangle

from specula import abi, native
from specula.export import desc
from specula.export.log import ExportLog
from specula.upload import upload

V3_FLAGS = "fpu sse2 cx16 lahf_lm popcnt ssse3 sse4_1 sse4_2 avx avx2 fma bmi1 bmi2 f16c movbe abm"
V2_FLAGS = "fpu sse2 cx16 lahf_lm popcnt ssse3 sse4_1 sse4_2 avx"


def render(scene_desc, settings=None, passes=(abi.Pass.COMBINED,)):
    """Pass -> (H, W, C), and the render's statistics."""
    _, _, width, height = scene_desc.camera.crop
    settings = settings or native.render_settings(samples=4)
    settings.passes = sum(1 << render_pass for render_pass in passes)
    with upload(scene_desc) as scene:
        scene.commit(2)
        with native.Session(scene, settings) as session:
            while session.wait(100).state == abi.RenderState.RUNNING:
                pass
            images = {p: session.read(p, width, height).reshape(height, width, -1) for p in passes}
            return images, session.stats()


def refused(scene_desc) -> str:
    """The message with which the core refuses a scene."""
    with pytest.raises(native.NativeError) as error, upload(scene_desc) as scene:
        scene.commit(1)
    return str(error.value)


# ------------------------------------------------------------------------------------- the library


def test_processor_flags():
    text = "processor\t: 0\nflags\t\t: fpu sse2\nbugs\t\t: none\n\nflags\t\t: other\n"
    assert native.processor_flags(text) == {"fpu", "sse2"}
    assert native.processor_flags("") == set()


@pytest.mark.parametrize(("flags", "level"), [(V3_FLAGS, "v3"), (V2_FLAGS, "v2")])
def test_the_highest_level_is_picked(flags, level, tmp_path):
    for name in ("v2", "v3"):
        (tmp_path / f"libspecula-x86-64-{name}.so").touch()
    path = native.library_path(set(flags.split()), [tmp_path])
    assert path.name == f"libspecula-x86-64-{level}.so"


def test_directories_in_order(monkeypatch, tmp_path):
    monkeypatch.setenv(native.LIBRARY_DIR_VARIABLE, str(tmp_path))
    first, second = native.library_directories()
    assert first == tmp_path
    assert (second.parent.name, second.name) == ("addon", "lib")
    monkeypatch.delenv(native.LIBRARY_DIR_VARIABLE)
    assert native.library_directories() == [second]


def test_a_missing_library_says_where_it_was_looked_for(tmp_path):
    with pytest.raises(native.NativeError, match=re.escape(str(tmp_path))):
        native.library_path(set(V3_FLAGS.split()), [tmp_path])


def test_an_old_processor_is_told():
    with pytest.raises(native.NativeError, match="x86-64-v2"):
        native.library_path({"sse2"}, [])


def test_a_file_that_is_no_library(tmp_path):
    path = tmp_path / "libspecula-x86-64-v3.so"
    path.write_text("text")
    with pytest.raises(native.NativeError, match="cannot be loaded"):
        native.load(path)


def test_a_library_of_another_api_version(tmp_path):
    source, path = tmp_path / "old.c", tmp_path / "old.so"
    functions = "".join(
        f"int {name}(void) {{ return {abi.API_VERSION + 1}; }}\n" for name in abi.PROTOTYPES
    )
    source.write_text(functions)
    subprocess.run(["cc", "-shared", "-fPIC", source, "-o", path], check=True)
    with pytest.raises(native.NativeError, match=f"has API version {abi.API_VERSION + 1}"):
        native.load(path)


def test_version():
    assert re.match(r"\d+\.\d+\.\d+ ", native.version())


def test_a_build_with_openimageio_reads_image_files():
    assert native.reads_image_files()


# ------------------------------------------------------------------------------------------ renders


def test_a_glowing_triangle():
    color = (0.5, 0.25, 0.125)
    images, stats = render(glowing_triangle(color), passes=(abi.Pass.COMBINED, abi.Pass.DEPTH))
    combined = images[abi.Pass.COMBINED]
    np.testing.assert_allclose(combined, np.broadcast_to((*color, 1), combined.shape), rtol=1e-4)
    np.testing.assert_allclose(images[abi.Pass.DEPTH], 5.0, rtol=1e-4)
    assert stats["samples"] == 8 * 4 * 4
    assert stats["nan_samples"] == 0


def test_rows_come_from_the_bottom_up():
    scene = glowing_triangle()
    scene.instances[0].transform = IDENTITY.copy()
    scene.instances[0].transform[1, 3] = 10.0  # its lower edge at y = 0
    images, _ = render(scene, passes=(abi.Pass.COMBINED, abi.Pass.POSITION))
    red = images[abi.Pass.COMBINED][:, :, 0]
    assert not red[0].any()
    np.testing.assert_allclose(red[3], 0.5, rtol=1e-4)
    assert images[abi.Pass.POSITION][3, 4, 1] > 0


def test_a_crop_is_its_part_of_the_frame():
    scene = glowing_triangle()
    scene.camera = camera(8, 4, crop=(2, 1, 3, 2))
    images, _ = render(scene, passes=(abi.Pass.POSITION,))
    position = images[abi.Pass.POSITION]
    assert position.shape == (2, 3, 3)
    pixel = 10.0 / 8  # at 5 m the frame is 10 m wide
    centres = (np.arange(2, 5) + 0.5 - 4) * pixel
    np.testing.assert_allclose(position[0, :, 0], centres, atol=0.5 * pixel)


def test_scene_statistics_and_report():
    with upload(glowing_triangle()) as scene:
        scene.commit(1)
        stats = scene.stats()
        assert (stats["triangles"], stats["instances"], stats["dropped_triangles"]) == (1, 1, 0)
        assert stats["commit_seconds"] >= 0
        assert isinstance(scene.report(), list)


def test_lights_environment_images_and_uv_are_accepted():
    scene = glowing_triangle()
    uv = np.zeros((1, 3, 2), np.float32)
    tangents = np.tile(np.array([1, 0, 0, 1], np.float32), (1, 3, 1))
    normals = np.tile(np.array([0, 0, 1], np.float32), (1, 3, 1))
    scene.meshes[0].attributes = [desc.uv_layer("UVMap", uv, tangents)]
    scene.meshes[0].normals = normals
    scene.images = [
        desc.ImageDesc("bytes", pixels=np.zeros((2, 2, 4), np.uint8)),
        desc.ImageDesc("floats", pixels=np.zeros((2, 3, 3), np.float32)),
    ]
    scene.materials.append(
        desc.MaterialDesc(
            "textured",
            [
                desc.NodeDesc("Output", "output"),
                desc.NodeDesc("Diffuse", "bsdf_diffuse"),
                desc.NodeDesc("Texture", "image_texture", image=1),
                desc.NodeDesc("Normals", "normal_map", options={"uv_map": "UVMap"}),
            ],
            [
                desc.LinkDesc(1, "BSDF", 0, "Surface"),
                desc.LinkDesc(2, "Color", 1, "Color"),
                desc.LinkDesc(3, "Normal", 1, "Normal"),
            ],
        )
    )
    scene.materials.append(
        desc.MaterialDesc(
            "sky",
            [desc.NodeDesc("Output", "output"), desc.NodeDesc("Background", "background")],
            [desc.LinkDesc(1, "Background", 0, "Surface")],
        )
    )
    scene.instances[0].materials = [1]
    scene.environment = desc.EnvironmentDesc(2)
    scene.lights = [
        desc.LightDesc(kind.name, kind, IDENTITY, (1.0, 1.0, 1.0)) for kind in desc.LightType
    ]
    with upload(scene) as native_scene:
        uv = desc.AttributeKind.UV
        assert set(native_scene.material_needs(1)) == {(uv, "", False), (uv, "UVMap", True)}
        assert native_scene.material_needs(0) == []
        native_scene.commit(1)
        assert native_scene.stats()["lights"] >= 4


def test_a_time_limit_ends_the_render():
    settings = native.render_settings(samples=1 << 24, time_limit=0.3)
    start = time.monotonic()
    _, stats = render(glowing_triangle(), settings)
    assert time.monotonic() - start < 3
    assert 0 < stats["samples"] < 32 << 24


def test_cancel_stops_within_its_time():
    with upload(glowing_triangle()) as scene:
        scene.commit(1)
        with native.Session(scene, native.render_settings(samples=1 << 24)) as session:
            assert session.wait(10).state == abi.RenderState.RUNNING
            start = time.monotonic()
            session.cancel()
            while session.wait(50).state == abi.RenderState.RUNNING:
                pass
            assert time.monotonic() - start < 1.0
            assert session.wait(0).state == abi.RenderState.CANCELLED


def test_waiting_leaves_python_free():
    import threading

    ticks = []
    with upload(glowing_triangle()) as scene:
        scene.commit(1)
        with native.Session(scene, native.render_settings(samples=1 << 24)) as session:
            thread = threading.Thread(
                target=lambda: [(ticks.append(1), time.sleep(0.01)) for _ in range(10)]
            )
            thread.start()
            session.wait(500)
            assert len(ticks) == 10
            thread.join()


# ------------------------------------------------------------------------------------------- errors


def test_a_position_that_is_not_finite_names_the_mesh():
    scene = glowing_triangle()
    scene.meshes[0].name = "Broken Mesh"
    scene.meshes[0].positions[1, 2] = np.nan
    assert "Broken Mesh" in refused(scene)


def test_an_index_out_of_range_names_the_mesh():
    scene = glowing_triangle()
    scene.meshes[0].triangles[0, 2] = 3
    assert "triangle" in refused(scene)


def test_a_singular_transform_names_the_instance():
    scene = glowing_triangle()
    scene.instances[0].name = "Squashed"
    scene.instances[0].transform = np.zeros((3, 4), np.float32)
    assert "Squashed" in refused(scene)


def test_an_unknown_node_kind_names_material_and_node():
    scene = glowing_triangle()
    scene.materials[0] = emission((1, 1, 1), name="Odd Material")
    scene.materials[0].nodes[1].kind = "no_such_kind"
    message = refused(scene)
    assert "Odd Material" in message
    assert "no_such_kind" in message


def test_a_missing_camera():
    scene = glowing_triangle()
    scene.camera = None
    assert "camera" in refused(scene)


def test_settings_out_of_range():
    with upload(glowing_triangle()) as scene:
        scene.commit(1)
        with pytest.raises(native.NativeError, match="sample"):
            native.Session(scene, native.render_settings(samples=0))


def test_rendering_before_commit():
    with upload(glowing_triangle()) as scene, pytest.raises(native.NativeError, match="commit"):
        native.Session(scene, native.render_settings())


def test_a_wrong_shape_is_our_own_error():
    scene = glowing_triangle()
    scene.meshes = [triangle()]
    scene.meshes[0].normals = np.zeros((2, 3, 3), np.float32)
    with pytest.raises(ValueError, match="shape"):
        upload(scene)


def test_an_image_file_that_cannot_be_read_is_told_or_an_error(tmp_path):
    (tmp_path / "broken.png").write_text("no image")
    image = desc.ImageDesc("Broken", path=str(tmp_path / "broken.png"))
    scene = glowing_triangle()
    scene.images = [image]
    with pytest.raises(native.NativeError, match="Broken"):
        upload(scene)
    scene, log = glowing_triangle(), ExportLog()
    scene.images = [image]
    upload(scene, log).close()
    (warning,) = log.warnings
    assert "Broken" in warning and "shown in magenta" in warning


def test_memory_that_runs_out_names_what_it_was_for(monkeypatch):
    out_of_memory = abi.Status.OUT_OF_MEMORY
    scene = native.Scene()
    monkeypatch.setattr(native.library(), "spc_scene_add_mesh", lambda *_: out_of_memory)
    monkeypatch.setattr(native.library(), "spc_scene_commit", lambda *_: out_of_memory)
    with pytest.raises(native.NativeError, match=r'^mesh "Mountain": out of memory$'):
        scene.add("mesh", abi.MeshDesc(name=b"Mountain"))
    with pytest.raises(native.NativeError, match=r"^building the scene: out of memory$"):
        scene.commit()
    scene.close()


def test_bad_pixels_are_an_error_all_the_same():
    scene, log = glowing_triangle(), ExportLog()
    scene.images = [desc.ImageDesc("Empty", pixels=np.zeros((0, 4, 4), np.uint8))]
    with pytest.raises(native.NativeError, match="Empty"):
        upload(scene, log)
    assert log.warnings == []


def test_settings_are_the_cores_own_but_for_what_is_given():
    settings = native.render_settings()
    assert settings.method == abi.Method.AUTO
    changes = {"method": abi.Method.PT, "samples": 3, "filter_width": 2.0, "chain_family": b"TT"}
    changed = native.render_settings(
        method="PT", samples=3, filter_width=2.0, chain_family="TT", pixel_filter="BOX"
    )
    changes["pixel_filter"] = abi.PixelFilter.BOX
    assert native.struct_values(changed) == native.struct_values(settings) | changes
    assert native.struct_values(native.changed(changed, samples=4))["chain_family"] == b"TT"
    with pytest.raises(KeyError, match="NO_METHOD"):
        native.changed(settings, method="NO_METHOD")
    with pytest.raises(TypeError, match="no field sampels"):
        native.changed(settings, sampels=3)
