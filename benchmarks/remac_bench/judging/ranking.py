"""Who is better: paired comparisons on shared episodes, corrected for their number, and ranks that follow."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from remac_bench.board import Column, Sheet
from remac_bench.judging.cells import DASH, Cells, count, only_known, probability, rate, signed_interval, word
from remac_bench.judging.checkers import need_naming
from remac_bench.judging.episodes import problem, setting, shared_key
from remac_bench.judging.statistics import ALPHA, cluster_bootstrap, holm, problems_to_separate, sign_flip
from remac_bench.playing import agents
from remac_bench.playing.sight import checked_by
from remac_bench.records import Record

Spot = tuple[object, ...]


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Two entries on the episodes that both have played.

    Attributes:
        setting, first, second: the entries; `first` solved at least as many of the shared episodes.
        n, problems: shared episodes, and the distinct problems behind them.
        both, first_alone, second_alone: how many were solved by both, by one alone.
        better, worse: problems on which the first, or the second, solved more episodes.
        low, high: 95% interval of the difference of the rates, by the bootstrap over problems; None for one problem.
        p, adjusted: of the exact sign-flip test over problems, and after Holm's correction over the setting's pairs.
        more: further problems that would separate the two, at 80% power and the level of the whole family shared out
            evenly; None where no difference was seen, 0 where they are separated.
        equal_budget: a method that learns against a control with as many tries.
        checker: who judged the conditions of both, or of the one that is checked; "" where neither is.
    """

    setting: str
    first: str
    second: str
    n: int
    problems: int
    both: int
    first_alone: int
    second_alone: int
    better: int
    worse: int
    low: float | None
    high: float | None
    p: float
    adjusted: float = 1.0
    more: int | None = None
    equal_budget: bool = False
    checker: str = ""

    @property
    def difference(self) -> float:
        """Rate of the first less that of the second."""
        return (self.first_alone - self.second_alone) / self.n

    @property
    def separated(self) -> bool:
        """Whether the first is significantly better: by Holm's p, and by the interval where there is one."""
        return self.adjusted < ALPHA and self.difference > 0 and (self.low is None or self.low > 0)


def compare(records: Sequence[Record]) -> list[Comparison]:
    """All pairs of entries of each setting that share episodes, from distinct records in any order.

    Entries whose conditions were judged by different checkers are not compared; those that nobody checks are, with the
    entries of each checker.
    """
    found: list[Comparison] = []
    for (where, checker), group in rivals(records).items():
        entries: dict[str, list[Record]] = {}
        for record in group:
            entries.setdefault(record.agent, []).append(record)
        pairs = [_pair(where, entries, *names) for names in itertools.combinations(sorted(entries), 2)]
        found += _corrected([replace(pair, checker=checker) for pair in pairs if pair is not None])
    return found


def rivals(records: Sequence[Record]) -> dict[tuple[str, str], list[Record]]:
    """(Setting, checker) -> the scored records that are ranked together: its own, and those that nobody checked."""
    groups: dict[str, dict[str, list[Record]]] = {}
    for record in sorted(records, key=lambda r: (r.job, r.iteration)):
        if record.scored:
            groups.setdefault(setting(record), {}).setdefault(checked_by(record), []).append(record)
    found: dict[tuple[str, str], list[Record]] = {}
    for where, by_checker in sorted(groups.items()):
        unchecked = by_checker.pop("", [])
        for checker, group in sorted(by_checker.items()) or [("", [])]:
            found[where, checker] = [*unchecked, *group]
    return found


def ranks(comparisons: Sequence[Comparison], names: Sequence[str]) -> dict[str, int]:
    """Entry -> 1 + the number of entries that are significantly better, among comparisons of one setting."""
    return {name: 1 + sum(pair.separated and pair.second == name for pair in comparisons) for name in names}


def _corrected(pairs: Sequence[Comparison]) -> list[Comparison]:
    adjusted = holm([pair.p for pair in pairs])
    done = []
    for pair, value in zip(pairs, adjusted, strict=True):
        pair = replace(pair, adjusted=value)
        needed = problems_to_separate(pair.better, pair.worse, pair.problems, alpha=ALPHA / len(pairs))
        more = 0 if pair.separated else None if needed is None else max(1, needed - pair.problems)
        done.append(replace(pair, more=more))
    return done


def _pair(where: str, entries: Mapping[str, Sequence[Record]], one: str, other: str) -> Comparison | None:
    ones, others = _by_episode(entries[one]), _by_episode(entries[other])
    shared = sorted((key for key in ones if key in others and _same_start(ones[key], others[key])), key=str)
    if not shared:
        return None
    results = [(ones[key].success, others[key].success) for key in shared]
    if sum(a for a, _ in results) < sum(b for _, b in results):
        one, other, ones, others = other, one, others, ones
        results = [(b, a) for a, b in results]
    alike: dict[str, list[int]] = {}
    for key, (a, b) in zip(shared, results, strict=True):
        alike.setdefault(problem(ones[key]), []).append(int(a) - int(b))
    differences = [sum(values) for values in alike.values()]
    ends = cluster_bootstrap(
        differences, [len(values) for values in alike.values()], name=f"{where}: {one} against {other}"
    )
    alone, behind = sum(a and not b for a, b in results), sum(b and not a for a, b in results)
    return Comparison(
        setting=where,
        first=one,
        second=other,
        n=len(results),
        problems=len(alike),
        both=sum(a and b for a, b in results),
        first_alone=alone,
        second_alone=behind,
        better=sum(value > 0 for value in differences),
        worse=sum(value < 0 for value in differences),
        low=None if ends is None else ends[0],
        high=None if ends is None else ends[1],
        p=sign_flip(differences),
        equal_budget=_equal_budget(next(iter(ones.values())), next(iter(others.values()))),
    )


def _by_episode(records: Sequence[Record]) -> dict[Spot, Record]:
    return {shared_key(record): record for record in records}


def _same_start(one: Record, other: Record) -> bool:
    """Whether two records of one seed began alike: the digest tells, but it names the robots too."""
    return one.robots != other.robots or one.digest is None or other.digest is None or one.digest == other.digest


def _equal_budget(one: Record, other: Record) -> bool:
    kinds = {agents.is_learner(one.method), agents.is_learner(other.method)}
    control = agents.is_control(one.method) or agents.is_control(other.method)
    return control and kinds == {True, False} and one.iteration == other.iteration


RANK_COLUMNS = (
    Column(key="agent", title="Method", numeric=False),
    Column(key="rank", title="Rank", help="1 + number of entries that are significantly better"),
    Column(key="n", title="n", help="scored episodes"),
    Column(key="problems", title="Problems", help="distinct problems: starts alike but for looks and names"),
    Column(key="tsr", title="TSR", help="over all tasks, with Wilson's 95% interval"),
    Column(key="better", title="Better", help="how many entries are significantly better; the note names them"),
)
PAIR_COLUMNS = (
    Column(key="first", title="Entry", numeric=False),
    Column(key="second", title="against", numeric=False),
    Column(key="n", title="n", help="shared episodes"),
    Column(key="problems", title="Problems", help="distinct problems: starts alike but for looks and names"),
    Column(key="alone", title="alone", help="episodes that only one of the two solved: the first's, the second's"),
    Column(key="difference", title="Diff.", help="difference of the rates, percentage points"),
    Column(key="interval", title="95%", help="its interval, by a bootstrap that draws whole problems"),
    Column(key="p", title="p", help="exact sign-flip test over problems"),
    Column(key="holm", title="Holm", help="p after Holm's correction over the pairs of the setting"),
    Column(key="verdict", title="Verdict", numeric=False),
    Column(key="more", title="More", help="further problems that would separate them at 80% power"),
)
RANK_CAPTION = (
    "An entry is significantly better than another where, on the episodes that both have played, Holm's p of the exact "
    "sign-flip test over problems is below 0.05 and the 95% interval of the bootstrap over problems lies above 0. "
    "Entries with different checkers are not ranked together; one that solved nothing is not ranked first."
)


def ranking_sheets(records: Sequence[Record], *, folder: str) -> list[Sheet]:
    """For each setting and checker with two entries or more: the ranks, and the comparisons behind them."""
    compared, groups = compare(records), rivals(records)
    spots = sorted({(pair.setting, pair.checker) for pair in compared})
    sheets: list[Sheet] = []
    for index, (where, checker) in enumerate(spots, start=1):
        pairs = [pair for pair in compared if (pair.setting, pair.checker) == (where, checker)]
        tail = "" if len(spots) == 1 else f"-{index}"
        title = f"{where}, checked by {checker}" if need_naming(name for _, name in groups) and checker else where
        ranked = _rank_sheet(where, groups[where, checker], pairs, key=f"ranking{tail}", folder=folder)
        sheets.append(replace(ranked, title=f"Ranking: {title}"))
        sheets.append(
            Sheet(
                key=f"pairs{tail}",
                title=f"Paired comparisons: {title}",
                caption="Shared episodes: the same task, style, layout, starts and seed.",
                command=f"remac bench report {folder} --all",
                columns=PAIR_COLUMNS,
                rows=tuple(_pair_cells(pair) for pair in sorted(pairs, key=lambda p: (p.p, p.first, p.second))),
            )
        )
    return sheets


def _rank_sheet(where: str, scored: Sequence[Record], pairs: Sequence[Comparison], *, key: str, folder: str) -> Sheet:
    groups: dict[str, list[Record]] = {}
    for record in scored:
        groups.setdefault(record.agent, []).append(record)
    place = ranks(pairs, list(groups))
    # Nobody is first who solved nothing, though nobody may have been found to be better.
    unranked = {name for name in groups if place[name] == 1 and not _rate(groups[name])}
    order = sorted(groups, key=lambda name: (name in unranked, place[name], -_rate(groups[name]), name))
    rows, facts = [], []
    for name in order:
        better = sorted(pair.first for pair in pairs if pair.separated and pair.second == name)
        won = sum(record.success for record in groups[name])
        rows.append(
            only_known(
                {
                    "rank": DASH if name in unranked else count(place[name]),
                    "agent": word(name),
                    "n": count(len(groups[name])),
                    "problems": count(len({problem(record) for record in groups[name]})),
                    "tsr": rate(won, len(groups[name])),
                    "better": count(len(better), note=", ".join(better)),
                }
            )
        )
        facts.append({"agent": name, "method": groups[name][-1].method, "setting": where})
    return Sheet(
        key=key,
        title=f"Ranking: {where}",
        caption=RANK_CAPTION,
        command=f"remac bench report {folder} --all",
        columns=RANK_COLUMNS,
        rows=tuple(rows),
        facts=tuple(facts),
    )


def _rate(records: Sequence[Record]) -> float:
    return sum(record.success for record in records) / len(records)


def _pair_cells(pair: Comparison) -> Cells:
    budget = "equal budget: a learner against a control with as many tries" if pair.equal_budget else ""
    known = pair.low is not None and pair.high is not None
    return only_known(
        {
            "first": word(pair.first, note=budget),
            "second": word(pair.second, note=budget),
            "n": count(pair.n),
            "problems": count(pair.problems),
            "alone": word(f"{pair.first_alone}, {pair.second_alone}"),
            "difference": replace(word(f"{100 * pair.difference:+.0f}"), value=pair.difference),
            "interval": signed_interval(pair.low or 0.0, pair.high or 0.0) if known else DASH,
            "p": probability(pair.p),
            "holm": probability(pair.adjusted),
            "verdict": word("separated" if pair.separated else "not separated", note=budget),
            "more": count(pair.more),
        }
    )
