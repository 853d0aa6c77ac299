"""How an endpoint wants to be asked, learnt from what it refuses: fields renamed, reduced or left out, once for all.

The question stays the one that was asked: its key on a cassette does not change, only the way in which it is sent.
"""

from __future__ import annotations

import re
import threading
from dataclasses import dataclass, replace

from remac_agents.llm.outcomes import ChatError
from remac_agents.llm.providers import Endpoint
from remac_agents.llm.refusals import is_too_long
from remac_agents.llm.request import ChatRequest
from remac_agents.llm.wire import IN_STREAM
from remac_agents.llm.wordings import (
    NO_SYSTEM,
    TOKEN_FIELDS,
    first_named,
    is_about_size,
    is_too_much,
    other_name,
    refuses,
    speaks_of,
    tokens_told,
)

FAIR_TOKENS = 1024
"""An answer that was given less room than that, because the prompt took the rest of the context, was given none."""

HALVINGS = 2
"""How often a call halves the answer that it asks for, where an endpoint does not say how many tokens are left."""

SLACK = 1.05
"""Prompts are estimated to be so much longer than the endpoint's own count suggests."""

DEAF = (401, 402, 407, 408, 409, 425, 429)
"""Statuses that are never about a field of the request."""

TELLING = ("temperature", "response_format", "stream_options")
"""Fields whose names mean nothing else: a refusal that names one is about it, in whatever words."""

SET = "options say what is sent: max_tokens, max_tokens_field, temperature, response_format, stream, seed, extra.NAME"


@dataclass(frozen=True)
class Manner:
    """How one endpoint wants to be asked for one model.

    Attributes:
        field: its name of the bound on an answer; "": none is sent; None: as the data say.
        left_out: fields of the request that it refuses; extra fields by their names.
        stream: whether it must stream (True) or cannot (False).
        longest: tokens of the longest answer that may be asked for.
        context: tokens of prompt and answer together.
        scale: its tokens of a prompt, as a part of our estimate.
    """

    field: str | None = None
    left_out: frozenset[str] = frozenset()
    stream: bool | None = None
    longest: int | None = None
    context: int | None = None
    scale: float = 1.0

    def __or__(self, other: Manner) -> Manner:
        """Both together; where they differ, the other one."""
        return Manner(
            self.field if other.field is None else other.field,
            self.left_out | other.left_out,
            self.stream if other.stream is None else other.stream,
            _least(self.longest, other.longest),
            _least(self.context, other.context),
            other.scale if other.scale != 1.0 else self.scale,
        )

    def applied(self, asked: ChatRequest, *, room: int | None = None) -> ChatRequest:
        """What is sent in place of a question.

        Args:
            room: tokens that are left for this answer, where the endpoint has said so.
        """
        model, out = asked.endpoint.model, self.left_out
        model = replace(
            model,
            max_tokens_field=model.max_tokens_field if self.field is None else self.field,
            temperature=model.temperature and "temperature" not in out,
            stream_usage=model.stream_usage and "stream_options" not in out,
            response_format=() if "response_format" in out else model.response_format,
            images=model.images and "images" not in out,
            extra={name: value for name, value in model.extra.items() if name not in out},
        )
        return replace(
            asked,
            endpoint=replace(asked.endpoint, model=model),
            messages=_folded(asked.messages) if "system" in out else asked.messages,
            seed=None if "seed" in out else asked.seed,
            stream=asked.stream if self.stream is None else self.stream,
            max_tokens=self._tokens(asked, room),
        )

    def _tokens(self, asked: ChatRequest, room: int | None) -> int:
        most = min(asked.max_tokens, self.longest or asked.max_tokens)
        if room is not None:
            return min(most, room)
        context = _least(self.context, asked.endpoint.model.context or None)
        left = most if context is None else context - self._estimated(asked)
        # With so little left by an estimate, the endpoint's own count decides.
        return min(most, left) if left >= FAIR_TOKENS else most

    def _estimated(self, asked: ChatRequest) -> int:
        return int(asked.tokens_estimated() * self.scale) + 1


class Manners:
    """The manners of all endpoints of a run; threads may share them."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._known: dict[tuple[str, str], Manner] = {}

    def of(self, endpoint: Endpoint) -> Manner:
        """What is known so far."""
        return self._known.get((endpoint.base_url, endpoint.model.name), Manner())

    def learn(self, endpoint: Endpoint, manner: Manner) -> None:
        """Add to what is known."""
        with self._lock:
            self._known[endpoint.base_url, endpoint.model.name] = self.of(endpoint) | manner


@dataclass(frozen=True)
class Change:
    """What to do about a refusal. `room`: of the call at hand alone."""

    manner: Manner
    room: int | None = None


def respond(error: ChatError, asked: ChatRequest, sent: ChatRequest, manner: Manner, halved: int) -> Change | ChatError:
    """The change after which a request may be sent again, or the error with the option that may help.

    Args:
        asked: the question.
        sent: what was sent in its place by this manner.
        halved: how often the call has halved its answer.
    """
    text = error.detail.casefold().removeprefix(IN_STREAM)
    if error.status is None or error.status < 400 or (error.status in DEAF and error.kind != "context_too_long"):
        return error
    failing = error.status >= 500  # such an endpoint may speak of many things
    if error.kind == "context_too_long" or (not failing and (is_too_long(text) or is_about_size(text))):
        found = _shorter(error, text, asked, sent, manner, halved)
        if found is not None:
            return found
    change = _renamed(text, sent, manner) or _without(error, text, sent, manner)
    if change is not None:
        return Change(change)
    if sent.images and speaks_of(text, "images") is not None and refuses(text):
        told = f"{error.detail}; the model takes no pictures here: set images=false and let another one check"
        return ChatError("unsupported", told, error.status)
    return error.with_detail(f"{error.detail}; {SET}") if error.kind == "bad_request" else error


def adaptations(asked: ChatRequest, sent: ChatRequest) -> tuple[str, ...]:
    """How what was sent departs from what was asked, in words."""
    one, two = asked.endpoint.model, sent.endpoint.model
    notes: list[str] = []
    if one.max_tokens_field != two.max_tokens_field:
        new = f" -> {two.max_tokens_field}" if two.max_tokens_field else " left out"
        notes.append(one.max_tokens_field + new)
    if asked.max_tokens != sent.max_tokens and two.max_tokens_field:
        notes.append(f"max_tokens {asked.max_tokens} -> {sent.max_tokens}")
    left_out = {
        "temperature": asked.temperature is not None and one.temperature and not two.temperature,
        "seed": asked.seed is not None and sent.seed is None,
        "response_format": asked.asks_for_form and not sent.asks_for_form,
        "stream_options": asked.stream and sent.stream and one.stream_usage and not two.stream_usage,
        "stream": asked.stream and not sent.stream,
        **{f"extra.{name}": name not in two.extra for name in one.extra},
    }
    notes += [f"{name} left out" for name, gone in left_out.items() if gone]
    notes += ["stream -> true"] if sent.stream and not asked.stream else []
    notes += ["system message -> user message"] if asked.messages != sent.messages else []
    return tuple(notes)


def _shorter(
    error: ChatError, text: str, asked: ChatRequest, sent: ChatRequest, manner: Manner, halved: int
) -> Change | ChatError | None:
    """Ask for less; None where the refusal is about something else after all."""
    told = tokens_told(text, sent.max_tokens)
    if told.context is not None and told.prompt is not None:
        estimate = max(1, asked.tokens_estimated())
        scale = manner.scale if told.at_least else min(1.0, SLACK * told.prompt / estimate)
        learnt = replace(manner, context=told.context, scale=scale)
        left = told.context - told.prompt
        if told.at_least:
            left = min(left, max(1, told.context - int(estimate * scale)))
        if left > 0 and sent.max_tokens > 1:
            sure = left < sent.max_tokens and not told.at_least
            return Change(learnt, left if sure else min(left, sent.max_tokens // 2))
        return _too_long(error, f"of {told.context} tokens the prompt takes {told.prompt}")
    if told.bound is not None:
        return Change(replace(manner, longest=told.bound))
    if error.kind != "context_too_long" and not is_too_long(text) and not is_too_much(text):
        return None
    if halved < HALVINGS and sent.max_tokens > FAIR_TOKENS // 2:
        learnt = manner if told.context is None else replace(manner, context=told.context)
        left = (told.context or 0) - asked.tokens_estimated()
        return Change(learnt, left if FAIR_TOKENS <= left < sent.max_tokens else sent.max_tokens // 2)
    return _too_long(error, "the prompt alone does not fit")


def _too_long(error: ChatError, why: str) -> ChatError:
    told = f"{error.detail}; {why}: serve the model with a longer context (option context says how long it is)"
    return ChatError("context_too_long", told, error.status)


def _renamed(text: str, sent: ChatRequest, manner: Manner) -> Manner | None:
    field = sent.endpoint.model.max_tokens_field
    new = other_name(text, field) if field else None
    if new is None:
        return None
    if new == "":
        new = next((name for name in TOKEN_FIELDS[:2] if name != field), "")
    # Refused under its second name too, the bound is left out.
    return replace(manner, field="" if manner.field is not None else new)


def _without(error: ChatError, text: str, sent: ChatRequest, manner: Manner) -> Manner | None:
    """The manner without the field that a refusal names first; None where it names none that was sent."""
    model = sent.endpoint.model
    if sent.images and first_named(text, ("images", "temperature", "seed", "response_format")) == "images":
        return None
    there = {
        "stream_options": sent.stream and model.stream_usage,
        "temperature": sent.temperature is not None and model.temperature,
        "response_format": sent.asks_for_form,
        "seed": sent.seed is not None,
        "system": any(role == "system" for role, _ in sent.messages),
        **dict.fromkeys(model.extra, True),
        "stream": True,
    }
    named = first_named(text, [field for field, here in there.items() if here])
    if there["system"] and re.search(NO_SYSTEM, text):
        named = "system"
    if named is None and "requested parameters" in text:  # of which there is no telling: the rarest go first
        named = next((field for field in ("response_format", "seed", "temperature") if there[field]), None)
    if named is None or not (refuses(text) or (named in TELLING and error.status in (400, 422))):
        return None
    if (error.status or 0) >= 500 and named in ("stream", "system", "seed") and not re.search(NO_SYSTEM, text):
        return None  # a failing endpoint may speak of many things
    if named == "stream":
        return replace(manner, stream=not sent.stream) if manner.stream is None else None
    return replace(manner, left_out=manner.left_out | {named})


def _folded(messages: tuple[tuple[str, str], ...]) -> tuple[tuple[str, str], ...]:
    """The messages with what the system says put before what the user says first."""
    said = "\n\n".join(text for role, text in messages if role == "system")
    rest = [message for message in messages if message[0] != "system"]
    first = next((index for index, (role, _) in enumerate(rest) if role == "user"), None)
    if first is None:
        return (("user", said), *rest)
    rest[first] = ("user", f"{said}\n\n{rest[first][1]}")
    return tuple(rest)


def _least(one: int | None, two: int | None) -> int | None:
    return min((value for value in (one, two) if value is not None), default=None)
