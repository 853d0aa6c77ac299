"""What a call to a language model comes to: a reply, or an error of a closed list of kinds. Neither is raised."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Kind:
    """One way to fail.

    Attributes:
        meaning: in words, for the reader of a record.
        tries: how often one call tries before it ends with this kind; 1: trying again cannot help.
        infrastructure: True where the model is not to blame, so that the episode says nothing about the agent.
        weighs: True where it counts towards pausing the endpoint.
    """

    meaning: str
    tries: int = 1
    infrastructure: bool = False
    weighs: bool = False


PATIENT = 6
"""Tries of a fault that time may mend."""

REASKS = 3
"""Tries of a fault that lies in the answer itself: the first, and two more."""

KINDS: Mapping[str, Kind] = {
    "endpoint_unavailable": Kind("nobody answered: connection, name or TLS", PATIENT, True, True),
    "timeout": Kind("the answer did not come in time; it may have cost, and is not asked for again", 1, True, True),
    "rate_limited": Kind("the endpoint asked for fewer requests", PATIENT, True),
    "server_error": Kind("the endpoint failed", PATIENT, True, True),
    "malformed": Kind("the answer is not what the protocol says", REASKS, True, True),
    "truncated": Kind("the answer broke off", REASKS, True, True),
    "unfinished": Kind("the endpoint did not say why the answer ended", REASKS, True),
    "bad_request": Kind("the endpoint refused the request", 1, True),
    "unauthorised": Kind("no key, or one that is not accepted", 1, True),
    "unknown_model": Kind("the endpoint has no such model or address", 1, True),
    "quota": Kind("the account has nothing left to spend", 1, True),
    "redirected": Kind("the endpoint pointed elsewhere, where no request was sent", 1, True),
    "cassette_miss": Kind("the cassette holds no answer to this request", 1, True),
    "unsupported": Kind("the model does not take what was to be sent", 1, True),
    "context_too_long": Kind("the prompt leaves no room in the model's context for an answer", 1, True),
    "oversized": Kind("the answer was longer than allowed and was cut off unread", 1),
    "empty": Kind("no text besides reasoning, also when asked again", REASKS),
    "cut_short": Kind("the answer hit the bound on its tokens, also the largest that the model takes", 1),
    "filtered": Kind("the endpoint withheld the answer, or the model refused", 1),
    "tool_call": Kind("the model called a tool, and none was offered", 1),
    "over_budget": Kind("the job has spent what it may", 1),
}
"""Every kind of ChatError."""


@dataclass(frozen=True)
class Bill:
    """What the requests of a call took, those included that failed or were given up.

    Attributes:
        requests: how many were sent.
        tokens_in, tokens_out, money: as far as they are known; money in US dollars.
        unpriced: requests whose money is not known.
    """

    requests: int = 0
    tokens_in: int = 0
    tokens_out: int = 0
    money: float = 0.0
    unpriced: int = 0

    def __add__(self, other: Bill) -> Bill:
        """Both together."""
        return Bill(
            self.requests + other.requests,
            self.tokens_in + other.tokens_in,
            self.tokens_out + other.tokens_out,
            self.money + other.money,
            self.unpriced + other.unpriced,
        )


@dataclass(frozen=True)
class ChatReply:
    """An answer that came whole.

    Attributes:
        text: the answer, without reasoning; never empty.
        reasoning: what the model thought aloud, "" if it did not.
        tokens_in, tokens_out: as the endpoint counted them; None where it did not, or not credibly.
        money: US dollars, as the endpoint says, or else by the provider's listed price; None where neither is known.
        seconds: the whole call by the monotonic clock, waiting included.
        attempts: requests sent, or tried to; 0 when played from a cassette.
        finish_reason: as the endpoint gave it.
        model, response_id, fingerprint: what the endpoint said of itself, "" where nothing.
        key: digest of the request, by which a cassette finds the exchange.
        flags: oddities worth a line in the record, such as "usage_unknown" or "id_repeated".
        bill: what all requests of the call took; tokens_in, tokens_out and money are those of the last one.
        adaptations: how the request that was answered departed from the one that was to be sent, because of what the
            endpoint refused, such as "max_tokens -> max_completion_tokens".
        took: seconds that it took when it was recorded, of one that is played from a cassette.
    """

    text: str
    reasoning: str = ""
    tokens_in: int | None = None
    tokens_out: int | None = None
    money: float | None = None
    seconds: float = 0.0
    attempts: int = 1
    finish_reason: str = "stop"
    model: str = ""
    response_id: str = ""
    fingerprint: str = ""
    key: str = ""
    flags: tuple[str, ...] = ()
    bill: Bill = Bill()
    adaptations: tuple[str, ...] = ()
    took: float = 0.0


@dataclass(frozen=True)
class ChatError:
    """A call without an answer.

    Attributes:
        kind: one of KINDS.
        detail: what happened, for people: one line without control characters, keys blotted out.
        status: of HTTP, if the endpoint gave one.
        retry_after: seconds that the endpoint asked to wait, if it did.
        tokens_in, tokens_out, money: what the last request cost, as far as known.
        seconds, attempts, key, bill, adaptations, took: as in ChatReply.
    """

    kind: str
    detail: str = ""
    status: int | None = None
    retry_after: float | None = None
    tokens_in: int | None = None
    tokens_out: int | None = None
    money: float | None = None
    seconds: float = 0.0
    attempts: int = 0
    key: str = ""
    bill: Bill = Bill()
    adaptations: tuple[str, ...] = ()
    took: float = 0.0

    @property
    def retriable(self) -> bool:
        """Whether the same request may do better later."""
        return KINDS[self.kind].tries > 1

    @property
    def infrastructure(self) -> bool:
        """Whether the episode should be marked as not the agent's fault."""
        return KINDS[self.kind].infrastructure

    def with_detail(self, detail: str) -> ChatError:
        """The same error, explained otherwise."""
        return replace(self, detail=detail)
