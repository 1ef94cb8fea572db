# SPDX-License-Identifier: GPL-3.0-or-later
"""What `./dev demo` compiles."""

import re

import pytest

from specula import native
from tools import build, demo, host


@pytest.fixture
def built(monkeypatch) -> list[tuple[str, str]]:
    """What would be built: (preset, target); there is something to be done."""
    calls = []
    monkeypatch.setattr(build, "steps", lambda preset, target: 75)
    monkeypatch.setattr(build, "build", lambda preset, target: calls.append((preset, target)))
    return calls


def test_the_level_is_the_one_that_the_addon_loads():
    flags = native.processor_flags(native.CPUINFO.read_text())
    assert host.instruction_level() == native.supported_levels(flags)[0]


def test_one_level_is_compiled_and_how_long_that_takes_is_told(built, monkeypatch, capsys):
    monkeypatch.setattr(host, "instruction_level", lambda: "x86-64-v2")
    monkeypatch.setattr(demo.os, "cpu_count", lambda: 2)
    demo.compile_core()
    assert built == [("release", "specula-x86-64-v2")]
    told = capsys.readouterr().err
    assert re.search(r"x86-64-v2.*75 commands, about 2 min on 2 processors", told)


def test_nothing_is_said_to_take_time_where_all_is_compiled(built, monkeypatch, capsys):
    monkeypatch.setattr(build, "steps", lambda preset, target: 0)
    demo.compile_core()
    assert " min " not in capsys.readouterr().err
