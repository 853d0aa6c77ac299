"""The audit of checkers: how often their verdicts are right, what false alarms cost, and what errors do to success."""

from __future__ import annotations

from collections.abc import Sequence

from remac_agents.roles import FreeText
from remac_bench.board import Column, Sheet
from remac_bench.judging.alarms import detour_tokens, detours, is_false_alarm, tally
from remac_bench.judging.cells import Cells, count, number, only_known, rate, word
from remac_bench.judging.episodes import cap_rounds, setting, shared_key
from remac_bench.judging.statistics import mean
from remac_bench.playing.sight import checked_by
from remac_bench.records import CheckEntry, Record
from remac_env.rules.conditions import Condition
from remac_env.rules.sentences import predicate_of

BUDGETS = ("max_calls", "max_tokens", "max_money", "max_seconds")
"""Options of an agent that say nothing of what it is."""

AUDIT_COLUMNS = (
    Column(key="agent", title="Method", numeric=False),
    Column(key="kind", title="Checks", numeric=False, help="before a subtask, after it, or asked by the adjuster"),
    Column(key="verdicts", title="Verdicts", help="with the truth known"),
    Column(key="false", title="False", help="conditions that were false"),
    Column(key="precision", title="Precision", help="of the conditions called false, those that were"),
    Column(key="recall", title="Recall", help="of the false conditions, those called false"),
    Column(key="false_alarms", title="False alarms", help="of the true conditions, those called false"),
    Column(key="rounds", title="Rounds lost", help="rounds an episode that were spent on false alarms"),
    Column(key="each", title="an alarm", help="rounds lost for each false alarm"),
    Column(key="tokens", title="Tokens lost", help="tokens an episode in rounds spent on false alarms"),
    Column(key="cannot_tell", title="Cannot tell", help="conditions without a verdict; they are in no rate"),
    Column(key="unknown", title="Unknown", help="verdicts for which no truth is known"),
    Column(key="unmatched", title="Unmatched", help="of the last two: in a model's own words, which no predicate says"),
)
KIND_COLUMNS = (
    AUDIT_COLUMNS[0],
    Column(key="kind", title="Kind", numeric=False, help="seen, felt, known as a rule, or told by what was run"),
    Column(key="predicate", title="Condition", numeric=False, help="the predicate, or words that no predicate says"),
    *(column for column in AUDIT_COLUMNS if column.key not in ("agent", "kind", "rounds", "each", "tokens")),
)
KINDS = ("seen", "felt", "known", "ran")
OWN_WORDS = "own words"
DOSE_COLUMNS = (
    Column(key="agent", title="Method", numeric=False),
    Column(key="checker", title="Checker", numeric=False),
    Column(key="false_alarms", title="False alarms", help="measured: of the true conditions, those called false"),
    Column(key="misses", title="Misses", help="measured: of the false conditions, those called true"),
    Column(key="n", title="n", help="scored episodes"),
    Column(key="tsr", title="TSR", help="with Wilson's 95% interval"),
    Column(key="rounds", title="Rounds all", help="rounds played, failures at the cap"),
    Column(key="lost", title="Rounds lost", help="rounds an episode that were seen to be spent on false alarms"),
    Column(key="more_rounds", title="More rounds", help="than the first row, on episodes that both solved"),
    Column(key="more_tokens", title="More tokens", help="than the first row, on all shared episodes"),
)


def audit_sheets(records: Sequence[Record], *, folder: str) -> list[Sheet]:
    """For each setting with verdicts: the audit, and the dose and response where only the checker differs."""
    checked = [r for r in records if not r.infrastructure_error and (r.pre_checks or r.post_checks)]
    settings = sorted({setting(record) for record in checked})
    sheets: list[Sheet] = []
    for index, where in enumerate(settings, start=1):
        here = [record for record in checked if setting(record) == where]
        tail = "" if len(settings) == 1 else f"-{index}"
        sheets.append(_audit(where, here, key=f"audit{tail}", folder=folder))
        sheets.append(_by_kind(where, here, key=f"conditions{tail}", folder=folder))
        sheets += _doses(where, here, key=f"dose{tail}", folder=folder)
    return sheets


def _audit(where: str, records: Sequence[Record], *, key: str, folder: str) -> Sheet:
    rows: list[Cells] = []
    facts: list[dict[str, str]] = []
    for agent, group in _entries(records):
        kinds = {
            "before": [c for record in group for c in record.pre_checks if not c.asked],
            "after": [c for record in group for c in record.post_checks],
            "asked": [c for record in group for c in record.pre_checks if c.asked],
        }
        everything = [check for checks in kinds.values() for check in checks]
        costs = _costs(group, everything)
        rows.append(only_known({**_quality(agent, "all", everything), **costs}))
        rows += [only_known(_quality(agent, kind, checks)) for kind, checks in kinds.items() if checks]
        labels = {"agent": agent, "method": group[0].method, "setting": where}
        facts += [labels] * (len(rows) - len(facts))
    return Sheet(
        key=key,
        title=f"Audit of the checkers: {where}",
        caption=(
            "Every verdict of every iteration and the truth, with Wilson's intervals; what a checker cannot tell is "
            "counted apart. Rounds lost, at least: from a "
            "false alarm until the robot runs the subtask after all, and subtasks run again though they were done."
        ),
        command=f"remac bench report {folder} --all",
        columns=AUDIT_COLUMNS,
        rows=tuple(rows),
        facts=tuple(facts),
    )


def _entries(records: Sequence[Record]) -> list[tuple[str, list[Record]]]:
    """Agent and its records, by name."""
    names = sorted({record.agent for record in records})
    return [(name, [record for record in records if record.agent == name]) for name in names]


def _by_kind(where: str, records: Sequence[Record], *, key: str, folder: str) -> Sheet:
    """The same by what conditions are about: a row a kind, and one a predicate."""
    rows: list[Cells] = []
    facts: list[dict[str, str]] = []
    for agent, group in _entries(records):
        found: dict[tuple[str, str], list[CheckEntry]] = {}
        for check in (check for record in group for check in (*record.pre_checks, *record.post_checks)):
            kind, predicate = _about(check)
            found.setdefault((kind, "all"), []).append(check)
            found.setdefault((kind, predicate), []).append(check)
        order = sorted(found, key=lambda row: (KINDS.index(row[0]), row[1] != "all", row[1]))
        for kind, predicate in order:
            rows.append(only_known(_quality(agent, kind, found[kind, predicate]) | {"predicate": word(predicate)}))
            facts.append({"agent": agent, "method": group[0].method, "setting": where})
    return Sheet(
        key=key,
        title=f"Audit of the checkers by kind of condition: {where}",
        caption=(
            "Before a subtask, after it and asked by the adjuster, all together. No model is asked about what is felt: "
            "the gripper answers."
        ),
        command=f"remac bench report {folder} --all",
        columns=KIND_COLUMNS,
        rows=tuple(rows),
        facts=tuple(facts),
    )


def _about(check: CheckEntry) -> tuple[str, str]:
    """The kind of a condition and its predicate, from its sentence."""
    predicate = None if check.unmatched else predicate_of(check.condition)
    if predicate is None:
        return FreeText.of(check.condition).kind, OWN_WORDS
    return Condition(predicate.removeprefix("not "), ()).kind, predicate


def _quality(agent: str, kind: str, checks: Sequence[CheckEntry]) -> Cells:
    counted = tally(checks)
    called = counted.found + counted.false_alarms
    wrong = counted.found + counted.missed
    right = counted.false_alarms + counted.passed
    return {
        "agent": word(agent),
        "kind": word(kind),
        "verdicts": count(counted.known),
        "false": count(wrong),
        "precision": rate(counted.found, called),
        "recall": rate(counted.found, wrong),
        "false_alarms": rate(counted.false_alarms, right),
        "cannot_tell": count(counted.cannot_tell),
        "unknown": count(counted.unknown),
        "unmatched": count(counted.unmatched),
    }


def _costs(group: Sequence[Record], checks: Sequence[CheckEntry]) -> Cells:
    alarms = sum(is_false_alarm(check) for check in checks if not check.asked)
    lost = sum(len(detours(record)) for record in group)
    return {
        "rounds": number(lost / len(group), 2),
        "each": number(lost / alarms if alarms else None, 2),
        "tokens": number(mean(detour_tokens(record) for record in group), 0),
    }


def _doses(where: str, records: Sequence[Record], *, key: str, folder: str) -> list[Sheet]:
    """The curve: agents that differ in nothing but their checker."""
    families: dict[str, dict[str, list[Record]]] = {}
    for record in records:
        chosen = dict(record.options.get("agent", {}))
        checker = str(chosen.pop("checker", checked_by(record)))
        others = ", ".join(f"{name}={value}" for name, value in sorted(chosen.items()) if name not in BUDGETS)
        family = f"{record.method} ({others})" if others else record.method
        families.setdefault(family, {}).setdefault(checker, []).append(record)
    rows: list[tuple[Cells, list[Record]]] = []
    for family, by_checker in sorted(families.items()):
        ordered = sorted(by_checker.items(), key=lambda item: _errors(item[1]))
        for checker, group in ordered if len(ordered) > 1 else ():
            rows.append((_dose(family, checker, group) | _more(group, ordered[0][1]), group))
    if not rows:
        return []
    return [
        Sheet(
            key=key,
            title=f"Checkers that err, and what comes of it: {where}",
            caption="Agents that differ only in their checker, by its observed errors.",
            command=f"remac bench report {folder} --all",
            columns=DOSE_COLUMNS,
            rows=tuple(cells for cells, _ in rows),
            facts=tuple({"agent": g[0].agent, "method": g[0].method, "setting": where} for _, g in rows),
        )
    ]


def _dose(family: str, checker: str, group: Sequence[Record]) -> Cells:
    counted = tally(check for record in group for check in (*record.pre_checks, *record.post_checks))
    scored = [record for record in group if record.scored]
    return only_known(
        {
            "agent": word(family),
            "checker": word(checker),
            "false_alarms": rate(counted.false_alarms, counted.false_alarms + counted.passed),
            "misses": rate(counted.missed, counted.found + counted.missed),
            "n": count(len(scored)),
            "tsr": rate(sum(record.success for record in scored), len(scored)),
            "rounds": number(mean(r.rounds if r.success else cap_rounds(r) for r in scored)),
            "lost": number(mean(len(detours(record)) for record in group), 2),
        }
    )


def _more(group: Sequence[Record], least: Sequence[Record]) -> Cells:
    """What a checker costs more than the one that errs least, on the scored episodes of both."""
    before = {shared_key(record): record for record in least if record.scored}
    pairs = [(r, before[shared_key(r)]) for r in group if r.scored and shared_key(r) in before]
    solved = [(here, there) for here, there in pairs if here.success and there.success]
    return only_known(
        {
            "more_rounds": number(mean(here.rounds - there.rounds for here, there in solved), 2),
            "more_tokens": number(mean(_tokens(here) - _tokens(there) for here, there in pairs), 0),
        }
    )


def _tokens(record: Record) -> int:
    return record.usage.prompt_tokens + record.usage.completion_tokens


def _errors(group: Sequence[Record]) -> tuple[float, str]:
    counted = tally(check for record in group for check in (*record.pre_checks, *record.post_checks))
    return ((counted.missed + counted.false_alarms) / max(1, counted.known), group[0].agent)
