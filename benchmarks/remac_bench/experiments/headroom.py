"""Which grades of generated tasks an agent solves: jobs, and tables by grade and by iteration from their records."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rich import box
from rich.table import Table

from remac_bench.job_lists import make_jobs
from remac_bench.jobs import Job
from remac_bench.judging.statistics import cluster_bootstrap
from remac_bench.records import Record

EXPLORING = {"planner": "literal,explores=true"}
AGENTS: dict[str, tuple[str, Mapping[str, Any]]] = {
    "random": ("BASE", {"planner": "random,steps=60"}),
    "reader": ("BASE", {"planner": "reader"}),
    "BASE": ("BASE", EXPLORING),
    "CC": ("CC", EXPLORING),
    "RE": ("RE", EXPLORING),
    "REMAC": ("REMAC", EXPLORING),
    "witness": ("BASE", {"planner": "witness"}),
}
"""Name in the tables -> method and keywords of `remac_agents.make`: all agents that ask no model."""

GRADES = (1, 2, 3, 4, 5)
QUIRKS = (0, 2)
KNOWLEDGE = ("full", "seen")
MAX_ROUNDS = 220
"""Rounds after which a method stops by itself: more than an episode of any grade has."""


@dataclass(frozen=True)
class Share:
    """Successes among so many episodes of so many problems."""

    won: int
    episodes: int
    problems: int

    @property
    def told(self) -> str:
        """As a table has it."""
        return f"{100 * self.won / self.episodes:.0f}%" if self.episodes else "-"


def jobs_of(agent: str, seeds: Sequence[int], *, grades: Sequence[int] = GRADES) -> list[Job]:
    """The jobs of one agent: every grade, with quirks and without, with both kinds of knowledge."""
    method, keywords = AGENTS[agent]
    found: list[Job] = []
    for grade in grades:
        for quirks in QUIRKS:
            for knowledge in KNOWLEDGE:
                kitchen = {"backend": "symbolic", "grade": grade, "quirks": quirks, "knowledge": knowledge}
                made = make_jobs(
                    tasks=["Generated"], methods=[method], seeds=seeds, kitchen=kitchen,
                    agent={**keywords, "max_rounds": MAX_ROUNDS}, checked=False,
                )  # fmt: skip
                found += made
    return found


def agent_of(record: Record) -> str:
    """The name of a record's agent in the tables; its method's and planner's where it is none of them."""
    planner = str(record.options.get("agent", {}).get("planner", ""))
    for name, (method, keywords) in AGENTS.items():
        if method == record.method and planner == keywords["planner"]:
            return name
    return f"{record.method} ({planner})" if planner else record.method


def share(records: Sequence[Record], **wanted: Any) -> Share:
    """The successes of records whose kitchens have these options."""
    kept = [r for r in records if all(r.options["kitchen"].get(key) == value for key, value in wanted.items())]
    return Share(sum(r.success for r in kept), len(kept), len({r.problem for r in kept}))


def half_of(records: Sequence[Record], quirks: int) -> str:
    """The highest grade of which at least half of the scored episodes succeed, and of all below it too."""
    best = 0
    for grade in GRADES:
        found = share(records, grade=grade, quirks=quirks)
        if not found.episodes or found.won * 2 < found.episodes:
            break
        best = grade
    return str(best) if best else "none"


def tables(records: Sequence[Record]) -> Iterator[Table]:
    """Success by grade and quirks, and by iteration."""
    by: dict[str, list[Record]] = {}
    for record in records:
        if not record.infrastructure_error:
            by.setdefault(agent_of(record), []).append(record)
    scored = {name: [r for r in found if r.scored] for name, found in by.items()}
    table = Table(box=box.SIMPLE_HEAD, title="Success by grade (n: problems)")
    columns = [(quirks, grade) for quirks in QUIRKS for grade in GRADES]
    everything = [r for found in scored.values() for r in found]
    table.add_column("Agent")
    for quirks, grade in columns:
        problems = share(everything, grade=grade, quirks=quirks).problems
        table.add_column(f"{grade}{'q' if quirks else ''} ({problems})", justify="right")
    table.add_column("half of", justify="right")
    table.add_column("with quirks", justify="right")
    for name in sorted(scored, key=_order):
        cells = [share(scored[name], grade=grade, quirks=quirks).told for quirks, grade in columns]
        table.add_row(name, *cells, half_of(scored[name], 0), half_of(scored[name], QUIRKS[-1]))
    yield table
    yield _curve({name: found for name, found in by.items() if any(r.iteration for r in found)})


def _curve(by: Mapping[str, Sequence[Record]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, title="Success by iteration")
    iterations = sorted({record.iteration for found in by.values() for record in found})
    for title in ("Agent", "Quirks", "Jobs", *(f"iteration {number}" for number in iterations), "gain, points (95%)"):
        table.add_column(title, justify="left" if title == "Agent" else "right")
    for name in sorted(by, key=_order):
        for quirks in QUIRKS:
            kept = [[r for r in by[name] if r.iteration == number] for number in iterations]
            shares = [share(found, quirks=quirks) for found in kept]
            gained = gain(by[name], quirks) if kept else "-"
            table.add_row(name, str(quirks), str(shares[0].episodes), *(each.told for each in shares), gained)
    return table


def gain(records: Sequence[Record], quirks: int) -> str:
    """The points of success that the last iteration has more than the first, job by job, whole problems drawn."""
    kept = [record for record in records if record.options["kitchen"].get("quirks") == quirks]
    last = max((record.iteration for record in kept), default=0)
    won = {(record.job, record.iteration): record.success for record in kept}
    by: dict[str | None, list[int]] = {}
    for record in kept:
        if record.iteration == 0 and (record.job, last) in won:
            by.setdefault(record.problem, []).append(int(won[record.job, last]) - int(record.success))
    counts = [len(found) for found in by.values()]
    if not counts:
        return "-"
    sums = [float(sum(found)) for found in by.values()]
    interval = cluster_bootstrap(sums, counts, name="gain of headroom")
    told = "" if interval is None else f" ({100 * interval[0]:+.0f} to {100 * interval[1]:+.0f})"
    return f"{100 * sum(sums) / sum(counts):+.0f}{told}"


def _order(name: str) -> tuple[int, str]:
    known = list(AGENTS)
    return (known.index(name) if name in known else len(known), name)
