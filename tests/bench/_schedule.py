# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of runs, and running them: in turns, resumable, with the expected end."""

from __future__ import annotations

from collections.abc import Sequence

from tests.bench import _store
from tests.bench._children import Progress
from tests.bench._methods import other_model
from tests.bench._ratios import MeasurementError
from tests.bench._scenes import Scene
from tests.bench._store import Record, Task

OVERHEAD = 4.0  # s of a child beside rendering, for the expected end


def plan(
    scenes: Sequence[Scene],
    methods: Sequence[str],
    budgets: Sequence[float],
    seeds: Sequence[int],
    threads: int,
) -> list[Task]:
    """All methods take turns within a scene and budget, each time another one first: what else the
    machine does hits all of them. A seed is complete before the next one starts, so that an
    interrupted run has whole curves to show. What renders something else is left out."""
    tasks, turn = [], 0
    for seed in seeds:
        for budget in budgets:
            for scene in scenes:
                first = turn % len(methods)
                order = [*methods[first:], *methods[:first]]
                tasks += [
                    Task(scene, name, budget, seed, threads)
                    for name in order
                    if not other_model(name, scene.name)
                ]
                turn += 1
    return tasks


def render_all(tasks: Sequence[Task]) -> tuple[dict[Task, Record], dict[tuple[str, str], str]]:
    """Records of all tasks that came to an end, rendered or found; and why the others did not, by
    scene and method. What failed once is not tried again with another budget or seed."""
    records = {task: record for task in tasks if (record := _store.find(task))}
    todo = [task for task in tasks if task not in records]
    failures: dict[tuple[str, str], str] = {}
    progress = Progress("bench", (task.budget + OVERHEAD for task in todo))
    for number, task in enumerate(todo, 1):
        pair = (task.scene.name, task.method)
        guess = task.budget + OVERHEAD
        if pair in failures:
            progress.skip(guess)
            continue
        progress.show(f"{number}/{len(todo)} {task.scene.name} {task.method} {task.budget:g} s")
        try:
            records[task] = _store.render(task)
        except MeasurementError as error:
            failures[pair] = str(error)
        progress.advance(guess)
    progress.clear()
    return records, failures
