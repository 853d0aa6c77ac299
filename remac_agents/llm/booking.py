"""What requests took: before they are sent at most, and afterwards in fact, as far as it is known."""

from __future__ import annotations

from remac_agents.llm.budget import Cost
from remac_agents.llm.outcomes import Bill, ChatError, ChatReply
from remac_agents.llm.request import CHARACTERS_PER_TOKEN, ChatRequest

UNKNOWN = ("timeout", "truncated", "endpoint_unavailable")
"""Kinds after which nobody knows what the endpoint had done, whatever the status was."""


def worst(request: ChatRequest) -> Cost:
    """The most that a request can take."""
    tokens = request.tokens_estimated()
    return Cost(tokens + request.max_tokens, request.endpoint.model.money(tokens, request.max_tokens))


def cost(outcome: ChatReply | ChatError, request: ChatRequest) -> Cost:
    """What a request did take: as the endpoint says, or else an estimate of its tokens."""
    if outcome.tokens_in is not None and outcome.tokens_out is not None:
        return Cost(outcome.tokens_in + outcome.tokens_out, outcome.money)
    if _refused(outcome):
        return Cost(0, 0.0)
    longest = request.max_tokens
    if isinstance(outcome, ChatReply):
        longest = min(longest, int(len(outcome.text + outcome.reasoning) / CHARACTERS_PER_TOKEN) + 1)
    return Cost(request.tokens_estimated() + longest, _money(outcome, request))


def bill(outcome: ChatReply | ChatError, request: ChatRequest) -> Bill:
    """One request, for the record: nothing is estimated, and what is not known is said to be so."""
    money = 0.0 if _refused(outcome) else _money(outcome, request)
    return Bill(
        requests=int(not unsent(outcome)),
        tokens_in=outcome.tokens_in or 0,
        tokens_out=outcome.tokens_out or 0,
        money=money or 0.0,
        unpriced=int(money is None),
    )


def unsent(outcome: ChatReply | ChatError) -> bool:
    """Whether nothing of a request was sent: nobody was there to talk to, or no time."""
    return isinstance(outcome, ChatError) and outcome.tokens_in == 0 and outcome.status is None


def _money(outcome: ChatReply | ChatError, request: ChatRequest) -> float | None:
    """None where it is not known; what is free needs no count of tokens."""
    return request.endpoint.model.money(None, None) if outcome.money is None else outcome.money


def _refused(outcome: ChatReply | ChatError) -> bool:
    """Whether a request was turned away before any work was done."""
    return isinstance(outcome, ChatError) and outcome.status not in (None, 200) and outcome.kind not in UNKNOWN
