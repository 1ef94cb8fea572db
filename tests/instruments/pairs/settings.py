# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: Cycles as Specula is compared with it."""

from __future__ import annotations

# What Specula has no counterpart for, and the README says so: it would show as a difference.
CYCLES_OFF = (
    "sample_clamp_direct",
    "sample_clamp_indirect",
    "light_sampling_threshold",
    "blur_glossy",
)


def plain_cycles(scene) -> None:
    """Path tracing of every sample on the processor, without manifold walks, which lose what they
    miss."""
    scene.cycles.device = "CPU"
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    for name in CYCLES_OFF:
        setattr(scene.cycles, name, 0.0)
    for obj in scene.objects:
        obj.cycles.is_caustics_caster = False
