# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings of one export, each told once."""

from __future__ import annotations


class ExportLog:
    """Collects what falls back, in the order in which it was met."""

    def __init__(self):
        self.warnings: list[str] = []
        self._told: set[tuple[str, str]] = set()

    def warn(self, owner: str, message: str) -> None:
        """`owner` names the object or material (and node); a repeated message is dropped."""
        if (owner, message) not in self._told:
            self._told.add((owner, message))
            self.warnings.append(f"{owner}: {message}")
