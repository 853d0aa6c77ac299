"""What asking language models came to: questions, requests, tokens, answers that were sent back, money."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

from remac_bench.prices import dollars


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What one plan, or many, took of language models; counts, and US dollars of the requests whose price is known.

    Attributes:
        calls: questions; `requests` what was sent for them, repeated and failed requests included.
        repeats: questions that were not put because the same had been answered in the same episode.
        sent_back: answers that could not be used and were sent back with what is wrong in them; each is a call more.
        unpriced: requests whose price is not known.
    """

    calls: int = 0
    requests: int = 0
    repeats: int = 0
    sent_back: int = 0
    prompt_tokens: int = 0
    completion_tokens: int = 0
    money: float = 0.0
    unpriced: int = 0

    def __add__(self, other: Asked) -> Asked:
        return Asked(**{each.name: getattr(self, each.name) + getattr(other, each.name) for each in fields(self)})

    @classmethod
    def of(cls, usage: Any, exchanges: Iterable[Any]) -> Asked:
        """From the usage and the exchanges of an agent's report, or of a record."""
        names = [each.name for each in fields(cls) if each.name != "sent_back"]
        # A question that goes on behind an answer of the model is one that was sent back.
        back = sum(any(role == "assistant" for role, _ in exchange.messages) for exchange in exchanges)
        return cls(**{name: getattr(usage, name) for name in names}, sent_back=back)

    @classmethod
    def from_json(cls, told: Mapping[str, Any] | None) -> Asked | None:
        """What `as_json` made, read again; None where there is none."""
        return None if told is None else cls(**told)

    def as_json(self) -> dict[str, Any]:
        """The same as values that json.dumps takes."""
        return asdict(self)

    @property
    def counted(self) -> str:
        """As text: "9 calls in 11 requests, 2 questions answered before, 3 answers sent back"; zeros are not told."""
        sent = f" in {_number(self.requests, 'request')}" if self.requests not in (0, self.calls) else ""
        parts = [f"{_number(self.calls, 'call')}{sent}"]
        if self.repeats:
            parts.append(f"{_number(self.repeats, 'question')} answered before")
        if self.sent_back:
            parts.append(f"{_number(self.sent_back, 'answer')} sent back")
        return ", ".join(parts)

    @property
    def told(self) -> str:
        """The same with tokens and money."""
        tokens = f"{self.prompt_tokens:,} tokens in, {self.completion_tokens:,} out"
        return f"{self.counted}, {tokens}, cost {dollars(self.money, self.unpriced)}"


def _number(count: int, noun: str) -> str:
    return f"{count} {noun}{'s' * (count != 1)}"
