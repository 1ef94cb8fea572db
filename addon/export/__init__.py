# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's evaluated scene to plain descriptions (`desc.SceneDesc`)."""
