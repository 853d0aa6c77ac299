"""Prints tables that need no physics, for docs and README: `python benchmarks/offline_tables.py NAME`."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from remac_bench.command import run_script
from remac_bench.flags import takes
from remac_bench.judging.published import published
from remac_bench.metrics import Row, overall, summarise
from remac_bench.plans.ask import Cell, kitchen, optimum
from remac_bench.playing.extensions import load_extensions
from remac_bench.playing.job_lists import make_jobs
from remac_bench.playing.runner import Settings, run_jobs
from remac_bench.store import Store

from remac_env.errors import check_choice

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")
FLOORS = ("reader", "memorised", "random")
OUTSIDERS = Path(__file__).resolve().parents[1] / "tests" / "agents" / "outsiders_registered.py"


@takes("offline_tables.seeds")
def main(
    name: Annotated[str, typer.Argument(help="Which table: tasks, mixed, floors, methods, noisy, paper or outsiders.")],
    *,
    seeds: int | None,
) -> None:
    """Print one table in Markdown."""
    check_choice("table", name, TABLES)
    made = TABLES[name]
    made() if seeds is None else made(seeds)


def tasks(seeds: int = 1) -> None:
    """The paper's tasks: goal sentence, and the shortest plans of paper starts by exact search."""
    rows = []
    for task in TASKS:
        env = kitchen(Cell(task=task))
        _, infos = env.reset(seed=0)
        goal = next(iter(infos.values()))["goal"]
        rows.append([task, goal, *(str(optimum(Cell(task=task, robots=robots))) for robots in (1, 2))])
    _print(["task", "the goal sentence", "shortest plan, one robot", "two robots"], rows, words=2)


def mixed(seeds: int = 50) -> None:
    """Mixed starts with offline roles: success and plan lengths by task."""
    methods = ("BASE", "CC", "RE", "REMAC")
    rows = _rows(methods, seeds=seeds, starts="mixed")
    lines = []
    for task in TASKS:
        base, cc, re, remac = (rows[task, method] for method in methods)
        told = [f"{_rate(cc)}, {_mean(cc.fpl)}", f"{_rate(re)}, {_mean(re.ipl)}", f"{_rate(remac)}, {_mean(remac.ipl)}"]
        lines.append([task, _rate(base), *told])
    _print(["task", "BASE", "CC: success, FPL", "RE: success, IPL", "REMAC: success, IPL"], lines)


def floors(seeds: int = 50) -> None:
    """What reads the goal, what knows plans by heart and what rolls dice, beside BASE: success by task and starts."""
    lines = []
    for starts in ("paper", "mixed"):
        for planner in (None, *FLOORS):
            rows = _rows(("BASE",), seeds=seeds, starts=starts, agent={} if planner is None else {"planner": planner})
            name = planner or "literal (BASE)"
            problems = sum(rows[task, "BASE"].problems for task in TASKS)
            lines.append([starts, name, *(_rate(rows[task, "BASE"]) for task in TASKS), str(problems)])
    _print(["starts", "planner", *TASKS, "problems"], lines, words=2)


def methods(seeds: int = 50) -> None:
    """Every method: success on paper and mixed starts, and rounds of the final plan."""
    names = ("BASE", "CC", "RE", "REMAC", "SMART-LLM", "REFLECT", "REFLECT+CC", "CAPE", "BASE-BEST", "CC-BEST")
    paper, other = (_rows(names, seeds=seeds, starts=starts) for starts in ("paper", "mixed"))
    lines = []
    for name in names:
        both = [f"{_rate(paper[task, name])} / {_rate(other[task, name])}" for task in TASKS]
        ends = [_mean(rows["all tasks", name].fpl) for rows in (paper, other)]
        lines.append([name, *both, " / ".join(ends)])
    _print(["method", *TASKS, "FPL"], lines)


def noisy(seeds: int = 50) -> None:
    """Success with a checker that errs at rate P either way."""
    names, rates = ("CC", "RE", "REMAC"), (0.0, 0.05, 0.1, 0.2, 0.3)
    found = {}
    for rate in rates:
        checker = {"checker": f"noisy,false_alarm={rate},miss={rate}"} if rate else {}
        found[rate] = _rows(names, seeds=seeds, starts="paper", agent=checker)
    lines = [[task, name, *(_rate(found[rate][task, name]) for rate in rates)] for task in TASKS for name in names]
    _print(["task", "method", *(f"P = {rate:g}" for rate in rates)], lines, words=2)


def paper(seeds: int = 10) -> None:
    """The paper's first table, each of its numbers after ours."""
    names, table = ("BASE", "CC", "RE", "REMAC"), published()["table_1"]
    rows, lines = _rows(names, seeds=seeds, starts="paper"), []
    for task in TASKS:
        for name in names:
            ours, theirs = rows[task, name], table[task][name]
            scr = "-" if ours.scr is None else f"{ours.scr:.0%}"
            rates = [f"{_rate(ours)} / {theirs['tsr']:.0%}", f"{scr} / {theirs['scr']:.0%}"]
            lines.append([task, name, *rates, _mean(ours.ipl), f"{_mean(ours.fpl)} / {theirs.get('length', '-')}"])
    _print(["task", "method", "TSR: ours / paper's", "SCR", "IPL: ours", "FPL: ours / paper's IPL"], lines, words=2)


def outsiders(seeds: int = 20) -> None:
    """Tasks made up without knowing the rule-based roles: rounds over the optimum for one robot, means."""
    load_extensions((str(OUTSIDERS),))
    tasks = ("FetchSponge", "RoastBun", "BoilEgg", "RinseCrab", "StashTwo", "CrowdedOven", "ShutLarder", "WashHerb")
    names = ("BASE", "CC", "RE", "REMAC")
    options: dict[str, Any] = {"tasks": tasks, "seeds": seeds, "optimum": True, "extensions": (str(OUTSIDERS),)}
    found = {starts: _rows(names, starts=starts, **options) for starts in ("paper", "mixed")}
    lines = []
    for task in tasks:
        rates = [" / ".join(_rate(found[starts][task, name]) for starts in found) for name in names]
        best = {starts: rows[task, "RE"].rounds for starts, rows in found.items()}
        ratio = " / ".join(_mean(rows[task, "RE"].optimum, 2) for rows in found.values())
        rounds = " / ".join(_mean(best[starts]) for starts in found)
        lines.append([task, *rates, rounds, ratio])
    _print(["task", *(f"{name}, paper / mixed" for name in names), "RE: rounds", "RE: over the optimum"], lines)


def _rows(
    methods: Sequence[str],
    *,
    seeds: int,
    starts: str,
    tasks: Sequence[str] = TASKS,
    agent: Mapping[str, Any] | None = None,
    optimum: bool = False,
    extensions: tuple[str, ...] = (),
) -> dict[tuple[str, str], Row]:
    """(task or "all tasks", method) -> its row."""
    jobs = make_jobs(
        tasks=tasks,
        methods=methods,
        seeds=range(seeds),
        kitchen={"backend": "symbolic", "starts": starts},
        agent=agent or {},
    )
    with tempfile.TemporaryDirectory() as folder:
        run_jobs(jobs, folder, Settings(optimum=optimum, extensions=extensions))
        records = Store(folder).read()
    return {(row.task, row.method): row for row in (*summarise(records), *overall(records))}


def _rate(row: Row) -> str:
    return f"{row.successes / row.n:.0%}" if row.n else "-"


def _mean(value: float | None, digits: int = 1) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def _print(heads: Sequence[str], rows: Sequence[Sequence[str]], *, words: int = 1) -> None:
    """A table in Markdown, whose first columns are words and whose others are numbers."""
    marks = ["---"] * words + ["---:"] * (len(heads) - words)
    for line in (heads, marks, *rows):
        typer.echo(f"| {' | '.join(line)} |")


TABLES: dict[str, Callable[..., None]] = {
    "tasks": tasks,
    "mixed": mixed,
    "floors": floors,
    "methods": methods,
    "noisy": noisy,
    "paper": paper,
    "outsiders": outsiders,
}
"""Name -> what prints the table."""

if __name__ == "__main__":
    run_script(main)
