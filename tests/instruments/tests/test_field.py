# SPDX-License-Identifier: GPL-3.0-or-later
"""The pure parts of ./dev field: what is said of a child and of two pictures, and the page."""

import json
import sys

import pytest

from tests.instruments.bench import _children
from tests.instruments.bench._children import Ended
from tests.instruments.field import _measure, _page, field
from tests.instruments.field._measure import TOLERANCE, Child
from tests.instruments.pairs.comparison import Comparison

# --------------------------------------------------------------------------------------- children


@pytest.fixture
def python_host(monkeypatch):
    """Children are plain Python: script, job."""
    monkeypatch.setitem(
        _children.HOSTS, "python", lambda script, job: ([sys.executable, str(script), str(job)], {})
    )


def ended(tmp_path, text: str, limit: float = 60.0) -> Ended:
    script = tmp_path / "child.py"
    script.write_text(
        "import json, os, signal, sys, time\njob = json.load(open(sys.argv[1]))\n" + text
    )
    return _children.execute("child", "python", script, {}, tmp_path, limit)


REPORT = (
    "def tell(stage, **more): json.dump({'stage': stage, 'renders': [], 'error': None} | more,"
    " open(job['result'], 'w'))\n"
)


def test_a_child_that_stands_still_is_killed_and_told_how_far_it_came(python_host, tmp_path):
    text = REPORT + (
        "tell('render 1')\n"
        "print('Fra:1 Mem:9M | Specula: sample 0.3/32 | 0:08', flush=True)\n"
        "ballast = bytearray(b'1' * 100_000_000)\n"
        "time.sleep(600)\n"
    )
    killed = ended(tmp_path, text, limit=2.0)
    assert killed.code is None
    assert 2.0 <= killed.wall_seconds < 60.0
    assert killed.peak_memory > 100_000_000
    child = _measure.child(killed)
    assert child.outcome == _measure.STILL
    assert "render 1" in child.why
    assert "0.3 samples after 0:08" in child.why
    assert child.last_lines == []  # progress tells nothing more


def test_a_child_that_crashes_shows_its_last_lines(python_host, tmp_path):
    text = REPORT + (
        "tell('opening')\n"
        "print('\\n'.join(f'line {i}' for i in range(20)), flush=True)\n"
        "os.kill(os.getpid(), signal.SIGSEGV)\n"
    )
    child = _measure.child(ended(tmp_path, text))
    assert child.outcome == _measure.CRASHED
    assert child.why == "SIGSEGV at opening"
    assert child.last_lines[-1] == "line 19"
    assert len(child.last_lines) == _measure.SHOWN_LINES


def test_a_child_that_fails_says_why(python_host, tmp_path):
    told = REPORT + "tell('opening', error='object Cube: bad')\nsys.exit(1)\n"
    child = _measure.child(ended(tmp_path, told))
    assert (child.outcome, child.why) == (_measure.FAILED, "object Cube: bad")
    silent = _measure.child(ended(tmp_path, "raise ValueError('no such thing')\n"))
    assert silent.outcome == _measure.FAILED
    assert "ValueError: no such thing" in silent.why
    early = _measure.child(ended(tmp_path, REPORT + "tell('render 1')\n"))
    assert early.outcome == _measure.FAILED  # whatever its exit code says


def test_a_report_cut_short_is_none(python_host, tmp_path):
    assert ended(tmp_path, "open(job['result'], 'w').write('{\"stage\": ')\n").report is None


def test_processor_time_is_that_of_this_child_alone(python_host, tmp_path):
    busy = "end = time.process_time() + 1.0\nwhile time.process_time() < end: pass\n"
    assert 1.0 <= ended(tmp_path, busy).cpu_seconds < 2.0
    assert ended(tmp_path, "time.sleep(0.2)\n").cpu_seconds < 0.5


# ---------------------------------------------------------------------------------------- verdict


def child(
    outcome=_measure.WELL, warnings=(), render_seconds=5.0, first=0.5, count=2, stage="done"
) -> Child:
    row = {
        "call_seconds": render_seconds + 1.0,
        "render_seconds": render_seconds,
        "first_sample_seconds": first,
        "samples": 16.0,
        "splats": 0,
        "warnings": list(warnings),
    }
    why = "" if outcome == _measure.WELL else "no <reason>"
    return Child(outcome, why, 0, stage, 12.0, 20.0, 10**8, [row] * count, ["last <words>"], 0.25)


def compared(ratio: float) -> Comparison:
    return Comparison(ratio, 0.01, ratio, ratio, 0.0, 0.0, 0, TOLERANCE)


SAME, OTHER = compared(1.0), compared(1.5)
LIMIT = 10.0


@pytest.mark.parametrize(
    ("specula", "cycles", "comparison", "expected"),
    [
        (child(), child(), SAME, _measure.WELL),
        (child(), child(), OTHER, _measure.DIFFERS),
        (child(warnings=["material A: no"]), child(), OTHER, _measure.TOLD),
        (child(warnings=["material A: no"]), child(), SAME, _measure.WELL),
        (child(render_seconds=14.0), child(), OTHER, _measure.LATE),
        (child(render_seconds=13.0), child(), SAME, _measure.WELL),
        (child(first=None), child(), SAME, _measure.LATE),
        (child(_measure.STILL, count=1), child(), None, _measure.STILL),
        (child(_measure.CRASHED, count=0), child(), None, _measure.CRASHED),
        (child(_measure.FAILED, count=0), child(), None, _measure.FAILED),
        (child(_measure.FAILED, count=0), child(_measure.FAILED, count=0), None, _measure.NEITHER),
        (child(_measure.CRASHED, count=0), child(_measure.FAILED, count=0), None, _measure.CRASHED),
        (
            child(_measure.STILL, count=0, stage="opening"),
            child(_measure.STILL, count=0, stage="opening"),
            None,
            _measure.NEITHER,
        ),
        (
            child(_measure.STILL, count=0, stage="render 1"),
            child(_measure.STILL, count=0, stage="render 1"),
            None,
            _measure.STILL,
        ),
        (child(), child(_measure.CRASHED, count=0), None, _measure.ALONE),
        (child(), child(render_seconds=60.0), SAME, _measure.WELL),
    ],
)
def test_verdicts(specula, cycles, comparison, expected):
    assert _measure.verdict(specula, cycles, comparison, LIMIT) == expected


def test_warnings_are_counted_by_kind():
    texts = [
        "material Glass: node: Wave Texture.002 is not supported, Mix uses its own Fac",
        "material Other: Wave Texture is not supported, Principled BSDF uses its own Roughness",
        "image a.png: /far/a.png is missing, shown in magenta",
        "image b.png: /far/b.png is missing, shown in magenta",
    ]
    assert len({_measure.kind(text) for text in texts}) == 2


# --------------------------------------------------------------------------------------------- page


def scene(name: str, verdict: str, comparison=None, warnings=()) -> _page.Scene:
    return _page.Scene(name, verdict, child(warnings=warnings), child(), comparison, {})


def test_the_page_has_the_worst_first_and_counts_all(tmp_path):
    scenes = [
        scene("fine.blend", _measure.WELL, SAME),
        scene("a little.blend", _measure.DIFFERS, compared(1.1)),
        scene("much.blend", _measure.DIFFERS, OTHER, ["m A: X is bad", "m B: X is bad"]),
        scene("gone<1>.blend", _measure.CRASHED),
    ]
    text = _page.write(tmp_path, "about & more", LIMIT, scenes).read_text()
    names = ["gone&lt;1&gt;.blend", "much.blend", "a little.blend", "fine.blend"]
    assert sorted(names, key=text.index) == names
    assert "about &amp; more" in text
    document = json.loads((tmp_path / "results.json").read_text())
    assert document["scenes"][0]["blend"] == "gone<1>.blend"
    assert document["verdicts"][_measure.DIFFERS] == 2
    assert sum(document["verdicts"].values()) == len(scenes)
    assert document["warnings"] == {"X is bad": 1}  # files


def test_the_page_shows_why_and_the_last_lines(tmp_path):
    failed = _page.Scene(
        "a.blend", _measure.FAILED, child(_measure.FAILED, count=0), child(), None, {}
    )
    text = _page.render("", LIMIT, [failed])
    assert "no &lt;reason&gt;" in text
    assert "last &lt;words&gt;" in text
    assert "<td>25%</td>" in text  # what other programs took


# ------------------------------------------------------------------------------------------ program


def test_files_are_found_in_folders_each_once(tmp_path):
    (tmp_path / "deep").mkdir()
    for name in ("b.blend", "a.blend1", "deep/c.blend"):
        (tmp_path / name).touch()
    found = field.files([tmp_path, tmp_path / "deep"], None)
    assert [path.name for path in found] == ["b.blend", "c.blend"]
    assert [path.name for path in field.files([tmp_path], "deep/")] == ["c.blend"]
    with pytest.raises(field.DevError):
        field.files([tmp_path / "none"], None)


def test_one_bad_file_does_not_end_the_run(tmp_path, monkeypatch):
    for name in ("a", "b"):
        (tmp_path / f"{name}.blend").touch()

    def examine(blend, stem, options):
        if blend.stem == "a":
            raise OSError("no such pass")
        return scene(str(blend), _measure.WELL, SAME)

    out = tmp_path / "out"
    monkeypatch.setattr(field, "examine", examine)
    monkeypatch.setattr(field._program, "freeze_library", lambda _: None)
    monkeypatch.setattr(sys, "argv", ["field", str(tmp_path), "--out", str(out)])
    assert field.main() == 1
    scenes = json.loads((out / "results.json").read_text())["scenes"]
    assert [s["verdict"] for s in scenes] == [_measure.FAILED, _measure.WELL]
    assert "no such pass" in scenes[0]["specula"]["why"]
