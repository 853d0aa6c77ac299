"""Generated tasks in numbers: made in several processes, and what that cost by grade."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from statistics import median
from typing import Any

from remac_env.errors import SamplingError


@dataclass(frozen=True)
class Made:
    """Tasks as rows, in the order of grades and seeds; seconds that passed, and why others could not be made."""

    rows: list[dict[str, Any]]
    failed: list[str]
    seconds: float


def make_rows(grades: Sequence[int], seeds: Sequence[int], sort: Mapping[str, Any], *, workers: int = 1) -> Made:
    """The tasks of these grades and seeds. `sort`: further keywords of `remac_env.generate`.

    Raises:
        UnknownNameError, OptionError: for values that are not valid.
    """
    began = time.perf_counter()
    wanted = [(grade, seed) for grade in grades for seed in seeds]
    one = partial(_row, dict(sort))
    if workers == 1:
        found = [one(each) for each in wanted]
    else:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            found = list(pool.map(one, wanted, chunksize=max(1, len(wanted) // (8 * workers))))
    rows = [row for row in found if isinstance(row, dict)]
    return Made(rows, [row for row in found if isinstance(row, str)], time.perf_counter() - began)


def _row(sort: Mapping[str, Any], wanted: tuple[int, int]) -> dict[str, Any] | str:
    from remac_env.generator import make

    began = time.process_time()
    try:
        task = make(grade=wanted[0], seed=wanted[1], **sort)
    except SamplingError as error:
        return str(error)
    return {
        **task.spec.generated,
        "goal": task.spec.wordings[2],
        "layout": task.spec.layouts[0],
        "plan": task.plan.as_text(),
        "expanded": task.plan.expanded,
        "cpu_seconds": round(time.process_time() - began, 3),
    }


def summary(made: Made) -> Iterator[str]:
    """How many tasks and problems there are by grade, how long their plans are, and what they cost to make."""
    yield f"{len(made.rows)} tasks in {made.seconds:.1f} s"
    for grade in dict.fromkeys(row["grade"] for row in made.rows):
        rows = [row for row in made.rows if row["grade"] == grade]
        exact = sum(row["proof"] == "search" for row in rows)
        cost = [row["cpu_seconds"] for row in rows]
        yield (
            f"grade {grade}: {len(rows)} tasks, {len({row['problem'] for row in rows})} problems, "
            f"{len({row['template'] for row in rows})} templates, {min(r['upper'] for r in rows)} to "
            f"{max(r['upper'] for r in rows)} rounds, {exact} exact, {median(cost):.2f} s each (CPU, median; most "
            f"{max(cost):.2f})"
        )
    yield from (f"not made: {reason}" for reason in made.failed)
