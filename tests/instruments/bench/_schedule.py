# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of runs, and running them: in turns, resumable, with the expected end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from tests.instruments.bench import _store
from tests.instruments.bench._children import Progress
from tests.instruments.bench._luxcore_textures import UntranslatedError
from tests.instruments.bench._machine import BUSY_SHARE
from tests.instruments.bench._methods import other_model, suited
from tests.instruments.bench._ratios import MeasurementError
from tests.instruments.bench._scenes import Scene
from tests.instruments.bench._store import Record, Task

OVERHEAD = 4.0  # s of a child beside rendering, for the expected end


def plan(
    scenes: Sequence[Scene],
    methods: Sequence[str],
    budgets: Sequence[float],
    seeds: Sequence[int],
    threads: int,
) -> list[Task]:
    """All methods take turns within a scene and budget, each time another one first: what else the
    machine does hits all of them. A seed is complete before the next one starts, so that of an
    interrupted run whole curves are there, for fewer seeds. What renders something else, or nothing
    new, is left out."""
    tasks, turn = [], 0
    for seed in seeds:
        for budget in budgets:
            for scene in scenes:
                first = turn % len(methods)
                order = [*methods[first:], *methods[:first]]
                tasks += [
                    Task(scene, name, budget, seed, threads)
                    for name in suited(order, scene)
                    if not other_model(name, scene)
                ]
                turn += 1
    return tasks


@dataclass
class Outcome:
    """Of all tasks. Texts by scene and method say why the others have no record: they failed, or
    the renderer cannot show the scene."""

    records: dict[Task, Record]
    failures: dict[tuple[str, str], str] = field(default_factory=dict)
    untranslated: dict[tuple[str, str], str] = field(default_factory=dict)


def render_all(tasks: Sequence[Task], undisturbed: bool = False) -> Outcome:
    """Renders what an earlier run has not left; and if `undisturbed`, what other programs disturbed
    then. What failed once is not tried again with another budget or seed."""
    left = {task: record for task in tasks if (record := _store.find(task))}
    most = BUSY_SHARE if undisturbed else 1.0
    outcome = Outcome({task: one for task, one in left.items() if one.others_share <= most})
    todo = [task for task in tasks if task not in outcome.records]
    progress = Progress("bench", (task.budget + OVERHEAD for task in todo))
    for number, task in enumerate(todo, 1):
        pair = (task.scene.name, task.method)
        guess = task.budget + OVERHEAD
        if pair in outcome.failures or pair in outcome.untranslated:
            progress.skip(guess)
            continue
        progress.show(f"{number}/{len(todo)} {task.scene.name} {task.method} {task.budget:g} s")
        try:
            outcome.records[task] = _store.render(task)
        except MeasurementError as error:
            outcome.failures[pair] = str(error)
        except UntranslatedError as error:
            outcome.untranslated[pair] = str(error)
        progress.advance(guess)
    progress.clear()
    return outcome
