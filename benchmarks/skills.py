"""How often each skill succeeds at its first try in physics: `python benchmarks/skills.py --trials 100`.

Runs the chains of skill_chains.toml over seeds. Objects on worktops stand up to 0.10 m from the middle of their slots,
at any yaw (handles within starts.HANDLE_YAW of the robot); objects behind doors anywhere where a start may put them.
With several values of --perception-noise it prints how success falls with it.
"""

from __future__ import annotations

import tomllib
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from itertools import combinations
from multiprocessing import get_context
from pathlib import Path
from statistics import mean
from typing import Any

import numpy as np
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.console import say
from remac_bench.flags import takes
from remac_bench.judging.statistics import wilson
from rich.table import Table

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.errors import SamplingError
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.robots.bodies import STANDARD
from remac_env.rules.claims import first_false
from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome
from remac_env.rules.subtasks import Subtask
from remac_env.seeding import generator
from remac_env.start import Start
from remac_env.state import WorldState, base_place
from remac_env.tasks.goals import Released
from remac_env.tasks.spec import Role, TaskSpec

SPREAD = 0.10
"""m, how far objects on worktops may stand from the middle of their slots, along and across."""

_APART = 0.05  # m of air that stays between two objects, room for a hand
_DRAWS = 1000  # of the places of all objects, until none overlap

_VERBS = ("pick up", "place", "open", "close", "turn on", "turn off", "season")
CHAINS = Path(__file__).with_name("skill_chains.toml")
ROBOT = "robot_0"


@dataclass(frozen=True)
class Trial:
    """The first try of one skill: its label and outcome; None where an earlier failure kept it from being tried."""

    label: str
    seed: int
    outcome: Outcome | None


@dataclass(frozen=True)
class _Job:
    """One chain on one seed."""

    chain: Mapping[str, Any]
    seed: int
    style: str | None
    layout: str | None
    perception_noise: float
    body: str


def run_chain(
    chain: Mapping[str, Any], seed: int, *, style: str | None, layout: str | None, perception_noise: float,
    before: Callable[[PhysicsBackend, str], None] | None = None, body: str = STANDARD,
) -> list[Trial]:
    """Run one chain on one seed; the first tries of its steps. ``before`` is called with every command that is run.

    ``body``: the name of the robot's.
    """
    worlds = TaskWorlds(_spec(chain))
    start, _ = worlds.start(
        seed, style=style, layout=layout, starts="paper", robots=(ROBOT,), perception_noise=perception_noise,
        body=body,
    )
    start = _spread(start, worlds)
    backend = PhysicsBackend(worlds)
    world, trials = backend.reset(start), []
    for text in chain["steps"]:
        subtask = worlds.vocabulary.subtask(worlds.vocabulary.encode(text))
        if not _can_be_tried(start.scene, world, subtask):
            trials.append(Trial(text, seed, None))
            continue
        label = _label(start.scene, world, subtask)
        if before is not None:
            before(backend, text)
        result = backend.run_round({ROBOT: subtask})
        trials.append(Trial(label, seed, result.outcomes[ROBOT]))
        if not result.outcomes[ROBOT].success and _can_be_tried(start.scene, result.world, subtask):
            result = backend.run_round({ROBOT: subtask})
        world = result.world
    return trials


@takes(
    *("skills.trials", "script.first_seed", "script.only", "skills.perception_noise"),
    *("style", "layout", "script.body", "script.processes"),
)
def main(
    *, trials: int, first_seed: int, only: str, perception_noise: str, style: str | None, layout: str | None, body: str,
    processes: int,
) -> None:
    """Print a table of first-try success for every skill."""
    chains = [chain for chain in tomllib.loads(CHAINS.read_text("utf-8"))["chain"] if only in chain["name"]]
    noises = [float(value) for value in perception_noise.split(",")]
    seeds = range(first_seed, first_seed + trials)
    jobs = [_Job(chain, seed, style, layout, noise, body) for noise in noises for chain in chains for seed in seeds]
    curve: dict[float, list[Trial]] = {noise: [] for noise in noises}
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        for job, part in zip(jobs, pool.map(_play, jobs), strict=True):
            curve[job.perception_noise] += part
    if len(noises) > 1:
        show(_curve(curve))
        return
    found = curve[noises[0]]
    show(_table(found))
    for trial in found:
        if trial.outcome is None:
            say(f"seed {trial.seed}: {trial.label}: not tried, what it needs was not there")
        elif not trial.outcome.success:
            say(f"seed {trial.seed}: {trial.label}: {trial.outcome.reason}: {trial.outcome.detail}")


def _play(job: _Job) -> list[Trial]:
    return run_chain(
        job.chain, job.seed, style=job.style, layout=job.layout, perception_noise=job.perception_noise, body=job.body
    )


def _spec(chain: Mapping[str, Any]) -> TaskSpec:
    """A task with the chain's objects and a goal that never ends it."""
    nouns = list(chain["objects"])
    roles = tuple(Role(noun, (noun,), at=fixture) for noun, fixture in chain["objects"].items())
    goal = Released(nouns[0])
    cells = {"styles": styles.names(), "layouts": layouts.names()}
    return TaskSpec("SkillChain", ("", "", ""), _Never(goal.name), roles, fixtures=(), **cells)


def _spread(start: Start, worlds: TaskWorlds) -> Start:
    """The start with objects on worktops anywhere within SPREAD of the middle of their slots, none too near another.

    In a kitchen so full that they find no such places, within half or a quarter of it.
    """
    layout, rng = worlds.layout_of(start), generator(start.seed, "skills", "spread")
    slots = {noun: layout.slots[state.place.where] for noun, state in start.world.objects.items()}
    open_ones = [noun for noun, slot in slots.items() if slot.kind != "cavity"]
    radius = {noun: max(worlds.categories[start.categories[noun]].size[:2]) for noun in open_ones}
    for spread in np.repeat([SPREAD, 0.5 * SPREAD, 0.25 * SPREAD], _DRAWS):
        drawn = {noun: rng.uniform(-spread, spread, 2) for noun in open_ones}
        local = {noun: drawn[noun] + slots[noun].center[:2] for noun in open_ones}
        at = {noun: np.array(layout.frame(slots[noun].fixture).point(*local[noun])) for noun in open_ones}
        if all(np.hypot(*(at[a] - at[b])) > radius[a] + radius[b] + _APART for a, b in combinations(open_ones, 2)):
            moved = {noun: replace(start.offsets[noun], dx=float(d[0]), dy=float(d[1])) for noun, d in drawn.items()}
            return replace(start, offsets={**start.offsets, **moved})
    raise SamplingError(f"seed {start.seed}: no places for {', '.join(open_ones)} that keep apart")


class _Never(Released):
    """A goal that no start fulfils."""

    def holds(self, scene: Rules, world: WorldState) -> bool:
        """Never."""
        return False


def _can_be_tried(scene: Rules, world: WorldState, subtask: Subtask) -> bool:
    return all(first_false(scene, world, ROBOT, subtask, mark) is None for mark in ("refuse", "attempt"))


def _label(scene: Rules, world: WorldState, subtask: Subtask) -> str:
    """The skill, with the object and the place that make it easy or hard."""
    if subtask.skill == "pick up":
        place = base_place(world, subtask.target)
        return f"{subtask.text} from {scene.slots[place.where].fixture}"
    if subtask.skill == "place to":
        return f"place {world.robots[ROBOT].holding} to {subtask.target}"
    return "navigate" if subtask.skill.startswith("navigate") else subtask.text


def _table(trials: list[Trial]) -> Table:
    table = Table(
        "skill", "first tries", "success", "95% interval", "mean s", "failures", title="Skills in physics"
    )
    groups: dict[str, list[Outcome]] = defaultdict(list)
    for trial in trials:
        if trial.outcome is not None:
            groups[trial.label].append(trial.outcome)
    for label, outcomes in groups.items():
        table.add_row(*_row(label, outcomes))
    return table


def _curve(curve: Mapping[float, list[Trial]]) -> Table:
    """First tries of each sort of skill that succeed, and of all that touch objects, a row a noise."""
    table = Table("noise, m", *_VERBS, "all of these", "95% interval", title="Skills under perception noise")
    for noise, trials in curve.items():
        tried = [(t.label, t.outcome.success) for t in trials if t.outcome is not None]
        sorts = {verb: [good for label, good in tried if label.startswith(verb)] for verb in _VERBS}
        every = [good for goods in sorts.values() for good in goods]
        low, high = wilson(sum(every), len(every))
        shares = (f"{sum(goods) / len(goods):.1%}" if goods else "-" for goods in (*sorts.values(), every))
        table.add_row(f"{noise:g}", *shares, f"{low:.1%} - {high:.1%} of {len(every)}")
    return table


def _row(label: str, outcomes: list[Outcome]) -> Iterator[str]:
    good = sum(outcome.success for outcome in outcomes)
    low, high = wilson(good, len(outcomes))
    reasons = Counter(str(outcome.reason) for outcome in outcomes if not outcome.success)
    yield label
    yield str(len(outcomes))
    yield f"{good} ({good / len(outcomes):.1%})"
    yield f"{low:.1%} - {high:.1%}"
    yield f"{mean(outcome.seconds for outcome in outcomes):.1f}"
    yield ", ".join(f"{reason} {count}" for reason, count in reasons.items())


if __name__ == "__main__":
    run_script(main)
