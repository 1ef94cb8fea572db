# SPDX-License-Identifier: GPL-3.0-or-later
"""The render passes: one row for each, and the way from the film to Blender's render result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from .abi import Pass


@dataclass(frozen=True)
class RenderPass:
    """A pass as Blender and the core know it."""

    name: str  # in Blender
    source: Pass
    channels: str  # one letter each
    type: str  # VALUE, VECTOR or COLOR; only a colour is exposed
    is_enabled: Callable  # of a view layer


PASSES = (
    RenderPass("Combined", Pass.COMBINED, "RGBA", "COLOR", lambda layer: True),
    RenderPass("Depth", Pass.DEPTH, "Z", "VALUE", lambda layer: layer.use_pass_z),
    RenderPass("Position", Pass.POSITION, "XYZ", "VECTOR", lambda layer: layer.use_pass_position),
    RenderPass("Normal", Pass.NORMAL, "XYZ", "VECTOR", lambda layer: layer.use_pass_normal),
    RenderPass(
        "Caustics", Pass.CAUSTICS, "RGB", "COLOR", lambda layer: layer.specula.use_pass_caustics
    ),
    RenderPass(
        "Walk Success", Pass.WALK_SUCCESS, "X", "VALUE", lambda layer: layer.specula.use_pass_walks
    ),
    RenderPass(
        "Walk Trials", Pass.WALK_TRIALS, "X", "VALUE", lambda layer: layer.specula.use_pass_walks
    ),
)


def enabled(view_layer) -> list[RenderPass]:
    """The passes that a view layer delivers, Combined first."""
    return [row for row in PASSES if row.is_enabled(view_layer)]


def register_passes(engine, scene, view_layer) -> None:
    """Tells Blender, for the compositor and the file's layers, which passes will come."""
    for row in enabled(view_layer):
        engine.register_pass(scene, view_layer, row.name, len(row.channels), row.channels, row.type)


def write(session, result_layer, rows: list[RenderPass], size: tuple[int, int], exposure: float):
    """Copies passes of `session` as they stand into a layer of a render result.

    `size` is the crop's width and height. With several views each gets the same picture.
    """
    from .export.compat import write_rect

    for row in rows:
        targets = [target for target in result_layer.passes if target.name == row.name]
        if not targets:
            continue
        pixels = session.read(row.source, *size)
        if row.type == "COLOR":
            pixels[:, :3] *= exposure
        for target in targets:
            write_rect(target, pixels)
