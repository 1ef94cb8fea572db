# SPDX-License-Identifier: GPL-3.0-or-later
"""What the programs of the bench have in common: how they start, warn and end."""

from __future__ import annotations

import os
import shutil
import signal
import sys
from collections.abc import Callable

from tests.instruments.bench import _machine
from tests.instruments.bench._ratios import MeasurementError
from tools import host
from tools.common import BUILD, DevError, locked


def warn(program: str, message: str) -> None:
    print(f"{program}: warning: {message}", file=sys.stderr, flush=True)


def load_before(program: str) -> float:
    """Load average before the start; warns of what is too high."""
    load = _machine.load_average()
    if load > _machine.BUSY_LOAD:
        warn(program, f"the load average is {load:.1f}: other programs disturb the measurement")
    return load


def warn_of_others(program: str, share: float) -> None:
    """`share`: of the processors' time that other programs took meanwhile."""
    if share > _machine.BUSY_SHARE:
        warn(program, f"other programs took {share:.0%} of the processors' time meanwhile")


def split(text: str) -> list[str]:
    """Names, separated by commas, each once."""
    return list(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))


def freeze_library(program: str) -> None:
    """Children load a copy of the native library: a build meanwhile must not change what is
    measured."""
    copy = BUILD / "bench" / f"{program}-lib"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(host.library_folder(), copy)
    os.environ["SPECULA_LIBRARY_DIR"] = str(copy)


def raise_interrupt(*_: object) -> None:
    """Signal handler: SIGTERM ends the run as Ctrl-C does, so that no child stays behind."""
    raise KeyboardInterrupt


def run(main: Callable[[], int]) -> int:
    """Exit code of `main`; one program of the bench at a time: two would measure each other."""
    signal.signal(signal.SIGTERM, raise_interrupt)
    try:
        with locked(BUILD / "bench" / "bench.lock"):
            return main()
    except (DevError, MeasurementError) as error:
        print(f"dev: error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
