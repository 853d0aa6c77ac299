"""Generated tasks: success by grade and by template, and how agents change from iteration to iteration."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

from remac_bench.board import Cell, Column, Sheet
from remac_bench.judging.cells import Cells, count, number, only_known, rate, word
from remac_bench.judging.episodes import problem, suite_of
from remac_bench.judging.statistics import cluster_bootstrap, mean
from remac_bench.records import Record
from remac_env.generator import templates as template_rows
from remac_env.tasks.generated import SPEC

KEYS = ("grades", "templates", "learning")

_SORT = (
    Column(key="suite", title="Suite", numeric=False),
    Column(key="agent", title="Method", numeric=False),
    Column(key="knows", title="Knows", numeric=False, help="what robots know at the start"),
    Column(key="quirks", title="Quirks", help="facts of a kitchen that nobody is told"),
)
CAPTION = (
    "Scored episodes of generated tasks whose goal holds at the end; in brackets the distinct problems. A grade is the "
    "length of the shortest known plan, without quirks."
)
LEARNING = (
    "Of jobs with several iterations, all of them finished. Regret: rounds beyond those of the shortest known plan, "
    "over these, mean over successes. Gain: points of success that the last iteration has more than the first, "
    "job by job, with the 95% interval over whole problems."
)


def grade_of(record: Record) -> str:
    """The grade of a generated task, "" of any other."""
    return str(record.options.get("kitchen", {}).get("grade") or 1) if record.task == SPEC.name else ""


def made_from(record: Record) -> str:
    """What a generated task was made from, in words; "" of any other."""
    grade, kitchen = grade_of(record), record.options.get("kitchen", {})
    if not grade:
        return ""
    parts = [
        f"Grade {grade}",
        f"template “{record.template}”" if record.template else "",
        _quirks(int(kitchen.get("quirks", 0)), record.template),
        "what is behind doors has to be found" if kitchen.get("knowledge") == "seen" else "everything is known",
        f"a plan of {record.known_rounds} rounds is known" if record.known_rounds else "",
    ]
    return ", ".join(part for part in parts if part)


def _quirks(drawn: int, template: str | None) -> str:
    """How many quirks a task has: those that were drawn, and that of a template for a team."""
    row = template_rows.load().get(template or "")
    team = row is not None and row.team is not None
    count = drawn + team
    for_team = f" ({'one of them ' if count > 1 else ''}takes two robots)" if team else ""
    return f"{count or 'no'} quirk{'s' * (count != 1)}{for_team}"


def chosen(records: Iterable[Record], *, grades: Sequence[str] = (), templates: Sequence[str] = ()) -> list[Record]:
    """The records of these grades, and of templates whose names hold one of these words; all where none is given."""
    words = [text.strip().lower() for text in templates]
    found = [record for record in records if not grades or grade_of(record) in grades]
    return [r for r in found if not words or any(text in (r.template or "").lower() for text in words)]


def grade_sheets(records: Sequence[Record], *, folder: str) -> list[Sheet]:
    """Success by grade, success by template, and the learning curve; none where nothing was generated."""
    made = [record for record in records if record.task == SPEC.name and not record.infrastructure_error]
    scored = [record for record in made if record.scored]
    if not scored:
        return []
    sheets = [_by(scored, grade_of, KEYS[0], "Success by grade", folder)]
    if any(record.template for record in scored):
        sheets.append(_templates(scored, folder))
    finished = {record.job for record in scored}
    several = {record.job for record in made if record.iteration} & finished
    if several:
        sheets.append(_learning([record for record in made if record.job in several], folder))
    return sheets


Sort = tuple[str, str, str, int]


def _sort(record: Record) -> Sort:
    kitchen: dict[str, Any] = record.options.get("kitchen", {})
    return suite_of(record), record.agent, str(kitchen.get("knowledge", "full")), int(kitchen.get("quirks", 0))


def _by(records: Sequence[Record], of: Callable[[Record], str], key: str, title: str, folder: str) -> Sheet:
    names = sorted({of(record) for record in records})
    columns = [Column(key=f"{key}-{name}", title=f"Grade {name}") for name in names]
    rows, facts = [], []
    for sort, group in _groups(records):
        cells = {f"{key}-{name}": _share([record for record in group if of(record) == name]) for name in names}
        rows.append(only_known({**_head(sort), **cells}))
        facts.append({"agent": sort[1], "method": group[0].method})
    return Sheet(
        key=key, title=title, caption=CAPTION, command=f"remac bench report {folder}", columns=(*_SORT, *columns),
        rows=tuple(rows), facts=tuple(facts),
    )  # fmt: skip


def _head(sort: Sort) -> Cells:
    suite, agent, knows, quirks = sort
    return {"suite": word(suite or "-"), "agent": word(agent), "knows": word(knows), "quirks": count(quirks)}


def _groups(records: Iterable[Record]) -> list[tuple[Sort, list[Record]]]:
    found: dict[Sort, list[Record]] = {}
    for record in records:
        found.setdefault(_sort(record), []).append(record)
    return sorted(found.items(), key=lambda item: (item[0][0], item[0][3], item[0][2], item[0][1]))


def _share(group: Sequence[Record]) -> Cell:
    won, problems = sum(record.success for record in group), len({problem(record) for record in group})
    cell = rate(won, len(group), note=f"{won} of {len(group)}, {problems} problems")
    return replace(cell, text=f"{cell.text} ({problems})") if group else cell


def _templates(records: Sequence[Record], folder: str) -> Sheet:
    columns = (
        Column(key="template", title="Template", numeric=False),
        Column(key="grade", title="Grade"),
        Column(key="agent", title="Method", numeric=False),
        Column(key="n", title="n", help="scored episodes"),
        Column(key="problems", title="Problems"),
        Column(key="tsr", title="Success", help="with Wilson's 95% interval"),
    )
    found: dict[tuple[str, str, str], list[Record]] = {}
    for record in records:
        found.setdefault((record.template or "-", grade_of(record), record.agent), []).append(record)
    rows = [
        only_known({
            "template": word(template), "grade": word(grade), "agent": word(agent), "n": count(len(group)),
            "problems": count(len({problem(record) for record in group})),
            "tsr": rate(sum(record.success for record in group), len(group)),
        })
        for (template, grade, agent), group in sorted(found.items())
    ]  # fmt: skip
    facts = [
        {"template": template, "grade": grade, "agent": agent, "method": group[0].method}
        for (template, grade, agent), group in sorted(found.items())
    ]
    return Sheet(
        key=KEYS[1], title="Success by template", caption=CAPTION, command=f"remac bench report {folder} --all",
        columns=columns, rows=tuple(rows), facts=tuple(facts),
    )  # fmt: skip


def _learning(records: Sequence[Record], folder: str) -> Sheet:
    iterations = sorted({record.iteration for record in records})
    columns = [*(column for column in _SORT if column.key != "knows"), Column(key="n", title="Jobs")]
    columns += [Column(key=f"success-{at}", title=f"Success {at}") for at in iterations]
    columns += [Column(key=f"regret-{at}", title=f"Regret {at}") for at in iterations]
    columns.append(Column(key="gain", title="Gain, points (95%)"))
    groups: dict[tuple[str, int, str], list[Record]] = {}
    for record in records:
        suite, agent, _, quirks = _sort(record)
        groups.setdefault((suite, quirks, agent), []).append(record)
    rows, facts = [], []
    for (suite, quirks, agent), group in sorted(groups.items()):
        by = [[record for record in group if record.iteration == at] for at in iterations]
        parts = list(zip(iterations, by, strict=True))
        cells = {f"success-{at}": rate(sum(r.success for r in each), len(each)) for at, each in parts}
        cells |= {f"regret-{at}": number(regret(each), 2) for at, each in parts}
        head = {"suite": word(suite or "-"), "agent": word(agent), "quirks": count(quirks), "n": count(len(by[0]))}
        rows.append(only_known({**head, **cells, "gain": gain(group)}))
        facts.append({"agent": agent, "method": group[0].method})
    return Sheet(
        key=KEYS[2], title="Learning curve", caption=LEARNING, command=f"remac bench report {folder}",
        columns=tuple(columns), rows=tuple(rows), facts=tuple(facts),
    )  # fmt: skip


def regret(records: Iterable[Record]) -> float | None:
    """Rounds beyond the shortest known plan's, over these: the mean over successes whose plan is known."""
    known = [(record.rounds, record.known_rounds) for record in records if record.success and record.known_rounds]
    return mean(rounds / least - 1 for rounds, least in known)


def gain(records: Sequence[Record]) -> Cell:
    """The points of success that the last iteration has more than the first, job by job, whole problems drawn."""
    last = max((record.iteration for record in records), default=0)
    won = {(record.job, record.iteration): record.success for record in records}
    by: dict[str, list[int]] = {}
    for record in records:
        if record.iteration == 0 and (record.job, last) in won:
            by.setdefault(problem(record), []).append(int(won[record.job, last]) - int(record.success))
    counts = [len(found) for found in by.values()]
    if not counts:
        return Cell(text="-")
    sums = [float(sum(found)) for found in by.values()]
    value = sum(sums) / sum(counts)
    interval = cluster_bootstrap(sums, counts, name="gain of headroom")
    if interval is None:
        return Cell(text=f"{100 * value:+.0f}", value=value)
    low, high = interval
    return Cell(text=f"{100 * value:+.0f} ({100 * low:+.0f} to {100 * high:+.0f})", value=value, low=low, high=high)
