"""What a job may spend on a language model: calls, tokens, money and seconds. Checked before, booked after."""

from __future__ import annotations

import threading
from dataclasses import dataclass

from remac_agents.text.options import MOST_SPENT, check_number


@dataclass(frozen=True)
class Spent:
    """What has been spent.

    Attributes:
        calls: requests that were sent, those that failed included.
        tokens: of prompts and answers together, thoughts included.
        money: US dollars, of the calls whose price is known.
        seconds: that the calls took, added up.
        unpriced: calls whose cost is not known; their tokens are estimates.
    """

    calls: int = 0
    tokens: int = 0
    money: float = 0.0
    seconds: float = 0.0
    unpriced: int = 0


@dataclass(frozen=True)
class Cost:
    """What one request costs, at most (before) or in fact (after). `money` None: unknown."""

    tokens: int = 0
    money: float | None = None


class Budget:
    """Bounds for one job; may be shared by the roles and threads of a job. None: no bound.

    A request is admitted only if its worst case (the whole prompt and the longest answer allowed) still fits, the
    worst cases of requests under way included, so no bound is ever exceeded - but for requests without a known
    price, which the bound on money cannot see.
    """

    def __init__(
        self,
        *,
        calls: int | None = None,
        tokens: int | None = None,
        money: float | None = None,
        seconds: float | None = None,
    ) -> None:
        """Args: calls: requests, repeated ones included; money: US dollars; seconds: spent in calls, waiting included.

        Raises:
            OptionError: for a bound that is negative or no number.
        """
        self._bounds = {"calls": calls, "tokens": tokens, "money": money, "seconds": seconds}
        for name, bound in self._bounds.items():
            if bound is not None:
                check_number(name, bound, 0, MOST_SPENT, more=", or None for no bound")
        self._lock = threading.Lock()
        self._spent = Spent()
        self._open = Spent()

    def __repr__(self) -> str:
        bounds = ", ".join(f"{name}={bound}" for name, bound in self._bounds.items() if bound is not None)
        return f"<Budget {bounds or 'without bounds'}; spent {self.spent}>"

    @property
    def spent(self) -> Spent:
        """What has been booked so far."""
        return self._spent

    def renew(self) -> None:
        """Forget what was spent: the next job begins. What is under way stays admitted."""
        with self._lock:
            self._spent = Spent()

    def refuse(self, worst: Cost) -> str:
        """Admit a request and return "", or say which bound it would break. An admitted one must be booked."""
        with self._lock:
            whole = _sum(self._spent, self._open)
            would = {"calls": whole.calls + 1, "tokens": whole.tokens + worst.tokens}
            would["money"] = whole.money + (worst.money or 0.0)  # type: ignore[assignment]
            for name, amount in would.items():
                bound = self._bounds[name]
                if bound is not None and amount > bound:
                    return f"{name}: {amount:g} would be spent at most, {bound:g} allowed"
            bound = self._bounds["seconds"]
            if bound is not None and whole.seconds >= bound:
                return f"seconds: {whole.seconds:.1f} spent, {bound:g} allowed"
            self._open = _sum(self._open, Spent(1, worst.tokens, worst.money or 0.0))
            return ""

    def seconds_left(self) -> float | None:
        """Seconds that calls may still take; None: no bound."""
        bound = self._bounds["seconds"]
        return None if bound is None else max(0.0, bound - self._spent.seconds)

    def book(self, worst: Cost, actual: Cost) -> None:
        """Book what an admitted request did cost; where that is not known, `actual` is an estimate."""
        with self._lock:
            self._open = _sum(self._open, Spent(-1, -worst.tokens, -(worst.money or 0.0)))
            unpriced = int(actual.money is None)
            self._spent = _sum(self._spent, Spent(1, actual.tokens, actual.money or 0.0, 0.0, unpriced))

    def book_seconds(self, seconds: float) -> None:
        """Book the time of a call."""
        with self._lock:
            self._spent = _sum(self._spent, Spent(seconds=seconds))


def _sum(one: Spent, two: Spent) -> Spent:
    return Spent(
        one.calls + two.calls,
        one.tokens + two.tokens,
        one.money + two.money,
        one.seconds + two.seconds,
        one.unpriced + two.unpriced,
    )
