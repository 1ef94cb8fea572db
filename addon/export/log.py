# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings of one export, each told once."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

Warnings = list[tuple[str, str]]  # owner and message


class ExportLog:
    """Collects what falls back, in the order in which it was met."""

    def __init__(self):
        self.warnings: list[str] = []
        self._told: set[tuple[str, str]] = set()
        self._records: list[Warnings] = []

    def warn(self, owner: str, message: str) -> None:
        """`owner` names the object or material (and node); a repeated message is dropped."""
        for record in self._records:
            record.append((owner, message))
        if (owner, message) not in self._told:
            self._told.add((owner, message))
            self.warnings.append(f"{owner}: {message}")

    @contextmanager
    def recording(self) -> Iterator[Warnings]:
        """Gives a list of all warnings inside the with-block, repeated ones too."""
        record: Warnings = []
        self._records.append(record)
        try:
            yield record
        finally:
            self._records.pop()

    def repeat(self, warnings: Warnings) -> None:
        for owner, message in warnings:
            self.warn(owner, message)
