# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, in LuxCore's Python: renders a scene for some seconds.

The last argument is a JSON file, the job: `description` (what _export_job.py wrote), `method` (of
METHODS), `size` ([width, height], pixels; the description's), `threads`, `seconds` (of rendering),
`seed`, `image` (.npy to write: (H, W, 3) float32, linear Rec.709, W/m^2/sr, bottom row first),
`result` (JSON file to write: `load_seconds`, `render_seconds`, `samples` per pixel, `peak_memory`
in bytes; or `untranslated` alone, why LuxCore cannot show the scene), and the `settings` that
_export_job.py reports.
"""

from __future__ import annotations

import json
import os
import sys
import time
import traceback
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[3])

import numpy as np  # noqa: E402
import pyluxcore  # noqa: E402

from tests.instruments.bench import _description, _luxcore  # noqa: E402
from tests.instruments.bench._machine import peak_memory  # noqa: E402

POLL = 0.02  # s between looks at the clock
# Specula's pixel filters that LuxCore has, too. What it splats (all of lux-bidir-*, the caustics of
# lux-light) it spreads further than the filter says: over 1.5 pixels to either side, Blender's
# default, a pixel next to an edge has 18% from beyond it in place of 12%.
FILTERS = {"BLACKMAN_HARRIS": "BLACKMANHARRIS", "BOX": "NONE"}

PATH = {"renderengine.type": "PATHCPU", "sampler.type": "SOBOL"}
# Without Russian roulette: with it LuxCore 2.11's bidirectional tracer gains light, 10% of the
# median in the Cornell box with plain walls; without, it agrees with its path tracer.
BIDIR = {"renderengine.type": "BIDIRCPU", "path.russianroulette.depth": 1000}

METHODS = {
    # Light tracing takes over what it finds better, in turns with path tracing.
    "lux-light": PATH | {"path.hybridbackforward.enable": True},
    "lux-cache": PATH | {"path.photongi.caustic.enabled": True},
    "lux-bidir-sobol": BIDIR | {"sampler.type": "SOBOL"},
    "lux-bidir-metropolis": BIDIR | {"sampler.type": "METROPOLIS"},
}

# Radii of the photon cache over the picture's width at the casters. At 5.4 m they are the 75 mm
# that LuxCore's Blender addon starts with, the 3 mm at which it stops shrinking them, and about
# what LuxCore finds itself, in some seconds, for where photons can be seen.
CAUSTIC_RADIUS, LEAST_RADIUS, VISIBILITY_RADIUS = 0.014, 0.00056, 0.022
# Photons traced at most in one pass over the scene; 100,000 stored ones end it before.
PHOTONS = 2_000_000


def configuration(job: dict, view_width: float) -> dict:
    """LuxCore's render settings, its own where nothing stands here; nothing is clamped, denoised or
    tone mapped. `view_width`: of the picture at the casters, metres."""
    bounces, (pixel_filter, width) = job["settings"]["bounces"], job["settings"]["filter"]
    if pixel_filter not in FILTERS:
        raise _luxcore.UntranslatedError(f"the pixel filter {pixel_filter}")
    return {
        **METHODS[job["method"]],
        "native.threads.count": job["threads"],
        "renderengine.seed": 1 + job["seed"],  # 0 is refused
        "film.width": job["size"][0],
        "film.height": job["size"][1],
        "film.filter.type": FILTERS[pixel_filter],
        "film.filter.width": width,
        "film.outputs.0.type": "RGB_IMAGEPIPELINE",
        "film.imagepipelines.0.0.type": "NOP",
        "path.clamping.variance.maxvalue": 0.0,
        # LuxCore counts vertices, of which there is one more than bounces.
        **{
            f"path.pathdepth.{kind}": bounces + 1
            for kind in ("total", "diffuse", "glossy", "specular")
        },
        "path.maxdepth": bounces + 1,
        "light.maxdepth": bounces + 1,
        "path.photongi.photon.maxcount": PHOTONS,
        "path.photongi.photon.maxdepth": bounces + 1,
        "path.photongi.caustic.lookup.radius": CAUSTIC_RADIUS * view_width,
        "path.photongi.caustic.updatespp.minradius": LEAST_RADIUS * view_width,
        "path.photongi.visibility.lookup.radius": VISIBILITY_RADIUS * view_width,
    }


def properties(values: dict):
    """LuxCore's object for a dictionary of numbers, texts and lists."""
    result = pyluxcore.Properties()
    for key, value in values.items():
        result.Set(pyluxcore.Property(key, value))
    return result


def build(translation):
    """The LuxCore scene."""
    scene = pyluxcore.Scene()
    for name, pixels in translation.images.items():
        height, width, channels = pixels.shape
        scene.DefineImageMap(name, pixels, 1.0, channels, width, height)
    for name, (positions, triangles, normals, uvs) in translation.meshes.items():
        scene.DefineMeshExt(
            name,
            np.ascontiguousarray(positions, np.float32),
            np.ascontiguousarray(triangles, np.uint32),
            None if normals is None else np.ascontiguousarray(normals, np.float32),
            None if uvs is None else [np.ascontiguousarray(uvs, np.float32)],
        )
    scene.Parse(properties(translation.properties))
    return scene


def render(scene, view_width: float, job: dict) -> tuple[np.ndarray, float, float]:
    """Image, seconds of rendering and samples per pixel. What a method prepares (photons) counts
    as rendering."""
    session = pyluxcore.RenderSession(
        pyluxcore.RenderConfig(properties(configuration(job, view_width)), scene)
    )
    start = time.perf_counter()
    session.Start()
    while (elapsed := time.perf_counter() - start) < job["seconds"]:
        time.sleep(min(POLL, job["seconds"] - elapsed))
    # Read before it stops: a photon pass that is under way would be waited for.
    session.UpdateStats()
    samples = session.GetStats().Get("stats.renderengine.pass").GetFloat()
    width, height = job["size"]
    pixels = np.empty(height * width * 3, np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB_IMAGEPIPELINE, pixels, 0, True)
    seconds = time.perf_counter() - start
    session.Stop()
    return pixels.reshape(height, width, 3), seconds, samples


def measure(job: dict) -> dict:
    """Renders; the report."""
    start = time.perf_counter()
    pyluxcore.Init()
    description = _description.load(job["description"])
    translation = _luxcore.translate(description)
    if job["method"] == "lux-cache" and not _luxcore.casters(description, translation):
        raise _luxcore.UntranslatedError("without casters a cache for caustics stays empty")
    scene = build(translation)
    load_seconds = time.perf_counter() - start
    pixels, seconds, samples = render(scene, _luxcore.view_width(description, translation), job)
    np.save(job["image"], pixels * np.float32(job["settings"]["exposure"]))
    return {
        "load_seconds": load_seconds,
        "render_seconds": seconds,
        "samples": samples,
        "peak_memory": peak_memory(),
    }


def main(job: dict) -> None:
    # LuxCore traces photons on all processors that it sees, whatever its settings say.
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: job["threads"]])
    try:
        report = measure(job)
    except _luxcore.UntranslatedError as error:
        report = {"untranslated": str(error)}
    with open(job["result"], "w") as file:
        json.dump(report, file)


if __name__ == "__main__":
    try:
        with open(sys.argv[-1]) as job_file:
            main(json.load(job_file))
        code = 0
    except Exception:
        traceback.print_exc()
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    # LuxCore crashes as the interpreter goes down, and would hide the code and the last words.
    os._exit(code)
