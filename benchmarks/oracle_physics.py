"""How often the shortest plan works in physics: `python benchmarks/oracle_physics.py --seeds 0:50`.

Each episode runs the oracle's plan; after a failed round the oracle plans again from where objects are, at most
`--replans` times. "first try" counts episodes without a failed subtask, but for what the plan foresees: that a quirk is
in the way. With `--grades 1,2` the tasks are generated ones, with `--template`, `--quirks` and `--knowledge`, and their
plans are those that they come with, of which one robot carries out nearly all; with `--together` they are the shortest
that are found for all robots at once. `--by task` groups those by grade, `--by template` by template.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import product
from multiprocessing import get_context
from time import process_time

from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.console import say
from remac_bench.flags import takes
from remac_bench.playing.job_lists import parse_names, parse_seeds
from rich.table import Table

import remac_env
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.generator import make
from remac_env.generator.making import GRADES
from remac_env.oracle import OraclePlan, solve
from remac_env.oracle.witness import witness
from remac_env.rules.rounds import transition


@dataclass(frozen=True)
class Played:
    """One episode: how it ended, its failed subtasks as text, and what it cost."""

    task: str
    robots: int
    seed: int
    layout: str
    style: str
    end: str | None
    failures: tuple[str, ...]
    rounds: int
    simulated: float
    cpu: float
    contacts: int
    near_misses: int
    template: str = ""


@dataclass(frozen=True)
class Job:
    """One episode to play. `grade`: of a generated task, which `template`, `quirks` and `knowledge` are about."""

    task: str
    robots: int
    seed: int
    layout: str | None
    starts: str
    replans: int
    grade: int | None = None
    template: str | None = None
    quirks: int = 0
    knowledge: str = "full"
    together: bool = False


STATES = 3000
"""States at which each search for a plan of all robots together gives up; then one robot does nearly all, as before."""


def play(job: Job) -> Played:
    """Run the oracle's plan of one seed."""
    env, plan = _made(job)
    robots, seed = job.robots, job.seed
    _, infos = env.reset(seed=seed)
    start = env.start
    began, failures, left = process_time(), [], job.replans
    plan = _planned(job, env) if plan is None else plan
    rounds = [] if plan is None else list(plan.rounds)
    while env.agents and rounds:
        joint = rounds.pop(0)
        _, foreseen = transition(env.start.scene, env.world, joint)
        _, _, _, _, infos = env.step({name: env.vocabulary.encode(s.text) for name, s in joint.items()})
        told = {name: info["outcome"] for name, info in infos.items()}
        failed = [
            f"{joint[n].text}: {o['reason']}: {o['detail']}"
            for n, o in told.items()
            if o["reason"] and o["reason"] != foreseen[n].reason
        ]
        failures += failed
        if failed:
            left -= 1
            plan = _planned(job, env) if left >= 0 else None
            rounds = [] if plan is None else list(plan.rounds)
    info = next(iter(infos.values()))
    env.close()
    return Played(
        job.task, robots, seed, start.layout, start.style, info["end"], tuple(failures), info["round"], info["seconds"],
        process_time() - began, info["robot_contacts"], info["near_misses"],
        str(env.worlds.spec.generated.get("template", "")),
    )  # fmt: skip


def _made(job: Job) -> tuple[KitchenParallelEnv, OraclePlan | None]:
    """The kitchen, and the plan that a generated task comes with."""
    if job.grade is None:
        return remac_env.parallel_env(job.task, robots=job.robots, starts=job.starts, layout=job.layout), None
    task = make(
        grade=job.grade, seed=job.seed, template=job.template, quirks=job.quirks, knowledge=job.knowledge,
        robots=job.robots,
    )  # fmt: skip
    return remac_env.parallel_env(task.spec, robots=job.robots), None if job.together else task.plan


def _planned(job: Job, env: KitchenParallelEnv) -> OraclePlan | None:
    kitchen = env.start.scene, env.world, env.goal
    if job.grade is None:
        return solve(*kitchen)
    found = solve(*kitchen, max_rounds=GRADES[job.grade], max_states=STATES) if job.together else None
    return found or witness(*kitchen)


@takes(
    *("script.seeds", "script.tasks", "oracle_physics.layouts", "oracle_physics.by", "oracle_physics.grades"),
    *("oracle_physics.robots", "template", "quirks", "knowledge", "oracle_physics.together", "starts"),
    *("oracle_physics.replans", "script.processes"),
)
def main(
    *, seeds: str, tasks: str | None, layouts: str | None, by: str, grades: str, robots: str, template: str | None,
    quirks: int, knowledge: str, together: bool, starts: str, replans: int, processes: int,
) -> None:  # fmt: skip
    """Print a table a task and number of robots, and every failed subtask."""
    names = remac_env.tasks() if tasks is None else parse_names(tasks, "tasks")
    places = [None] if layouts is None else parse_names(layouts, "layouts")
    counts = [int(number) for number in parse_names(robots, "robots")]
    if grades:
        jobs = [
            Job(
                f"grade {grade}", n, seed, None, starts, replans, int(grade), template or "physics", quirks, knowledge,
                together,
            )
            for grade, n, seed in product(parse_names(grades, "grades"), counts, parse_seeds(seeds))
        ]
    else:
        jobs = [Job(*cell, starts, replans) for cell in product(names, counts, parse_seeds(seeds), places)]
    groups: dict[tuple[str, int], list[Played]] = defaultdict(list)
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        for played in pool.map(play, jobs):
            groups[getattr(played, by), played.robots].append(played)
            for failure in played.failures:
                where = f"{played.task} {played.robots} seed {played.seed} {played.layout} {played.style}"
                say(f"{where} {played.end}: {failure}")
    columns = (by, "robots", "n", "success", "first try", "rounds", "sim s", "CPU s", "contacts", "near misses")
    where = layouts or "layouts of the seeds"
    kind = f"{quirks} quirks, knowledge {knowledge}" if grades else f"{where}, {starts} starts"
    table = Table(*columns, title=f"The oracle's plans in physics, {kind}, seeds {seeds}")
    for (name, robots), group in sorted(groups.items()):
        table.add_row(name, str(robots), *_row(group))
    show(table)


def _row(group: list[Played]) -> Iterator[str]:
    ends = Counter(played.end for played in group)
    clean = sum(played.end == "success" and not played.failures for played in group)

    def mean(name: str) -> float:
        return sum(getattr(played, name) for played in group) / len(group)

    yield from (str(len(group)), str(ends["success"]), str(clean))
    yield from (f"{mean(name):.1f}" for name in ("rounds", "simulated", "cpu"))
    yield from (str(sum(getattr(played, name) for played in group)) for name in ("contacts", "near_misses"))


if __name__ == "__main__":
    run_script(main)
