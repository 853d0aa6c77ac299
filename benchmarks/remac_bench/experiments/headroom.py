"""Which grades of generated tasks an agent solves: jobs, and tables by grade and by iteration from their records."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rich import box
from rich.markup import escape
from rich.table import Table

from remac_bench.console import plain
from remac_bench.judging.grades import gain, regret
from remac_bench.playing.job_lists import make_jobs
from remac_bench.playing.jobs import Job
from remac_bench.records import Record
from remac_env.generator import make

EXPLORING = {"planner": "literal,explores=true"}
CAREFUL = {**EXPLORING, "handover": "reflections,careful=true"}
AGENTS: dict[str, tuple[str, Mapping[str, Any]]] = {
    "random": ("BASE", {"planner": "random,steps=60"}),
    "memorised": ("BASE", {"planner": "memorised"}),
    "reader": ("BASE", {"planner": "reader"}),
    "literal": ("BASE", EXPLORING),
    "CC": ("CC", EXPLORING),
    "RE": ("RE", EXPLORING),
    "REMAC": ("REMAC", CAREFUL),
    "oracle": ("BASE", {"planner": "oracle"}),
    "witness": ("BASE", {"planner": "witness"}),
}
"""Name in the tables -> method and keywords of `remac_agents.make`: all agents that ask no model."""

EXACT = ("oracle",)
"""Agents that are played only where the optimum is known: elsewhere they would search until they give up."""

FIRST_SEED = 30_000
"""The seeds from here on were used for nothing before: no rule was tuned on them, and no suite has them."""

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
                found += [job for job in made if agent not in EXACT or _is_exact(job)]
    return found


def _is_exact(job: Job) -> bool:
    options = job.options
    task = make(
        grade=int(options.grade or 1), seed=job.seed, quirks=options.quirks, knowledge=options.knowledge,
        robots=options.robots,
    )  # fmt: skip
    return task.proof == "search"


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
    table.add_column("Agent")
    for quirks, grade in columns:
        # For other numbers of robots the same task is another problem: agents play as many as the one with the most.
        problems = max((share(found, grade=grade, quirks=quirks).problems for found in scored.values()), default=0)
        table.add_column(f"{grade}{'q' if quirks else ''} ({problems})", justify="right")
    table.add_column("half of", justify="right")
    table.add_column("with quirks", justify="right")
    for name in sorted(scored, key=_order):
        cells = [share(scored[name], grade=grade, quirks=quirks).told for quirks, grade in columns]
        table.add_row(escape(plain(name)), *cells, half_of(scored[name], 0), half_of(scored[name], QUIRKS[-1]))
    yield table
    yield _curve({name: found for name, found in by.items() if any(r.iteration for r in found)})


def _curve(by: Mapping[str, Sequence[Record]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, title="Success and regret by iteration")
    iterations = sorted({record.iteration for found in by.values() for record in found})
    titles = [f"success {number}" for number in iterations] + [f"regret {number}" for number in iterations]
    for title in ("Agent", "Quirks", "Jobs", *titles, "gain, points (95%)"):
        table.add_column(title, justify="left" if title == "Agent" else "right")
    for name in sorted(by, key=_order):
        for quirks in QUIRKS:
            kept = [[r for r in by[name] if r.iteration == n and _quirks(r) == quirks] for n in iterations]
            regrets = [regret(found) for found in kept]
            told = ["-" if each is None else f"{each:.2f}" for each in regrets]
            cells = [*(share(found).told for found in kept), *told, gain([r for found in kept for r in found]).text]
            table.add_row(escape(plain(name)), str(quirks), str(len(kept[0])) if kept else "0", *cells)
    return table


def _quirks(record: Record) -> int:
    return int(record.options["kitchen"].get("quirks", 0))


def _order(name: str) -> tuple[int, str]:
    known = list(AGENTS)
    return (known.index(name) if name in known else len(known), name)
