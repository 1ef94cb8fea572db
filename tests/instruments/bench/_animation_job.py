# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, in today's Blender with the addon: the frames of one animation.

The last argument is a JSON file, the job: `scene` (path), `motion` (of MOTIONS), `frames`, `size`,
`engine` (SPECULA or CYCLES), `seconds` for each frame or 0, `samples` (the most), `seed`,
`changing` (whether each frame has a seed of its own), `settings` (of spc_render_settings),
`pictures` (.npz to write: `combined` and, from Specula, `caustics`, (F, H, W, 3) float32, bottom
row first), `strip` (.png to write, or null) and `result` (the JSON file to write).
"""

from __future__ import annotations

import json
import math
import os
import sys

import bpy
import numpy as np

STRIP_FRAMES = 6


def turning_glass(scene, phase: float) -> None:
    scene.objects["Slab"].rotation_euler.z = 0.15 * phase


def waves(scene, phase: float) -> None:
    """Waves run through the pool's water, on top of those that it has."""
    mesh = scene.objects["Water"].data
    rest = np.array(mesh.get("rest") or positions(mesh).ravel()).reshape(-1, 3)
    mesh["rest"] = rest.ravel().tolist()
    moved = rest.copy()
    moved[:, 2] += 0.012 * np.sin(4.0 * rest[:, 0] + 1.5 * rest[:, 1] - 1.2 * phase)
    mesh.vertices.foreach_set("co", moved.ravel().astype(np.float32))
    mesh.update()


def positions(mesh) -> np.ndarray:
    values = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", values.ravel())
    return values


def moving_lamp(scene, phase: float) -> None:
    turn(scene.objects["Lamp"], 0.1 * phase)


def moving_camera(scene, phase: float) -> None:
    turn(scene.camera, 0.03 * phase)


def turn(obj, angle: float) -> None:
    """About the z axis of the world, from where the object was at first."""
    if "rest" not in obj:
        obj["rest"] = [value for row in obj.matrix_world for value in row]
    rest = np.array(obj["rest"]).reshape(4, 4)
    c, s = math.cos(angle), math.sin(angle)
    about_z = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    obj.matrix_world = (about_z @ rest).T.tolist()


MOTIONS = {motion.__name__: motion for motion in (turning_glass, waves, moving_lamp, moving_camera)}


def specula_frames(job: dict, scene):
    """Yields combined and caustics of each frame."""
    from specula import abi, native
    from specula.export.log import ExportLog
    from specula.export.scene import export_scene
    from specula.export.settings import export_settings
    from specula.upload import upload

    passes = (abi.Pass.COMBINED, abi.Pass.CAUSTICS)
    for frame in range(job["frames"]):
        MOTIONS[job["motion"]](scene, float(frame))
        scene.frame_set(frame + 1)
        settings = native.changed(
            export_settings(scene),
            passes=sum(1 << shown for shown in passes),
            samples=job["samples"],
            time_limit=job["seconds"],
            seed=seed_of(job, frame),
            **job["settings"],
        )
        depsgraph = bpy.context.evaluated_depsgraph_get()
        with upload(export_scene(depsgraph, ExportLog())) as native_scene:
            native_scene.commit()
            with native.Session(native_scene, settings) as session:
                while session.wait(200).state == abi.RenderState.RUNNING:
                    pass
                shape = (*reversed(job["size"]), -1)
                yield [session.read(p, *job["size"]).reshape(shape)[..., :3] for p in passes]


def seed_of(job: dict, frame: int) -> int:
    return job["seed"] + (frame if job["changing"] else 0)


def cycles_frames(job: dict, scene):
    """Yields combined of each frame."""
    scene.render.engine = "CYCLES"
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.samples, scene.cycles.time_limit = job["samples"], job["seconds"]
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = job["pictures"] + ".exr"
    for frame in range(job["frames"]):
        MOTIONS[job["motion"]](scene, float(frame))
        scene.frame_set(frame + 1)
        scene.cycles.seed = seed_of(job, frame)
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        pixels = np.array(image.pixels[:], np.float32).reshape(*reversed(job["size"]), -1)
        bpy.data.images.remove(image)
        yield [pixels[..., :3]]


def write_strip(path: str, frames: np.ndarray) -> None:
    """Some of the frames side by side, as a display shows them."""
    strip = np.concatenate(list(frames[:STRIP_FRAMES]), axis=1)
    height, width, _ = strip.shape
    shown = np.ones((height, width, 4), np.float32)
    shown[..., :3] = np.clip(strip, 0.0, 1.0) ** (1.0 / 2.2)
    image = bpy.data.images.new("strip", width, height)
    image.pixels.foreach_set(shown.ravel())
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()


def main(job: dict) -> None:
    bpy.ops.wm.open_mainfile(filepath=job["scene"])
    scene = bpy.context.scene
    scene.render.engine = "SPECULA"  # some of what is exported depends on the engine
    scene.render.resolution_x, scene.render.resolution_y = job["size"]
    scene.render.resolution_percentage = 100
    frames_of = specula_frames if job["engine"] == "SPECULA" else cycles_frames
    layers = [np.stack(layer) for layer in zip(*frames_of(job, scene), strict=True)]
    np.savez(job["pictures"], **dict(zip(("combined", "caustics"), layers, strict=False)))
    if job["strip"]:
        write_strip(job["strip"], layers[0])
    with open(job["result"], "w") as file:
        json.dump({"frames": len(layers[0])}, file)


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        main(json.load(job_file))
    sys.stdout.flush()
    # bpy may crash as the interpreter goes down, after the work is done.
    os._exit(0)
