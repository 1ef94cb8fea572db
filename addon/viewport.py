# SPDX-License-Identifier: GPL-3.0-or-later
"""What the viewport shows while Specula does not render there."""

import blf
import gpu

BACKGROUND = (0.04, 0.04, 0.04, 1.0)  # linear
TEXT_COLOR = (0.9, 0.9, 0.9, 1.0)
TEXT_SIZE = 14  # points
MARGIN = 60  # pixels between text and lower edge: clear of the scene's usual middle
FONT = 0  # Blender's default


def draw_note(region, text: str) -> None:
    """Clears `region` (bpy.types.Region) to grey and writes `text` at its lower edge."""
    gpu.state.active_framebuffer_get().clear(color=BACKGROUND)
    blf.size(FONT, TEXT_SIZE)
    blf.color(FONT, *TEXT_COLOR)
    width, _ = blf.dimensions(FONT, text)
    blf.position(FONT, (region.width - width) / 2, MARGIN, 0)
    blf.draw(FONT, text)
