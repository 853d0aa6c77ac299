"""How plans of timed tasks go in physics: `python benchmarks/timed_physics.py --seeds 0:10`.

The plans are those of `timed_plans.toml`, for two robots, or with `--shortest STATES` those of the oracle for so many
robots as `--robots` says, reckoned with what commands take in physics. Each robot takes its commands in order, as soon
as it is ready and what its plan waits for has ended; one that fails is tried again, `RETRIES` times at most. How long
each took in physics is then fed into the symbolic backend, and the order in which things end there is compared.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import product
from statistics import mean
from time import process_time
from typing import Any

import typer
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.console import say
from remac_bench.flags import takes
from remac_bench.playing.job_lists import parse_names, parse_seeds
from rich.table import Table
from timed_plans import Agenda, Step, plan_of, shortest

import remac_env
from remac_env.backends.base import Backend
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.symbolic import SymbolicBackend
from remac_env.episode import max_seconds
from remac_env.events.clock import EventClock, Order
from remac_env.rules.processes import spoilt
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.start import Start
from remac_env.tasks.goals import Goal

RETRIES = 2
NEAR = 0.5
"""s by which two ends must be apart for their order to count: as long as a kitchen comes to rest."""


@dataclass
class Played:
    """How a plan went: its ends in order (s, who, what), what each command took, and what failed.

    `cut`: for how long, s, each command was under way at the end.
    """

    success: bool = False
    seconds: float = 0.0
    ends: list[tuple[float, str, str]] = field(default_factory=list)
    took: dict[Subtask, list[float]] = field(default_factory=lambda: defaultdict(list))
    cut: dict[Subtask, float] = field(default_factory=dict)

    def seconds_of(self) -> Callable[[Subtask], float]:
        """What each command takes when it is begun the next time, as it did here; what was cut lasts beyond the end."""
        left = {subtask: iter(seconds) for subtask, seconds in self.took.items()}
        cut = {subtask: seconds + 2 * NEAR for subtask, seconds in self.cut.items()}

        def seconds(subtask: Subtask) -> float:
            return next(left.get(subtask, iter(())), cut.get(subtask, subtask.row.seconds))

        return seconds

    failures: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Episode:
    """One episode in physics, beside what the table says of it."""

    task: str
    seed: int
    where: str
    planned: Played
    played: Played
    agrees: bool
    contacts: int
    near_misses: int
    cpu: float


def play(backend: Backend, start: Start, goal: Goal, steps: Sequence[Step], deadline: float) -> Played:
    """Carry a plan out under the event clock, in a backend that has been reset."""
    clock, told, agenda = EventClock(backend, start.scene, deadline=deadline), Played(), Agenda(steps)
    tries = defaultdict[str, int](int)
    at: dict[str, tuple[Step, float]] = {}
    while not clock.over:
        if goal.holds(start.scene, backend.world):
            told.success = True
            break
        if spoilt(start.scene, backend.world, goal.names()) or any(count > RETRIES for count in tries.values()):
            break
        able = agenda.able(clock.ready, clock.timeline)
        at |= {robot: (step, clock.now) for robot, step in able.items()}
        orders = {robot: Order(able[robot].subtask if robot in able else WAIT) for robot in clock.ready}
        for robot, outcome in clock.run(orders).items():
            if robot not in at:
                continue
            step, began = at.pop(robot)
            if outcome.success:
                agenda.done(robot)
                tries[robot] = 0
            elif not outcome.refused:
                tries[robot] += 1
                told.failures.append(f"{step.subtask.text}: {outcome.reason}: {outcome.detail}")
            if not outcome.refused:  # what it took until its robot was asked again, with the kitchen at rest
                told.took[step.subtask].append(round(clock.now - began, 6))
    told.seconds = clock.now
    told.cut = {step.subtask: round(clock.now - began, 6) for step, began in at.values()}
    good = [span for span in clock.timeline if span.kind in ("subtask", "process") and span.status == "success"]
    told.ends = [(span.ended, span.who, span.what) for span in good]
    return told


def episode(task: str, seed: int, robots: int = 2, states: int = 0) -> Episode | None:
    """One episode; None where the oracle finds no plan that is in time. `states`: 0 takes the data file's plan."""
    env = remac_env.parallel_env(task, robots=robots, backend="symbolic", clock="events")
    env.reset(seed=seed)
    start, goal, deadline = env.start, env.goal, max_seconds(env.worlds.spec, env.options)
    steps = shortest(start, goal, deadline, states) if states else plan_of(task, start, env.vocabulary)
    if not steps:
        return None
    by_table, physics = SymbolicBackend(), PhysicsBackend(env.worlds)
    by_table.reset(start)
    planned = play(by_table, start, goal, steps, deadline)
    began = process_time()
    physics.reset(start)
    played = play(physics, start, goal, steps, deadline)
    cpu = process_time() - began
    again = SymbolicBackend(seconds=played.seconds_of())
    again.reset(start)
    same = in_order(played.ends, play(again, start, goal, steps, deadline).ends)
    counters, where = physics.counters, f"{start.layout} {start.style}"
    return Episode(
        task, seed, where, planned, played, same, counters.robot_contacts, counters.near_misses, cpu,
    )  # fmt: skip


def in_order(ends: Sequence[tuple[float, str, str]], others: Sequence[tuple[float, str, str]]) -> bool:
    """Whether the same things have ended in the same order, but for what is `NEAR` one another or `NEAR` the end.

    In physics the goal may be reached while a command that does it is still under way.
    """
    first, then = _numbered(ends), _numbered(others)
    over = min(max(first.values(), default=0.0), max(then.values(), default=0.0)) - NEAR
    if any(first.get(one, over) < over and one not in then or then.get(one, over) < over and one not in first
           for one in (*first, *then)):
        return False
    both = first.keys() & then.keys()
    return not any(
        first[one] + NEAR < first[other] and then[other] + NEAR < then[one] for one, other in product(both, both)
    )


def _numbered(ends: Sequence[tuple[float, str, str]]) -> dict[tuple[str, str, int], float]:
    """When each has ended; what ends more than once is told apart by how often it has."""
    counts: dict[tuple[str, str], int] = defaultdict(int)
    found = {}
    for seconds, who, what in sorted(ends):
        counts[who, what] += 1
        found[who, what, counts[who, what]] = seconds
    return found


@takes("script.seeds", "script.tasks", "timed_physics.states", "timed_physics.robots")
def main(*, seeds: str, tasks: str | None, states: int, robots: int) -> None:
    """Print a table of the tasks, every failed subtask, and what each skill takes. Ctrl-C ends with what was played."""
    if robots != 2 and not states:
        raise typer.BadParameter("the data file's plans are for two robots", param_hint="--robots")
    timed = [name for name in remac_env.tasks("events") if name not in remac_env.tasks()]
    groups = dict[str, list[Episode]]()
    with suppress(KeyboardInterrupt):
        for seed, task in product(parse_seeds(seeds), parse_names(tasks, "tasks") if tasks else timed):
            done = episode(task, seed, robots, states)
            if done is None:
                say(f"{task} seed {seed}: no plan was found")
                continue
            groups.setdefault(task, []).append(done)
            for line in _lines(done):
                say(line)
    columns = ("task", "n", "by the table", "success", "first try", "s", "s by the table", "ratio", "order agrees")
    table = Table(*columns, "contacts", "near misses", "CPU s", title=f"Plans of timed tasks in physics, seeds {seeds}")
    for task, group in groups.items():
        table.add_row(task, *_row(group))
    every = [each for group in groups.values() for each in group]
    table.add_row("all", *_row(every))
    show(table, _skills(every))


def _lines(done: Episode) -> Iterator[str]:
    where = f"{done.task} seed {done.seed} {done.where}"
    yield from (f"{where}: {failure}" for failure in done.played.failures)
    if not done.planned.success:
        yield f"{where}: not done by the table after {done.planned.seconds:g} s"
    if not done.played.success:
        yield f"{where}: not done after {done.played.seconds:g} s"
    if not done.agrees:
        yield f"{where}: another order"


def _row(group: Sequence[Episode]) -> Iterator[str]:
    done = [each for each in group if each.played.success]
    yield from (str(len(group)), str(sum(each.planned.success for each in group)), str(len(done)))
    yield str(sum(not each.played.failures for each in done))
    if done:
        physics, table = mean(each.played.seconds for each in done), mean(each.planned.seconds for each in done)
        yield from (f"{physics:.1f}", f"{table:.1f}", f"{physics / table:.2f}")
    else:
        yield from ("", "", "")
    for count in ("agrees", "contacts", "near_misses"):
        yield str(sum(getattr(each, count) for each in group))
    yield f"{mean(each.cpu for each in group):.1f}"


def _skills(episodes: Sequence[Episode]) -> Table:
    """What each skill takes in physics beside the table's seconds."""
    from remac_env.rules.skills import SKILLS

    table, took = Table("skill", "n", "s in physics", "by the table", "ratio"), defaultdict[str, list[float]](list)
    for each in episodes:
        for subtask, seconds in each.played.took.items():
            took[subtask.skill] += seconds
    for skill, seconds in sorted(took.items()):
        by_table = SKILLS[skill].seconds
        cells: tuple[Any, ...] = (skill, len(seconds), f"{mean(seconds):.1f}", f"{by_table:g}")
        table.add_row(*map(str, cells), f"{mean(seconds) / by_table:.2f}")
    return table


if __name__ == "__main__":
    run_script(main)
