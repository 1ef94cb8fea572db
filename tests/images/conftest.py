# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures: references and renders, each scene in one child process, once per run."""

from __future__ import annotations

import functools

import pytest

from tests.images import _cases, _children, _reference, _statistics


def pytest_addoption(parser):
    parser.addoption(
        "--seed",
        type=int,
        default=1,
        help=f"of all renders, below {_cases.SEED_STEP}: the image tests hold for any",
    )


@pytest.fixture(scope="session")
def seed(pytestconfig) -> int:
    return pytestconfig.getoption("--seed")


@pytest.fixture(scope="session")
def rendered(tmp_path_factory, seed, reference):
    """rendered(case) -> the images of `_cases.renders`, by name, ready to be compared."""

    @functools.cache
    def render(case):
        folder = tmp_path_factory.mktemp(case.name)
        images = _children.render("blender", case, _cases.renders(case, seed), folder).images
        return {
            name: _statistics.with_rare_paths(
                _statistics.with_shared_splats(image), reference(case.name)
            )
            for name, image in images.items()
        }

    return render


@pytest.fixture(scope="session")
def reference():
    """reference(name) -> the committed reference image."""

    @functools.cache
    def read(name):
        return _reference.read(_reference.FOLDER / f"{name}.exr")

    return read
