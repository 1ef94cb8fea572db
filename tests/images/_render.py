# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender (either version): renders a scene as a job says, into an .npz file.

The last argument is a JSON file, the job:
  scene           .blend file
  size            [width, height] of the frame
  light_factor    the sizes of area, point and spot lights and of suns are multiplied by it
  sun             if given, all lights become suns without a disc, of this irradiance in W/m^2,
                  that shine to the origin from where they were
  texels          the world's image is averaged over squares of so many texels
  glints          of all materials
  renders         name -> settings: `engine` CYCLES or SPECULA (the default), `samples`, `seed`,
                  `parts`; and for Specula fields of spc_render_settings, enumerators by name
  scene_arrays    whether to store what was exported as well
  result          .npz file to write

A render of Specula is taken in `parts` sessions that continue each other; one of Cycles in `parts`
renders with a seed each. The result holds for each render NAME/mean, NAME/variance (of the mean)
and, from Specula, NAME/caustics: (H, W, 3) float64, bottom row first; NAME/stats is JSON.
SCENE/... are the arrays of the exported scene.
"""

from __future__ import annotations

import dataclasses
import json
import os
import sys
import time

import bpy
import numpy as np

POLL_MILLISECONDS = 200


class Moments:
    """Mean and variance of samples that arrive in batches; arrays of one shape, float64."""

    def __init__(self):
        self.count = 0
        self.mean = self.squares = 0.0  # squares: sum of squared deviations from the mean

    def add(self, count: int, mean: np.ndarray, squares: np.ndarray | float = 0.0) -> None:
        """Adds `count` samples with this mean and this sum of squared deviations from it."""
        total = self.count + count
        delta = mean - self.mean
        self.squares = self.squares + squares + delta**2 * (self.count * count / total)
        self.mean = self.mean + delta * (count / total)
        self.count = total

    def variance_of_mean(self) -> np.ndarray:
        return self.squares / (self.count * (self.count - 1))


class Clock:
    """A line for each part that is done, with the expected end."""

    def __init__(self, name: str, parts: int):
        self._name, self._parts, self._start = name, parts, time.time()

    def seconds(self) -> float:
        return time.time() - self._start

    def show(self, done: int) -> None:
        end = time.localtime(self._start + self.seconds() * self._parts / done)
        text = f"{self._name}: {done}/{self._parts}, {self.seconds():.1f} s"
        print(f"{text}, end about {time.strftime('%H:%M:%S', end)}", flush=True)


def prepare(job: dict):
    """The job's scene, ready to render."""
    bpy.ops.wm.open_mainfile(filepath=job["scene"])
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = job["size"]
    scene.render.resolution_percentage = 100
    lamps = [obj for obj in scene.objects if obj.type == "LIGHT"]
    for light in {obj.data for obj in lamps}:
        if light.type == "AREA":
            light.size *= job.get("light_factor", 1)
            light.size_y *= job.get("light_factor", 1)
        elif light.type in ("POINT", "SPOT"):
            light.shadow_soft_size *= job.get("light_factor", 1)
        elif light.type == "SUN":
            light.angle *= job.get("light_factor", 1)
        if job.get("sun"):
            name = light.name
            light.type = "SUN"
            sun = bpy.data.lights[name]  # of another class now
            sun.energy, sun.angle = job["sun"], 0.0
    if job.get("sun"):
        for obj in lamps:
            obj.rotation_mode = "QUATERNION"
            obj.rotation_quaternion = obj.location.to_track_quat("Z", "Y")
    for material in bpy.data.materials:
        material.specula.glints = job.get("glints", "AUTO")
        material.update_tag()  # 3.4 does not see that a property of an addon has changed
    if job.get("texels", 1) > 1:
        for node in scene.world.node_tree.nodes:
            if node.type == "TEX_ENVIRONMENT":
                node.image = averaged(node.image, job["texels"])
    return scene


def averaged(image, texels: int):
    """A new image: means of `image` over squares of `texels` pixels."""
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    shape = (height // texels, texels, width // texels, texels, image.channels)
    small = pixels.reshape(shape).mean(axis=(1, 3), dtype=np.float64).astype(np.float32)
    result = bpy.data.images.new(
        f"{image.name} averaged", width // texels, height // texels, alpha=True, float_buffer=True
    )
    result.pixels.foreach_set(np.ascontiguousarray(small).ravel())
    return result


# ------------------------------------------------------------------------------------------ Specula


def render_specula(scene, job: dict) -> dict:
    """All of the job's renders with Specula, of one export; and the export if it is asked for."""
    from specula.export.log import ExportLog
    from specula.export.scene import export_scene
    from specula.export.settings import export_settings
    from specula.upload import upload

    renders = of_engine(job, "SPECULA")
    if not renders and not job.get("scene_arrays"):
        return {}
    log = ExportLog()
    exported = export_scene(bpy.context.evaluated_depsgraph_get(), log)
    arrays = {}
    if job.get("scene_arrays"):
        flatten(exported, "SCENE", arrays)
    settings = export_settings(scene)
    with upload(exported) as native_scene:
        native_scene.commit(0)
        for line in native_scene.report():
            print(line)
        for name, changes in renders.items():
            arrays |= render(native_scene, job["size"], name, changed(settings, changes), changes)
    return arrays


def changed(settings, changes: dict):
    from specula import native

    values = {key: value for key, value in changes.items() if key not in ("parts", "engine")}
    return native.changed(settings, **values)


def render(native_scene, size: list[int], name: str, settings, changes: dict) -> dict:
    """One render: its arrays and statistics."""
    from specula import native
    from specula.abi import Pass, RenderState

    parts = changes.get("parts", 1)
    samples = settings.samples // parts
    clock, moments, caustics, totals = Clock(name, parts), Moments(), Moments(), {}
    for part in range(parts):
        batch = native.changed(
            settings, first_sample=part * samples, samples=samples, passes=1 << Pass.CAUSTICS
        )
        with native.Session(native_scene, batch) as session:
            while (progress := session.wait(POLL_MILLISECONDS)).state == RenderState.RUNNING:
                pass
            if progress.samples_done != samples:
                raise RuntimeError(f"{progress.samples_done} of {samples} samples rendered")

            def read(source, session=session):
                pixels = session.read(source, *size).reshape(size[1], size[0], -1)
                return pixels[..., :3].astype(np.float64)

            spread = read(Pass.VARIANCE) * (samples * (samples - 1.0))
            moments.add(samples, read(Pass.COMBINED), spread)
            caustics.add(samples, read(Pass.CAUSTICS))
            for key, value in session.stats().items():
                if key != "struct_size":
                    add = np.maximum if key.startswith("max_") else np.add
                    totals[key] = add(totals.get(key, 0), value).tolist()
        clock.show(part + 1)
    totals["seconds"] = clock.seconds()
    return {
        f"{name}/mean": moments.mean,
        f"{name}/variance": moments.variance_of_mean(),
        f"{name}/caustics": caustics.mean,
        f"{name}/stats": json.dumps(totals),
    }


def flatten(value, path: str, arrays: dict) -> None:
    """Every leaf of an exported scene as an array, by its path; numbers as the core gets them."""
    if dataclasses.is_dataclass(value):
        for item in dataclasses.fields(value):
            flatten(getattr(value, item.name), f"{path}/{item.name}", arrays)
    elif isinstance(value, list) and value and dataclasses.is_dataclass(value[0]):
        for index, item in enumerate(value):
            flatten(item, f"{path}/{index}", arrays)
    elif isinstance(value, np.ndarray):
        arrays[path] = value
    elif isinstance(value, bytes):
        arrays[path] = np.frombuffer(value, np.uint8)
    elif isinstance(value, float) or (isinstance(value, tuple) and isinstance(value[0], float)):
        arrays[path] = np.array(value, np.float32)
    else:
        arrays[path] = np.array(repr(value))


# ------------------------------------------------------------------------------------------- Cycles


def render_cycles(scene, job: dict) -> dict:
    """The job's renders with Cycles: plain path tracing of every sample on the processor."""
    cycles, arrays = scene.cycles, {}
    scene.render.engine = "CYCLES"
    cycles.device = "CPU"
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.time_limit = cycles.blur_glossy = 0.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    # Errors of neighbouring pixels must not depend on each other.
    cycles.sampling_pattern = "TABULATED_SOBOL"
    for obj in scene.objects:  # path tracing: no manifold walk
        obj.cycles.is_caustics_caster = False
    for name, changes in of_engine(job, "CYCLES").items():
        parts = changes["parts"]
        cycles.samples = changes["samples"] // parts
        clock, moments = Clock(name, parts), Moments()
        for part in range(parts):
            cycles.seed = changes["seed"] + part
            bpy.ops.render.render()
            moments.add(1, render_result(scene, job["result"]))
            clock.show(part + 1)
        arrays[f"{name}/mean"] = moments.mean
        arrays[f"{name}/variance"] = moments.variance_of_mean()
        arrays[f"{name}/stats"] = json.dumps({"seconds": clock.seconds()})
    return arrays


def render_result(scene, result: str) -> np.ndarray:
    """Linear RGB of the last render, by way of a file: the render result has no pixels."""
    path = f"{result}.exr"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    bpy.data.images["Render Result"].save_render(path, scene=scene)
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(image.size[0] * image.size[1] * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    shape = (image.size[1], image.size[0], image.channels)
    bpy.data.images.remove(image)
    os.remove(path)
    return pixels.reshape(shape)[..., :3].astype(np.float64)


# -----------------------------------------------------------------------------------------------


def of_engine(job: dict, engine: str) -> dict:
    return {
        name: changes
        for name, changes in job["renders"].items()
        if changes.get("engine", "SPECULA") == engine
    }


def main(job: dict) -> None:
    scene = prepare(job)
    arrays = render_specula(scene, job)
    if of_engine(job, "CYCLES"):
        arrays |= render_cycles(scene, job)
    np.savez(job["result"], **arrays)


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        main(json.load(job_file))
