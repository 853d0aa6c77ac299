"""What thinking costs on the kitchen's clock: a command takes effect that many seconds after its robot was asked."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from remac_env.errors import OptionError
from remac_env.option_rows import Values
from remac_env.quoting import quoted

LONGEST_THOUGHT = 86_400.0
"""s that one command may cost at most: a day."""

_VALID = "off, fixed:S (seconds a command), tokens:S (seconds per 1,000 tokens) or recorded"


@dataclass(frozen=True, slots=True)
class Thought:
    """What went into one command: tokens that language models wrote, and seconds that it took or is declared to take.

    Attributes:
        tokens: of completions, reasoning among them.
        seconds: as long as the models took when they were asked; kept by cassettes and records.
        declared: s that roles which ask no model say that they take; they count whatever thinking costs, except "off".
    """

    tokens: int = 0
    seconds: float = 0.0
    declared: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what no thought can have cost."""
        whole = isinstance(self.tokens, int) and not isinstance(self.tokens, bool)
        if not whole or self.tokens < 0:
            raise OptionError(f"tokens {quoted(self.tokens)} is not valid; valid: a whole number from 0")
        for name in ("seconds", "declared"):
            value = getattr(self, name)
            if not isinstance(value, int | float) or not 0.0 <= value <= LONGEST_THOUGHT:
                raise OptionError(f"{name} {quoted(value)} is not valid; valid: 0..{LONGEST_THOUGHT:.0f}")


NO_THOUGHT = Thought()
"""Nothing was thought."""


class ThinkValues(Values):
    """The values of the option `think`."""

    def check(self, name: str, value: Any) -> str:
        """See Values."""
        if isinstance(value, str):
            kind, colon, figure = value.partition(":")
            if not colon and kind in ("off", "recorded"):
                return value
            if kind in ("fixed", "tokens") and 0.0 <= _number(figure) <= LONGEST_THOUGHT:
                return value
        raise OptionError(f"{name} {quoted(value)} is not valid; valid: {_VALID}")

    def read(self, text: Any) -> str:
        """See Values."""
        return self.check("", text)


def thinking_seconds(think: str, thought: Thought) -> float:
    """What a thought costs by a value of the option `think`, s."""
    kind, _, figure = think.partition(":")
    if kind == "off":
        return 0.0
    if kind == "fixed":
        return _number(figure) + thought.declared
    took = thought.seconds if kind == "recorded" else _number(figure) * thought.tokens / 1000.0
    return min(took + thought.declared, LONGEST_THOUGHT)


def _number(text: str) -> float:
    """The number that a text says; NaN where it says none."""
    try:
        return float(text)
    except ValueError:
        return math.nan


__all__ = ["LONGEST_THOUGHT", "NO_THOUGHT", "ThinkValues", "Thought", "thinking_seconds"]
