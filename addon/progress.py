# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a render is, in words."""

from __future__ import annotations

from .abi import RenderStage

STAGE_NAMES = {
    RenderStage.MAPS: "reading normal maps",
    RenderStage.SHEETS: "tracing light sheets",
    RenderStage.LIGHT_PATHS: "learning light paths",
    RenderStage.CAMERA_CHAINS: "finding lights in glass and metal",
    RenderStage.PROBES: "measuring noise",
}


def progress_text(progress, samples: float, wanted: int) -> str:
    """Such as "sample 12.3/64 | 0:05, 0:21 left", or the stage before the first sample.

    `samples` is the mean over the pixels: it moves while all pixels wait for the slowest. What is
    left is told once something tells.
    """
    stage = RenderStage(progress.stage)
    doing = (
        f"sample {samples:.1f}/{wanted}"
        if stage == RenderStage.SAMPLES
        else f"{STAGE_NAMES[stage]}, {progress.stage_fraction:.0%}"
    )
    text = f"{doing} | {_clock(progress.seconds)}"
    if progress.seconds_left < 0.0:
        return text
    return f"{text}, {_clock(progress.seconds_left)} left"


def _clock(seconds: float) -> str:
    """h:mm:ss, or m:ss below an hour."""
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02}:{second:02}" if hours else f"{minute}:{second:02}"
