"""How often `remac bench blame` finds a cause that was planted: `python benchmarks/planted_failures.py --seeds 20`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from remac_bench.blame.labels import LABELS, blame
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.flags import takes
from remac_bench.playing.agents import Access
from remac_bench.playing.job_lists import make_jobs
from remac_bench.playing.jobs import Job
from remac_bench.playing.shared import Shared
from remac_bench.playing.worker import Work, play_job
from remac_bench.records import Record
from rich.box import SIMPLE_HEAD
from rich.table import Table

from remac_agents.planners.oracle import OraclePlanner
from remac_env.rules.subtasks import Subtask
from remac_env.seeding import generator

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")
KINDS = ("planner", "checker", "skill", "budget")


@takes("planted_failures.seeds", "script.first_seed", "script.physics")
def main(*, seeds: int, first_seed: int, physics: bool) -> None:
    """Plant failures, label them, and print how often the label is what was planted."""
    table = Table("planted", "failures", "right", *LABELS, box=SIMPLE_HEAD)
    for kind in KINDS:
        records = (planted_in_physics if physics else planted)(kind, range(first_seed, first_seed + seeds))
        labels = [blame(record, rescuing=False).label for record in records]
        right = f"{labels.count(kind) / len(labels):.1%}" if labels else "-"
        table.add_row(kind, str(len(labels)), right, *(str(labels.count(label)) for label in LABELS))
    show(table)


class Wrong(OraclePlanner):
    """A right plan, spoilt in one of five ways that the seed picks."""

    def begin_episode(self, seed: int, iteration: int) -> None:
        """Which seed it is."""
        self._seed = seed

    def plan(self, request: Any) -> Any:
        """Rows of commands."""
        right = super().plan(request)
        steps = list(right.row(request.lead))
        chance = generator(self._seed, "planted mistakes")
        spoil = _WAYS[int(chance.integers(len(_WAYS)))]
        return {request.lead: [step.text for step in spoil(steps, int(chance.integers(1, len(steps) - 1)))]}


def _left_out(steps: list[Subtask], at: int) -> list[Subtask]:
    return steps[:at] + steps[at + 1 :]


def _broken_off(steps: list[Subtask], at: int) -> list[Subtask]:
    return steps[:at]


def _swapped(steps: list[Subtask], at: int) -> list[Subtask]:
    return [*steps[: at - 1], steps[at], steps[at - 1], *steps[at + 1 :]]


def _elsewhere(steps: list[Subtask], at: int) -> list[Subtask]:
    """The objects are put back onto the counter."""
    counter = Subtask("place to", "counter")
    return [counter if step.skill == "place to" else step for step in steps]


def _to_and_fro(steps: list[Subtask], at: int) -> list[Subtask]:
    return [*steps[:at], *([Subtask("navigate aside"), Subtask("navigate to", "counter")] * 20)]


_WAYS: tuple[Callable[[list[Subtask], int], list[Subtask]], ...] = (
    _left_out,
    _broken_off,
    _swapped,
    _elsewhere,
    _to_and_fro,
)


def failures(
    methods: str,
    seeds: range,
    *,
    kitchen: dict[str, Any] | None = None,
    tasks: tuple[str, ...] = TASKS,
    iterations: int | None = None,
    **agent: Any,
) -> list[Record]:
    """The failed scored records of these jobs, played in this process."""
    jobs: list[Job] = make_jobs(
        tasks=tasks,
        methods=methods.split(","),
        seeds=seeds,
        kitchen={"backend": "symbolic", **(kitchen or {})},
        agent=agent,
        iterations=iterations,
        access=Access(isolated=False),
    )
    shared = Shared()
    records = [record for job in jobs for record in play_job(Work(job=job, folder="."), shared)]
    return [record for record in records if record.scored and not record.success]


def planted_in_physics(kind: str, seeds: range) -> list[Record]:
    """The same in physics, of two tasks; skills fail because controllers see objects 4 cm off."""
    physics: dict[str, Any] = {"backend": "physics"}
    tasks = ("OpenCabinetPnP", "HeatOnStove")
    if kind == "planner":
        return failures("BASE", seeds, tasks=tasks, kitchen=physics)
    if kind == "checker":
        return failures("CC", seeds, tasks=tasks, kitchen=physics, checker="noisy,false_alarm=0,miss=1")
    if kind == "skill":
        noise = {**physics, "perception_noise": 0.04}
        return failures("BASE", seeds, tasks=tasks, kitchen=noise, planner="oracle")
    return failures("CC", seeds, tasks=tasks, kitchen={**physics, "max_rounds": 5})


def planted(kind: str, seeds: range) -> list[Record]:
    """Failures with one cause: planner, checker, skill or budget.

    planner: right skills and verdicts, wrong plans. checker: literal plans, which a checker that does not err always
    saves, and a checker that errs. skill: plans that are right or are mended, and skills that fail. budget: fewer
    rounds than the shortest plan has.
    """
    if kind == "planner":
        wrong = "planted_failures:Wrong"
        return failures("BASE,CC", seeds, planner=wrong) + failures(
            "BASE", seeds, kitchen={"starts": "mixed"}, planner=wrong
        )
    if kind == "checker":
        lies = ("false_alarm=0,miss=1", "false_alarm=0.3,miss=0", "false_alarm=0.15,miss=0.15")
        return [record for lie in lies for record in failures("CC", seeds, checker=f"noisy,{lie}")]
    if kind == "skill":
        return (
            failures("BASE", seeds, kitchen={"failure_rate": 0.2}, planner="oracle")
            + failures("CC", seeds, kitchen={"failure_rate": 0.7}, planner="oracle")
            + failures("CC", seeds, kitchen={"failure_rate": 0.7})
        )
    few = {"OpenCabinetPnP": 5, "OpenMicrowavePnP": 5, "DefrostInBowl": 8, "HeatOnStove": 8}
    return [
        record
        for task, most in few.items()
        for record in failures("BASE,CC", seeds, tasks=(task,), kitchen={"max_rounds": most}, planner="oracle")
        + failures("CC,REMAC", seeds, tasks=(task,), kitchen={"max_rounds": most - 2})
    ]


if __name__ == "__main__":
    run_script(main)
