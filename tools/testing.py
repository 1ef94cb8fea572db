# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev test`: every suite runs, whatever failed before it; then a summary, and one exit code.

There are three tiers. Each suite names the first one that it belongs to. The quick one leaves out
tests that are marked as slow: by Slow in their name (GoogleTest) or by `@pytest.mark.slow`.

    --quick     while working: five minutes on two cores
    (none)      before a merge: half an hour; statistics at the power that power.h gives them by day
    --nightly   hours: statistics at full power, all truths found anew, long fuzzing, parity
"""

from __future__ import annotations

import argparse
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path

from tools import host, setup
from tools.build import build
from tools.common import BUILD, PYTHON, ROOT, DevError, say

LOGS = BUILD / "test-logs"
# A suite that hangs must not hold up a machine for ever: three times what the longest takes on two
# cores, by day and by night.
SUITE_SECONDS = 40 * 60
NIGHTLY_SUITE_SECONDS = 3 * 60 * 60
# Environment variables that tests/native/support/ reads.
NIGHTLY = "SPECULA_TEST_NIGHTLY"
WRITE_TRUTHS = "SPECULA_TEST_WRITE_TRUTHS"

FUZZING_MINUTES = 30  # of each kind

CTEST_CLOSING = re.compile(r"^(\d+% tests passed, .*|No tests were found!!!)$")
PYTEST_CLOSING = re.compile(r"^=+ .* in [\d.]+s.*=+$")
LINES_OF_A_CRASH = 40  # the Python stacks of all threads, by pytest's faulthandler
PYTEST_NO_TESTS = 5


class Tier(IntEnum):
    """How much of the tests; each one has what those before it have."""

    QUICK = 0
    DAILY = 1
    NIGHTLY = 2


@dataclass(frozen=True)
class Selection:
    """Which tests of a suite run."""

    tier: Tier = Tier.DAILY
    expression: str | None = None  # of ctest -R or pytest -k


@dataclass
class Result:
    """What came of one suite."""

    name: str
    outcome: str = "failed"  # "passed", "failed" or "no test"
    # The runner's last words, or why it could not run.
    closing: list[str] = field(default_factory=list)
    seconds: float = 0.0


def suite_seconds() -> int:
    """How long a suite may take."""
    long = NIGHTLY in os.environ or WRITE_TRUTHS in os.environ
    return NIGHTLY_SUITE_SECONDS if long else SUITE_SECONDS


def run_logged(
    command: list[str], log: Path, env: Mapping[str, str] | None = None
) -> tuple[int, list[str]]:
    """Run a program in the project's root; returns (exit code, lines of its output).

    The output goes to the terminal and to `log`. After suite_seconds(), or when ./dev is
    interrupted, it is killed with all of its children.
    """
    limit = suite_seconds()
    print(f"\n--- {' '.join(command)}", flush=True)
    lines = []
    with subprocess.Popen(
        command,
        cwd=ROOT,
        env=env,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,  # a process group of its own, to be killed as one
    ) as process:

        def kill() -> None:
            os.killpg(process.pid, signal.SIGKILL)

        def give_up() -> None:
            say(f"no end after {limit} s, killing: {' '.join(command)}")
            kill()

        timer = threading.Timer(limit, give_up)
        timer.start()
        try:
            with open(log, "w") as file:
                for line in process.stdout:
                    lines.append(line.rstrip("\n"))
                    file.write(line)
                    sys.stdout.write(line)
                    sys.stdout.flush()
            process.wait()
        except BaseException:
            kill()
            raise
        finally:
            timer.cancel()
    return process.returncode, lines


def run_ctest(preset: str, log: Path, selection: Selection) -> Result:
    """The native tests of one preset."""
    build(preset)
    command = ["ctest", "--preset", preset, "--parallel", str(os.cpu_count() or 1)]
    if selection.tier == Tier.QUICK:
        command += ["-LE", "slow"]
    if selection.expression:
        command += ["-R", selection.expression, "--no-tests=ignore"]
    code, lines = run_logged(command, log)
    closing = [line for line in lines if CTEST_CLOSING.match(line)]
    ran = bool(closing) and not closing[-1].startswith("No tests")
    if code == 0 and not ran:
        return Result(preset, "no test", closing)
    return Result(
        preset, "passed" if code == 0 else "failed", closing or [f"ctest: exit code {code}"]
    )


def run_pytest(
    folder: str, log: Path, selection: Selection, runner: list[str], env: Mapping[str, str]
) -> Result:
    """The tests in `folder`; `runner` is the command line before pytest's arguments."""
    if not (ROOT / folder).is_dir():
        raise DevError(f"there is no folder {folder}")
    command = [*runner, folder]
    if selection.tier == Tier.QUICK:
        command += ["-m", "not slow"]
    if selection.expression:
        command += ["-k", selection.expression]
    code, lines = run_logged(command, log, env)
    closing = [line for line in lines if PYTEST_CLOSING.match(line)][-1:]
    if not closing:  # it died before its last words, whatever the exit code says
        died = f"pytest did not come to its end: exit code {code}; its last lines:"
        return Result(folder, "failed", [died, *lines[-LINES_OF_A_CRASH:]])
    if code == PYTEST_NO_TESTS and selection.expression:
        return Result(folder, "no test", closing)
    return Result(folder, "passed" if code == 0 else "failed", closing)


def run_native(log: Path, selection: Selection) -> Result:
    """GoogleTest with asserts on."""
    return run_ctest("dev", log, selection)


def run_asan(log: Path, selection: Selection) -> Result:
    """GoogleTest under the sanitizers, without the slow tests."""
    return run_ctest("asan", log, selection)


def run_tsan(log: Path, selection: Selection) -> Result:
    """GoogleTest of what runs threads, under the thread sanitizer."""
    return run_ctest("tsan", log, selection)


def run_fuzz(log: Path, selection: Selection) -> Result:
    """Random scenes, mutated through the C interface and rendered by every method."""
    result = Result("fuzz", "passed")
    for kind in ([], ["--scenes"]):
        command = [str(ROOT / "dev"), "fuzz", *kind, "--minutes", str(FUZZING_MINUTES)]
        code, lines = run_logged(command, log.with_stem("_".join(["fuzz", *kind])))
        if code != 0:
            result.outcome = "failed"
            result.closing += lines[-1:]
    return result


def run_parity(log: Path, selection: Selection) -> Result:
    """Every node, closure, lamp and setting beside Cycles."""
    code, lines = run_logged([str(ROOT / "dev"), "parity"], log)
    return Result("parity", "passed" if code == 0 else "failed", lines[-2:])


def addon_environment() -> dict[str, str]:
    """Environment of a Python without Blender in which `import specula` finds addon/."""
    env = dict(os.environ)
    env["PYTHONPATH"] = str(host.scripts_folder(BUILD / "python") / "addons")
    env["SPECULA_LIBRARY_DIR"] = str(host.library_folder(quiet=False))
    return env


def run_without_blender(folder: str, log: Path, selection: Selection) -> Result:
    """Tests in Debian's Python."""
    return run_pytest(folder, log, selection, [PYTHON, "-m", "pytest"], addon_environment())


def run_addon(log: Path, selection: Selection) -> Result:
    """What of the addon works without Blender."""
    return run_without_blender("tests/addon", log, selection)


def blender_runner() -> list[str]:
    """Debian's Blender as a runner of pytest."""
    script = str(host.TOOLS / "pytest_in_blender.py")
    arguments = ["--background", "--python-exit-code", "1", "--python", script, "--"]
    return host.blender_command(arguments)


def run_blender(log: Path, selection: Selection) -> Result:
    """The addon inside Debian's Blender."""
    env = host.blender_environment(host.library_folder(quiet=False))
    return run_pytest("tests/blender", log, selection, blender_runner(), env)


def run_bpy(log: Path, selection: Selection) -> Result:
    """The addon inside today's Blender."""
    runner = host.bpy_command(str(host.TOOLS / "pytest_in_blender.py"), [])
    env = host.bpy_environment(host.library_folder(quiet=False))
    return run_pytest("tests/blender", log, selection, runner, env)


def run_images(log: Path, selection: Selection) -> Result:
    """Renders against reference images."""
    return run_without_blender("tests/images", log, selection)


def run_instruments(log: Path, selection: Selection) -> Result:
    """The programs that measure."""
    return run_without_blender("tests/instruments", log, selection)


@dataclass(frozen=True)
class Suite:
    """A row of the table of all tests."""

    run: Callable[[Path, Selection], Result]
    first: Tier  # the quickest that runs it


SUITES = {
    "native": Suite(run_native, Tier.QUICK),
    "asan": Suite(run_asan, Tier.DAILY),
    "tsan": Suite(run_tsan, Tier.DAILY),
    "addon": Suite(run_addon, Tier.QUICK),
    "blender": Suite(run_blender, Tier.QUICK),
    "bpy": Suite(run_bpy, Tier.DAILY),
    "images": Suite(run_images, Tier.DAILY),
    "instruments": Suite(run_instruments, Tier.QUICK),
    "fuzz": Suite(run_fuzz, Tier.NIGHTLY),
    "parity": Suite(run_parity, Tier.NIGHTLY),
}


def run_suite(name: str, selection: Selection) -> Result:
    """Run one suite; whatever keeps it from running is a failed result."""
    run = SUITES[name].run
    print(f"\n=== suite {name}: {run.__doc__}", flush=True)
    start = time.monotonic()
    try:
        result = run(LOGS / f"{name}.log", selection)
    except DevError as error:
        print(f"dev: error: {error}", flush=True)
        result = Result(name, "failed", [str(error)])
    result.name = name
    result.seconds = time.monotonic() - start
    return result


def report(results: list[Result]) -> bool:
    """Print the summary, each runner's closing lines unchanged; returns whether all is well."""
    print("\n--- summary; logs are in build/test-logs/")
    for result in results:
        print(f"{result.name} ({result.seconds:.0f} s): {result.outcome}")
        for line in result.closing:
            print(line)
    failed = [result.name for result in results if result.outcome == "failed"]
    if failed:
        print(f"failed: {' '.join(failed)}")
    elif all(result.outcome == "no test" for result in results):
        print("failed: no test ran")
        return False
    return not failed


def raise_interrupt(*_: object) -> None:
    """Signal handler: SIGTERM ends the suite as Ctrl-C does, so that no child stays behind."""
    raise KeyboardInterrupt


def main(argv: list[str]) -> int:
    """Entry of `./dev test`."""
    parser = argparse.ArgumentParser(
        prog="./dev test", description="Run the tests of a tier, or of some suites."
    )
    parser.add_argument("suites", nargs="*", metavar="SUITE", help=" ".join(SUITES))
    parser.add_argument(
        "-k",
        metavar="EXPRESSION",
        help="only tests that match (pytest -k, ctest -R; of quick native tests whole suites)",
    )
    tier = parser.add_mutually_exclusive_group()
    tier.add_argument(
        "--quick",
        dest="tier",
        action="store_const",
        const=Tier.QUICK,
        default=Tier.DAILY,
        help="without the tests that are marked as slow (minutes)",
    )
    tier.add_argument(
        "--nightly",
        dest="tier",
        action="store_const",
        const=Tier.NIGHTLY,
        help="statistics at full power, all truths found anew, and long fuzzing (hours)",
    )
    parser.add_argument(
        "--write-truths",
        action="store_true",
        help="keep in tests/native/truths/ what brute force finds for the tests that run",
    )
    args = parser.parse_args(argv)
    for name in args.suites:
        if name not in SUITES:
            parser.error(f"no suite '{name}'; there are: {' '.join(SUITES)}")
    names = [
        name
        for name, suite in SUITES.items()
        if (name in args.suites if args.suites else suite.first <= args.tier)
    ]

    for name, wished in ((NIGHTLY, args.tier == Tier.NIGHTLY), (WRITE_TRUTHS, args.write_truths)):
        if wished:
            os.environ[name] = "1"
    signal.signal(signal.SIGTERM, raise_interrupt)
    setup.ensure(*(f"test {name}" for name in names))
    LOGS.mkdir(parents=True, exist_ok=True)
    selection = Selection(args.tier, args.k)
    return 0 if report([run_suite(name, selection) for name in names]) else 1
