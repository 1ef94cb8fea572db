# SPDX-License-Identifier: GPL-3.0-or-later
"""What a timing was taken on, and who else was busy there."""

from __future__ import annotations

import os
import resource
from dataclasses import dataclass
from pathlib import Path

BUSY_LOAD = 0.5  # load average before the start from which a warning is due
BUSY_SHARE = 0.05  # of all processors' time that other programs took meanwhile, likewise
IDLE_FIELDS = (3, 4)  # of /proc/stat: idle, iowait


def processor() -> str:
    """Model name and the number of processors that this process may use."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    siblings = Path("/sys/devices/system/cpu/cpu0/topology/thread_siblings_list")
    paired = siblings.exists() and siblings.read_text().strip().strip("0123456789") != ""
    threads = ", hardware threads that share cores" if paired else ""
    count = len(os.sched_getaffinity(0))
    return f"{names[0] if names else 'unknown processor'}, {count} processors{threads}"


def load_average() -> float:
    """Of the last minute."""
    return os.getloadavg()[0]


def peak_memory() -> int:
    """Bytes that this process has had at most."""
    return _status_bytes("VmHWM")


def resident_memory() -> int:
    """Bytes that this process has now."""
    return _status_bytes("VmRSS")


def reset_peak_memory() -> None:
    """From here on `peak_memory` forgets what was before."""
    Path("/proc/self/clear_refs").write_text("5")


def _status_bytes(field: str) -> int:
    status = Path("/proc/self/status").read_text()
    return 1024 * int(status.split(f"{field}:")[1].split()[0])


@dataclass(frozen=True)
class CpuTimes:
    """Seconds since some start: of all processors, of those busy, of this process and its ended
    children."""

    total: float
    busy: float
    own: float

    @staticmethod
    def now() -> CpuTimes:
        first = Path("/proc/stat").read_text().splitlines()[0]
        # Without the last two, guests' time, which is part of the others.
        ticks = [int(field) for field in first.split()[1:9]]
        total = sum(ticks)
        busy = total - sum(ticks[i] for i in IDLE_FIELDS)
        hertz = os.sysconf("SC_CLK_TCK")
        usages = (
            resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        )
        own = sum(usage.ru_utime + usage.ru_stime for usage in usages)
        return CpuTimes(total / hertz, busy / hertz, own)

    def others_share(self, later: CpuTimes) -> float:
        """Share of the processors' time from here to `later` that other programs took."""
        total = later.total - self.total
        others = (later.busy - self.busy) - (later.own - self.own)
        return max(0.0, others / total) if total > 0.0 else 0.0
