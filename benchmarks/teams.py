"""Teams offline: what methods reach with two robots, and how often REMAC's team forms when its checker errs.

    python benchmarks/teams.py                                    the table of methods, symbolic
    python benchmarks/teams.py --physics --seeds 0:1              the same in physics, which takes long
    python benchmarks/teams.py --errors 0,0.02,0.05,0.1           REMAC by the checker's rate of errors
Every role is a rule: no language model is asked.
"""

from __future__ import annotations

from collections.abc import Sequence

from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.flags import takes
from remac_bench.playing.job_lists import make_jobs, parse_names, parse_seeds
from remac_bench.playing.worker import Work, play_job
from remac_bench.records import Record
from rich.box import SIMPLE_HEAD
from rich.table import Table

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")


@takes("teams.methods", "script.seeds", "teams.starts", "script.physics", "teams.errors")
def main(*, methods: str, seeds: str, starts: str, physics: bool, errors: str) -> None:
    """Print the table."""
    kinds = parse_names(starts, "starts")
    backend = "physics" if physics else "symbolic"
    if errors:
        rates = [float(rate) for rate in parse_names(errors, "errors")]
        show(_by_error(rates, parse_seeds(seeds), kinds, backend))
        return
    table = Table("method", "starts", *TASKS, "IPL", "FPL", "rounds", box=SIMPLE_HEAD, title=f"two robots, {backend}")
    for method in parse_names(methods, "methods"):
        for kind in kinds:
            table.add_row(method, kind, *_row(play(method, TASKS, parse_seeds(seeds), kind, backend)))
    show(table)


def play(
    method: str, tasks: Sequence[str], seeds: Sequence[int], starts: str, backend: str, **agent: str
) -> list[list[Record]]:
    """The records of each job, its iterations in order; two robots."""
    kitchen = {"backend": backend, "starts": starts}
    jobs = make_jobs(tasks=tasks, methods=[method], seeds=seeds, kitchen=kitchen, agent=agent, robots=2)
    return [list(play_job(Work(job=job, folder="."))) for job in jobs]


def _row(played: Sequence[Sequence[Record]]) -> list[str]:
    """Success by task, mean length of all first plans, and of the successes' final plans and rounds."""
    last = [records[-1] for records in played]
    won = [record for record in last if record.success]
    rates = [[record.success for record in last if record.task == task] for task in TASKS]
    return [
        *(f"{sum(rate)} of {len(rate)}" for rate in rates),
        _mean([record.initial_plan_length for record in last]),
        _mean([record.final_plan_length for record in won]),
        _mean([record.rounds for record in won]),
    ]


def _by_error(rates: Sequence[float], seeds: Sequence[int], kinds: Sequence[str], backend: str) -> Table:
    """How many jobs formed a team, in how many some iteration before the last succeeded, and how many succeeded."""
    columns = ("errors", "starts", "jobs", "succeeded before", "team formed", "success", "FPL")
    table = Table(*columns, box=SIMPLE_HEAD, title=f"REMAC, {backend}")
    for rate in rates:
        for kind in kinds:
            checker = f"noisy,false_alarm={rate:g},miss={rate:g}"
            played = play("REMAC", TASKS, seeds, kind, backend, checker=checker)
            won = [records[-1] for records in played if records[-1].success]
            counts = (
                len(played),
                sum(any(record.success for record in records[:-1]) for records in played),
                sum(any(len(record.initial_plan) > 1 for record in records) for records in played),
                len(won),
            )
            lengths = _mean([record.final_plan_length for record in won])
            table.add_row(f"{rate:.0%}", kind, *map(str, counts), lengths)
    return table


def _mean(values: Sequence[int | None]) -> str:
    known = [value for value in values if value is not None]
    return f"{sum(known) / len(known):.1f}" if known else "-"


if __name__ == "__main__":
    run_script(main)
