"""What a page shows of each round, or of each decision point of the event clock."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from remac_bench.records import CheckEntry, ExchangeEntry, OrderEntry, OutcomeEntry, Record
from remac_bench.store import PICTURES

_DIGEST = re.compile(r"[A-Za-z0-9]{1,128}")


@dataclass(frozen=True, kw_only=True)
class ShownCheck:
    """A verdict beside the truth. `wrong`: they differ."""

    entry: CheckEntry
    when: str

    @property
    def wrong(self) -> bool:
        """Whether the verdict is not the truth; not where either is not known."""
        known = self.entry.truth is not None and self.entry.verdict is not None
        return known and self.entry.truth != self.entry.verdict


@dataclass(frozen=True, kw_only=True)
class ShownExchange:
    """A question to a model with its answer, and the pictures that went with it: links, None for one that is lost."""

    entry: ExchangeEntry
    pictures: tuple[str | None, ...]


@dataclass(frozen=True, kw_only=True)
class ShownRound:
    """All that happened in a round; `number` counts from 0 and is the index of the record's outcomes.

    People count from 1: `ordinal`. By the event clock it is a decision point: `orders` are what robots were told then,
    and the outcomes came at its end.
    """

    number: int
    start: float
    end: float
    orders: Mapping[str, OrderEntry]
    outcomes: Mapping[str, OutcomeEntry]
    changes: tuple[tuple[str, str, str], ...]
    checks: tuple[ShownCheck, ...]
    exchanges: tuple[ShownExchange, ...]

    @property
    def ordinal(self) -> int:
        """The round's number for people, from 1, as in prompts."""
        return self.number + 1

    @property
    def failed(self) -> bool:
        """Whether a subtask did."""
        return any(outcome.status != "success" for outcome in self.outcomes.values())

    @property
    def wrong(self) -> int:
        """How many verdicts are not the truth."""
        return sum(check.wrong for check in self.checks)


def shown_rounds(record: Record, spans: Sequence[tuple[float, float]], folder: Path) -> tuple[ShownRound, ...]:
    """Every round with what happened in it, and behind them what came after the last.

    Args:
        spans: when each begins and ends, s.
        folder: where pictures are looked up.
    """
    end = spans[-1][1] if spans else 0.0
    return tuple(_round(record, number, span, folder) for number, span in enumerate((*spans, (end, end))))


def round_spans(record: Record) -> list[tuple[float, float]]:
    """When each round begins and ends, simulated seconds: it is as long as its slowest robot.

    By the event clock it is a decision point, and lasts until the next one.
    """
    if record.clock == "events":
        return list(pairwise(decision_points(record)))
    spans, now = [], 0.0
    for outcomes in record.outcomes:
        begun, now = now, now + max((outcome.seconds for outcome in outcomes.values()), default=0.0)
        spans.append((begun, now))
    return spans


def decision_points(record: Record) -> list[float]:
    """What the clock showed at each decision point, s, with the end: one more than the record has outcomes.

    Something has ended at each: a subtask or wait, whose outcome stands there, or a thought or process.
    """
    ends = sorted({span.ended for span in record.timeline})
    points = [0.0]
    for outcomes in record.outcomes:
        now = points[-1]
        told = [outcome.ended for outcome in outcomes.values() if outcome.ended is not None]
        later = (end for end in ends if end > now)
        points.append(max(now, *told) if told else next(later, now))
    return points


def _round(record: Record, number: int, span: tuple[float, float], folder: Path) -> ShownRound:
    # The checks after a round count it as played; those before it do not.
    before = [ShownCheck(entry=each, when="before") for each in record.pre_checks if each.round == number]
    after = [ShownCheck(entry=each, when="after") for each in record.post_checks if each.round == number + 1]
    worlds = record.worlds[number : number + 2]
    return ShownRound(
        number=number,
        start=span[0],
        end=span[1],
        orders=record.orders[number] if number < len(record.orders) else {},
        outcomes=record.outcomes[number] if number < len(record.outcomes) else {},
        changes=tuple(changes(*worlds)) if len(worlds) == 2 else (),
        checks=(*before, *after),
        exchanges=tuple(
            ShownExchange(entry=each, pictures=tuple(_picture(digest, folder) for digest in each.pictures))
            for each in record.exchanges
            if each.round == number
        ),
    )


def alarms_of(rounds: Iterable[ShownRound]) -> dict[tuple[int, str], bool]:
    """Round and robot -> whether one of the verdicts that called a condition false there was wrong."""
    alarms: dict[tuple[int, str], bool] = {}
    for each in rounds:
        for check in each.checks:
            if check.entry.verdict is False:
                spot = (each.number, check.entry.robot)
                alarms[spot] = alarms.get(spot, False) or check.wrong
    return alarms


def changes(before: Any, after: Any) -> list[tuple[str, str, str]]:
    """What differs between two worlds as plain values: ("vegetable place", "on counter.5", "held by robot_0")."""
    old, new = dict(_leaves(before)), dict(_leaves(after))
    return [
        (" ".join(path[1:]) or "world", _worded(old.get(path)), _worded(new.get(path)))
        for path in dict.fromkeys([*old, *new])
        if old.get(path) != new.get(path)
    ]


def _leaves(value: Any, path: tuple[str, ...] = ()) -> Iterable[tuple[tuple[str, ...], Any]]:
    if isinstance(value, Mapping) and len(path) < 3:
        for key, inner in value.items():
            yield from _leaves(inner, (*path, str(key)))
    else:
        yield path, value


def _worded(value: Any) -> str:
    if value is None or value == []:
        return "\u2013"
    if isinstance(value, list):
        return " ".join(str(part) for part in value)
    return str(value)


def _picture(digest: str, folder: Path) -> str | None:
    known = _DIGEST.fullmatch(digest) and (folder / PICTURES / f"{digest}.png").is_file()
    return f"../{PICTURES}/{digest}.png" if known else None
