# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders one case by one method, and what is to be said of it."""

from __future__ import annotations

import dataclasses
import math
import time
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from specula import native
from specula.abi import Pass, RenderSettings, RenderState
from specula.upload import upload
from tests.instruments.stability._cases import BRUTE_FORCE, LIGHT_PATHS, Case
from tests.instruments.stability._scenes import SIDE

BLOCKS = 2  # along each side of the picture
BRIGHTEST = 1e-3  # share of the pixels of a picture with one sample each
FALSE_ALARMS = 1e-2  # probability that any comparison of a whole table fails though all is well
POLL_MILLISECONDS = 100


@dataclass(frozen=True)
class Method:
    name: str
    settings: dict
    samples: int = 64
    # Why it may fail; empty: it must not.
    excuse: str = ""
    needs_path_tracing: bool = False  # which finds no light without size


def settings(method, light_tracing="OFF", **more) -> dict:
    return {
        "method": method,
        "light_tracing": light_tracing,
        "pixel_filter": "BOX",
        "filter_width": 1.0,
        **more,
    }


HALF_VECTORS = "the paper's first constraint: small basins are rarely met"
TRUTHS = {
    BRUTE_FORCE: Method(BRUTE_FORCE, settings("PT"), 4096),
    LIGHT_PATHS: Method(LIGHT_PATHS, settings("LT"), 128),
}
METHODS = (
    Method("sheets + light paths", settings("SHEETS", "ON")),
    Method("sheets", settings("SHEETS")),
    Method("walks + light paths", settings("SMS_UNBIASED", "ON")),
    Method("walks", settings("SMS_UNBIASED")),
    Method("light paths", settings("LT")),
    Method(
        "half-vectors, one stage",
        settings("SMS_UNBIASED", constraint="HALF_VECTOR", two_stage=False),
        excuse=HALF_VECTORS,
    ),
    Method(
        "half-vectors, two stages",
        settings("SMS_UNBIASED", constraint="HALF_VECTOR"),
        excuse=HALF_VECTORS,
    ),
    Method("angles, one stage", settings("SMS_UNBIASED", two_stage=False)),
    Method(
        "16 walks",
        settings("SMS_BIASED", set_size=16),
        excuse="solutions that no walk meets are lost",
    ),
    # What they miss is path tracing's: it takes as many samples.
    Method("MNEE seeds", settings("MNEE"), 4096, needs_path_tracing=True),
    Method(
        "MNEE seeds alone",
        settings("MNEE_BIASED"),
        excuse="one refraction and one reflection at most, whatever there are",
        needs_path_tracing=True,
    ),
)


@dataclass
class Pictures:
    """Of one case by one method. Luminance is the mean of the channels."""

    mean: np.ndarray  # (BLOCKS^2 + 1,): of blocks, and of the whole
    variance: np.ndarray  # of `mean`
    seconds: float  # of processors for each sample of a pixel, preparations included
    brightest: float  # share of the light in the brightest pixels of one sample
    stats: dict


def block_means(picture: np.ndarray) -> np.ndarray:
    """(H, W) -> (BLOCKS^2 + 1,)."""
    size = SIDE // BLOCKS
    blocks = picture.reshape(BLOCKS, size, BLOCKS, size).mean(axis=(1, 3)).ravel()
    return np.append(blocks, picture.mean())


def render(scene: native.Scene, values: RenderSettings):
    """(H, W) means, (H, W) their variances, seconds of processors, statistics.

    Each path and each splat belongs to one pixel, so that errors of pixels are independent. The
    channels are alike: there are no colours in the scenes.
    """
    start = time.process_time()
    with native.Session(scene, values) as session:
        while (progress := session.wait(POLL_MILLISECONDS)).state == RenderState.RUNNING:
            pass
        if progress.state != RenderState.DONE:
            raise RuntimeError("the render did not come to its end")

        seconds = time.process_time() - start

        def read(source):
            pixels = session.read(source, SIDE, SIDE).reshape(SIDE, SIDE, -1)
            return pixels[..., :3].astype(np.float64).mean(axis=-1)

        return read(Pass.COMBINED), read(Pass.VARIANCE), seconds, session.stats()


def measure(case: Case, method: Method, seed: int) -> Pictures:
    samples = max(method.samples, case.least_samples)
    with upload(case.build()) as scene:
        scene.commit(0)
        values = native.render_settings(
            **method.settings,
            max_diffuse_bounces=case.diffuse_bounces,
            samples=samples,
            seed=seed,
        )
        mean, variance, seconds, stats = render(scene, values)
        single = np.sort(
            render(scene, native.changed(values, samples=1, seed=~seed & 0xFFFF))[0].ravel()
        )
    count = math.ceil(BRIGHTEST * single.size)
    total = single.sum()
    size = np.append(np.full(BLOCKS**2, (SIDE // BLOCKS) ** 2), SIDE**2)  # pixels of each
    return Pictures(
        block_means(mean),
        block_means(variance) / size,
        seconds / samples,
        float(single[-count:].sum() / total) if total > 0.0 else 0.0,
        stats,
    )


def measure_truth(case: Case) -> Pictures | np.ndarray:
    """Pictures by an independent method, or the exact picture."""
    if not isinstance(case.truth, str):
        return case.truth()
    method = TRUTHS[case.truth]
    return measure(case, dataclasses.replace(method, samples=case.samples or method.samples), 1)


@dataclass
class Comparison:
    """How far a method's blocks are from the truth's."""

    worst: float  # difference of the block that is farthest off, over what chance explains
    excess: float  # of the whole picture's light
    precision: float  # standard deviation of that


def compare(pictures: Pictures, truth: Pictures | np.ndarray, comparisons: int) -> Comparison:
    """`truth`: pictures, or the exact picture; one of so many comparisons of a table."""
    if isinstance(truth, Pictures):
        expected, variance = truth.mean, truth.variance
    else:
        expected, variance = block_means(truth), 0.0
    rounding = 1e-5 * np.abs(expected)  # of single precision
    error = np.sqrt(pictures.variance + variance + rounding**2)
    tail = -0.5 * math.expm1(math.log1p(-FALSE_ALARMS) / (comparisons * expected.size))
    limit = NormalDist().inv_cdf(1.0 - tail)
    off = np.abs(pictures.mean - expected)
    worst = np.where(off == 0.0, 0.0, off / np.maximum(error, np.finfo(np.float64).tiny)).max()
    if not expected[-1]:
        return Comparison(float(worst / limit), 0.0, 0.0)
    return Comparison(
        float(worst / limit),
        float(pictures.mean[-1] / expected[-1] - 1.0),
        float(error[-1] / expected[-1]),
    )
