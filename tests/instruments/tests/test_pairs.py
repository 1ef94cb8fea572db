# SPDX-License-Identifier: GPL-3.0-or-later
"""Two renderers' pictures: noise is told from difference, files are read, pairs are drawn."""

import numpy as np
import OpenImageIO as oiio
import pytest

from tests.instruments.pairs import files
from tests.instruments.pairs.comparison import Tolerance, compare, noise, picture

SIZE = (64, 64)
NOISE = 0.2  # of a pixel, relative
TOLERANCE = Tolerance(block=0.02, share=0.05, light=0.05)


def renders(seed: int, factor=1.0, caustics=None, noise: float = NOISE) -> list[dict]:
    """Two noisy renders of a grey slope, times `factor`, plus `caustics`."""
    rng = np.random.default_rng(seed)
    expected = np.linspace(0.2, 1.0, SIZE[0])[:, None, None] * np.ones((*SIZE, 3)) * factor
    extra = np.zeros_like(expected) if caustics is None else caustics
    return [
        {
            "Combined": (expected + extra) * (1.0 + noise * rng.normal(size=expected.shape)),
            "Caustics": extra,
        }
        for _ in range(2)
    ]


def compared(factor=1.0, caustics=None, seed: int = 2, noise: float = NOISE):
    specula = picture(renders(seed, factor, caustics, noise))
    return compare(specula, picture(renders(1, noise=noise)), TOLERANCE)


@pytest.mark.parametrize("seed", range(2, 12))
def test_noise_is_no_difference(seed):
    found = compared(seed=seed)
    assert found.differing == 0.0
    assert not found.differs
    assert found.ratio == pytest.approx(1.0, abs=4.0 * found.ratio_error)


@pytest.mark.parametrize("factor", [0.93, 1.07])
def test_wrong_light_is_a_difference(factor):
    found = compared(factor)
    assert found.light_differs
    assert found.differs
    assert found.ratio == pytest.approx(factor, abs=4.0 * found.ratio_error)


@pytest.mark.parametrize("wrong", [0.6, 1.4])
def test_a_wrong_corner_is_a_difference(wrong):
    factor = np.ones((*SIZE, 1))
    factor[:16, :16] = wrong  # 4 blocks of 64
    found = compared(factor)
    assert found.differing == pytest.approx(4 / 64)
    assert found.differs
    assert not found.light_differs


def test_too_little_to_see_is_no_difference():
    exact = compared(1.0 + 0.5 * TOLERANCE.block, noise=0.0)
    assert exact.differing == 0.0
    assert compared(1.0 + 2.0 * TOLERANCE.block, noise=0.0).differing == 1.0


def test_caustics_that_cycles_misses_are_no_difference_and_others_are():
    spot = np.zeros((*SIZE, 3))
    spot[:32] = 0.5
    assert compared(caustics=spot).ratio > 1.1
    assert not compared(caustics=spot).differs
    # Path tracing shows light beneath it that Specula's picture has no reason to lack.
    assert compared(0.7, caustics=0.1 * spot).differs
    # Nor may it be brighter without them.
    assert compared(1.5, caustics=spot).differs


def test_values_that_are_not_finite_are_a_difference():
    broken = renders(2)
    broken[0]["Combined"][3, 4, 0] = np.nan
    found = compare(picture(broken), picture(renders(1)), TOLERANCE)
    assert found.not_finite == 1
    assert found.differs
    assert found.severity == np.inf


def test_noise_is_that_of_a_block():
    assert noise(picture(renders(1))) == pytest.approx(NOISE / np.sqrt(2 * 64), rel=0.15)


def test_more_renders_have_less_noise():
    four = [*renders(1), *renders(2)]
    assert noise(picture(four)) == pytest.approx(NOISE / np.sqrt(4 * 64), rel=0.15)


def test_an_image_file_of_blenders_is_read_bottom_row_first(tmp_path):
    path = tmp_path / "layers.exr"
    names = [f"View.{rest}" for rest in ("Caustics.X", "Combined.B", "Combined.G", "Combined.R")]
    names += ["View.Caustics.Y", "View.Caustics.Z", "View.Combined.A"]
    spec = oiio.ImageSpec(2, 3, len(names), "float")
    spec.channelnames = names
    pixels = np.arange(6 * len(names), dtype=np.float32).reshape(3, 2, len(names))
    output = oiio.ImageOutput.create(str(path))
    output.open(str(path), spec)
    output.write_image(pixels)
    output.close()
    passes = files.read(path)
    np.testing.assert_array_equal(passes["Combined"], pixels[::-1][..., [3, 2, 1]])
    np.testing.assert_array_equal(passes["Caustics"], pixels[::-1][..., [0, 4, 5]])


def test_the_difference_is_white_red_and_blue():
    expected = np.full((1, 4, 3), 0.5)
    image = expected * np.array([1.0, 4.0, 0.25, np.nan])[None, :, None]
    shown = files.difference(image, expected)[0]
    np.testing.assert_allclose(shown, [(1, 1, 1), (1, 0, 0), (0, 0, 1), (1, 0, 1)], atol=1e-6)


def test_pictures_are_written_upright_and_of_one_exposure(tmp_path):
    dark = picture(renders(1, 0.25, noise=0.0))
    bright = picture(renders(1, 1.0, noise=0.0))
    paths = files.draw(tmp_path, "scene", dark, bright)
    assert list(paths) == ["Specula", "Cycles", "difference"]
    pixels = {}
    for label, path in paths.items():
        file = oiio.ImageInput.open(str(tmp_path / path))
        pixels[label] = np.asarray(file.read_image("uint8"), float)
        file.close()
    assert pixels["Cycles"][0].mean() > 2.0 * pixels["Cycles"][-1].mean()  # bright rows on top
    assert pixels["Specula"].mean() < 0.7 * pixels["Cycles"].mean()
