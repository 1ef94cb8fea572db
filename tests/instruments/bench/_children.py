# SPDX-License-Identifier: GPL-3.0-or-later
"""The child processes that are timed, one at a time, and what the user sees meanwhile."""

from __future__ import annotations

import json
import os
import re
import resource
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from tests.instruments.bench._ratios import MeasurementError
from tools import host, venvs

HERE = Path(__file__).resolve().parent
CHILD_SECONDS = 20 * 60  # a child that hangs must not hold up a machine for ever
SHOWN_LINES = 2  # of the log of a child that failed
EXCEPTION = re.compile(r"(\w+\.)*\w+(Error|Exception)\b: ")
BAR_COLUMNS = 20
WINDOW = (1280, 720)  # pixels
DISPLAY = ("xvfb-run", "-a", "-s", "-screen 0 1280x1024x24")


@dataclass(frozen=True)
class Run:
    """What one child took, from before its start to after its end, and what it reported."""

    wall_seconds: float
    peak_memory: int  # bytes
    report: dict


@dataclass(frozen=True)
class Ended:
    """How one child ended, whatever came of it."""

    code: int | None  # exit code, -N if signal N ended it; None: it was killed at its limit
    wall_seconds: float
    cpu_seconds: float  # of all its threads
    peak_memory: int  # bytes
    report: dict | None  # None: it left none that is whole
    log: Path


def bpy_with_specula(
    script: str, job: Path, version: str = venvs.BPY_VERSION
) -> tuple[list[str], dict]:
    """Today's Blender as a module, or another version's, the addon enabled."""
    environment = host.bpy_environment(host.library_folder(), version)
    return host.bpy_command(str(HERE / script), [str(job)], version), environment


def bpy_alone(script: str, job: Path) -> tuple[list[str], dict]:
    """The same without the addon: Cycles does not pay for it."""
    environment = host.bpy_environment(host.library_folder())
    return [str(venvs.bpy_python()), str(HERE / script), str(job)], environment


def debian_blender(script: str, job: Path) -> tuple[list[str], dict]:
    """Debian's Blender, the addon enabled."""
    arguments = ["--background", "--python-exit-code", "1", "--python", str(HERE / script)]
    environment = host.blender_environment(host.library_folder())
    return host.blender_command([*arguments, "--", str(job)]), environment


def debian_window(script: str, job: Path) -> tuple[list[str], dict]:
    """The same with a window, on a display of its own; opens the job's scene if it has one."""
    scene = json.loads(job.read_text())["scene"]
    arguments = ["--window-geometry", *map(str, (0, 0, *WINDOW)), *([scene] if scene else [])]
    command = host.blender_command([*arguments, "--python", str(HERE / script), "--", str(job)])
    environment = host.blender_environment(host.library_folder())
    return [*DISPLAY, *command], environment


def luxcore(script: str, job: Path) -> tuple[list[str], dict]:
    """LuxCore's Python, which knows nothing of Blender."""
    return [str(venvs.luxcore_python()), str(HERE / script), str(job)], dict(os.environ)


HOSTS = {
    "specula in bpy": bpy_with_specula,
    "specula in bpy 4.5": partial(bpy_with_specula, version=venvs.BPY_LTS_VERSION),
    "bpy": bpy_alone,
    "debian": debian_blender,
    "debian window": debian_window,
    "luxcore": luxcore,
}


def run(
    name: str, where: str, script: str, job: dict, folder: Path, limit: float = CHILD_SECONDS
) -> Run:
    """As `execute`; raises MeasurementError if the child fails, hangs or is silent."""
    ended = execute(name, where, script, job, folder, limit)
    if ended.code != 0 or ended.report is None:
        why = "no end in time" if ended.code is None else f"exit code {ended.code}"
        words = last_words(ended.log.read_text(errors="replace"))
        raise MeasurementError(f"{name}: {why}; its last words: {words}; all of them: {ended.log}")
    return Run(ended.wall_seconds, ended.peak_memory, ended.report)


def execute(
    name: str, where: str, script: str | Path, job: dict, folder: Path, limit: float
) -> Ended:
    """Run `script` with `job` in the program `where` (of HOSTS); its log is folder/name.log.

    After `limit` seconds it is killed.
    """
    result, job_file, log = (folder / f"{name}{suffix}" for suffix in (".out", ".job", ".log"))
    result.unlink(missing_ok=True)
    job_file.write_text(json.dumps(job | {"result": str(result)}))
    command, environment = HOSTS[where](script, job_file)
    with open(log, "w") as output:
        start = time.perf_counter()
        code, usage = _wait(
            subprocess.Popen(
                command,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,  # a process group of its own, to be killed as one
            ),
            limit,
        )
        seconds = time.perf_counter() - start
    report = _report(result)
    cpu_seconds = usage.ru_utime + usage.ru_stime
    return Ended(code, seconds, cpu_seconds, 1024 * usage.ru_maxrss, report, log)


def last_words(log: str) -> str:
    """Python's exception if there is one: a renderer may go on talking after it."""
    lines = [line for line in log.splitlines() if line.strip()]
    errors = [line for line in lines if EXCEPTION.match(line)]
    return " | ".join(errors[-1:] or lines[-SHOWN_LINES:])


def _report(result: Path) -> dict | None:
    """None of a child that wrote nothing, or was killed while it wrote."""
    try:
        return json.loads(result.read_text())
    except (FileNotFoundError, json.JSONDecodeError):
        return None


def _wait(process: subprocess.Popen, limit: float) -> tuple[int | None, resource.struct_rusage]:
    """Exit code, None if it had to be killed after `limit` seconds; and what it used. Never leaves
    it behind."""
    ended = False
    descriptor = os.pidfd_open(process.pid)
    try:
        ended = bool(select.select([descriptor], [], [], limit)[0])
    finally:
        os.close(descriptor)
        if not ended:
            os.killpg(process.pid, signal.SIGKILL)
        # Not Popen's own wait, which does not tell what this one child used.
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return (process.returncode if ended else None), usage


class Progress:
    """One line for each child, with a bar and the expected end; on a terminal it changes."""

    def __init__(self, program: str, guesses: Iterable[float]):
        self._program = program
        self._left = sum(guesses)  # seconds, as guessed before the start
        self._done = 0.0
        self._start = time.monotonic()
        self._terminal = sys.stderr.isatty()

    def show(self, text: str) -> None:
        """A child starts."""
        elapsed = time.monotonic() - self._start
        left = self._left * (elapsed / self._done if self._done else 1.0)
        end = time.strftime("%H:%M", time.localtime(time.time() + left))
        full = round(BAR_COLUMNS * self._done / max(self._done + self._left, 1e-9))
        bar = "#" * full + "." * (BAR_COLUMNS - full)
        line = f"{self._program}: [{bar}] until {end}, {left / 60:.1f} min; {text}"
        sys.stderr.write(f"\r\x1b[K{line[:100]}" if self._terminal else f"{line}\n")
        sys.stderr.flush()

    def advance(self, guess: float) -> None:
        """A child with this guess has ended."""
        self._left -= guess
        self._done += guess

    def skip(self, guess: float) -> None:
        """Children with these guesses in sum will not be started."""
        self._left -= guess

    def clear(self) -> None:
        """Before something else is printed."""
        if self._terminal:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
