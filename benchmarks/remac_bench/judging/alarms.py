"""Verdicts beside the truth: which were wrong, and which rounds were spent on false alarms."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from remac_bench.records import CheckEntry, Record


@dataclass(frozen=True, kw_only=True)
class Tally:
    """Verdicts on conditions whose truth is known.

    Attributes:
        found, missed: conditions that were false, called false and called true.
        false_alarms, passed: conditions that were true, called false and called true.
        unknown: verdicts beside which no truth stands.
        cannot_tell: conditions on which the checker gave no verdict, whatever is true; in none of the others.
        unmatched: of the last two, those in a model's own words, which no predicate says.
    """

    found: int = 0
    missed: int = 0
    false_alarms: int = 0
    passed: int = 0
    unknown: int = 0
    cannot_tell: int = 0
    unmatched: int = 0

    @property
    def known(self) -> int:
        """Verdicts beside which the truth stands."""
        return self.found + self.missed + self.false_alarms + self.passed


def tally(checks: Iterable[CheckEntry]) -> Tally:
    """Count verdicts."""
    counts = dict.fromkeys(Tally.__dataclass_fields__, 0)
    for check in checks:
        counts["unmatched"] += check.unmatched
        if check.verdict is None:
            counts["cannot_tell"] += 1
        elif check.truth is None:
            counts["unknown"] += 1
        elif check.truth:
            counts["passed" if check.verdict else "false_alarms"] += 1
        else:
            counts["missed" if check.verdict else "found"] += 1
    return Tally(**counts)


def is_false_alarm(check: CheckEntry) -> bool:
    """A true condition that was called false."""
    return check.truth is True and check.verdict is False


def is_miss(check: CheckEntry) -> bool:
    """A false condition that was called true."""
    return check.truth is False and check.verdict is True


def detours(record: Record) -> dict[int, int]:
    """Rounds that were spent on false alarms, as index of the round -> index of the round before which it was raised.

    Before a subtask: the rounds from the alarm until the robot runs that subtask after all; none where it runs it at
    once or never. After one: the round in which it is run again though it was done. Alarms beside which another
    condition of the same subtask was truly false count for nothing.
    """
    spent: dict[int, int] = {}
    for check in _unprovoked(record.pre_checks):
        again = next((k for k in range(check.round, len(record.outcomes)) if runs(record, k, check)), None)
        for index in range(check.round, check.round if again is None else again):
            spent[index] = min(check.round, spent.get(index, check.round))
    for check in _unprovoked(record.post_checks):
        if check.round < len(record.outcomes) and runs(record, check.round, check):
            spent[check.round] = min(check.round, spent.get(check.round, check.round))
    return spent


def derailments(record: Record) -> list[CheckEntry]:
    """False alarms before a subtask that kept the robot from running it in that round, in order.

    One beside which another condition was truly false counts only where the subtask is never run from then on: what
    is truly missing is brought about first, and then the subtask is run.
    """
    alone = _unprovoked(record.pre_checks)
    every = [check for check in record.pre_checks if is_false_alarm(check) and not check.asked]
    kept_from = [
        check
        for check in every
        if not any(runs(record, k, check) for k in range(check.round, len(record.outcomes)))
        or (check in alone and not runs(record, check.round, check))
    ]
    return sorted(kept_from, key=lambda check: check.round)


def detour_tokens(record: Record) -> int:
    """Tokens of the calls that were made in rounds spent on false alarms."""
    spent = set(detours(record))
    return sum(exchange.tokens for exchange in record.exchanges if exchange.round in spent)


def _unprovoked(checks: Iterable[CheckEntry]) -> list[CheckEntry]:
    checks = [check for check in checks if not check.asked]
    provoked = {(c.round, c.robot, c.subtask) for c in checks if c.truth is not True and c.verdict is False}
    return [c for c in checks if is_false_alarm(c) and (c.round, c.robot, c.subtask) not in provoked]


def runs(record: Record, index: int, check: CheckEntry) -> bool:
    """Whether the robot ran the subtask that was checked in the round of this index."""
    entry = record.outcomes[index].get(check.robot)
    return entry is not None and entry.subtask == check.subtask
