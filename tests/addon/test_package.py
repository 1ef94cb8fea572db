# SPDX-License-Identifier: GPL-3.0-or-later
"""What `./dev package` brings along."""

import os
import zipfile
from pathlib import Path

import pytest

from tools import bundle
from tools.common import DevError

LIBRARIES = sorted(Path(os.environ["SPECULA_LIBRARY_DIR"]).glob("libspecula-*.so"))


def test_base_libraries_are_not_brought():
    names = bundle.needed(LIBRARIES[0])
    assert {"libembree3.so.3", "libtbb.so.12"} <= set(names)
    assert not any(name.startswith(("libc.", "libm.", "libstdc++", "ld-linux")) for name in names)


def test_a_package_that_leans_on_the_machine_is_refused(tmp_path):
    archive = tmp_path / "package.zip"
    with zipfile.ZipFile(archive, "w") as content:
        for path in LIBRARIES:
            content.write(path, f"specula/lib/{path.name}")
    with pytest.raises(DevError, match=r"libspecula-.* finds lib.*\.so"):
        bundle.check(archive)


def test_a_library_that_is_not_installed_is_named(monkeypatch):
    monkeypatch.setattr(bundle, "needed", lambda library: {"libgone.so.1": None})
    with pytest.raises(DevError, match=r"libgone\.so\.1, which is not installed"):
        bundle.shared_libraries(LIBRARIES)
