"""What one tiny question tells of a model: a `Probe` for every check. Nothing here raises for what an endpoint does."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from remac_agents.llm import Answer, Budget, ChatClient, ChatError, ChatReply, Picture, plain, read_json
from remac_agents.llm.clock import Clock
from remac_agents.llm.transport import NO_CONNECTION
from remac_bench.prices import PRICE_OPTIONS, dollars, list_price

SECONDS = 10.0
"""How long all questions to a model may take; models are asked at the same time."""

LONGEST = 1024
"""Tokens of an answer at most: a model that thinks longer than that has shown that it answers."""

SIDE = 64
"""Pixels of the picture's sides; some endpoints refuse pictures below 28."""

AT_ONCE = 8
"""Models asked at the same time."""

_TEXT = "This is a test of the connection. Answer with the JSON object {} and nothing else."
_JSON = {"type": "json_object"}
_COLOUR = "red"

FATAL = {
    "unauthorised": "key",
    "quota": "key",
    "unknown_model": "model",
    "redirected": "address",
}
"""Kinds of errors that no job would be spared -> the check that finds them."""

_MAY_BE_THE_QUESTION = (
    *("bad_request", "unsupported", "context_too_long", "server_error", "malformed", "endpoint_unavailable"),
)
"""Kinds of errors after which less is asked for: the picture or the form may be what was refused."""


@dataclass(frozen=True)
class Probe:
    """One finding about a model.

    Attributes:
        model: `provider:model`.
        check: key, address, model, answer, stream, pictures, JSON, tokens, price or cost.
        ok: True: it works. False: it does not. None: not known, or not claimed.
        told: what was found, one line.
        fatal: every job of the model would fail.
    """

    model: str
    check: str
    ok: bool | None
    told: str
    fatal: bool = False


@dataclass(frozen=True)
class Preflight:
    """What came of asking one model. `money`: of the questions, None where no price is known."""

    model: str
    probes: tuple[Probe, ...]
    questions: int = 0
    seconds: float = 0.0
    money: float | None = 0.0

    @property
    def fatal(self) -> tuple[Probe, ...]:
        """What no job would be spared."""
        return tuple(probe for probe in self.probes if probe.fatal)

    @property
    def warnings(self) -> tuple[Probe, ...]:
        """What does not work, and may do without."""
        return tuple(probe for probe in self.probes if probe.ok is False and not probe.fatal)


def ask_all(clients: Sequence[ChatClient], *, seconds: float = SECONDS, clock: Clock | None = None) -> list[Preflight]:
    """Ask each model, all at the same time."""
    if not clients:
        return []
    with ThreadPoolExecutor(max_workers=min(AT_ONCE, len(clients))) as pool:
        return list(pool.map(lambda client: ask(client, seconds=seconds, clock=clock), clients))


def ask(client: ChatClient, *, seconds: float = SECONDS, clock: Clock | None = None) -> Preflight:
    """Ask one model as a run would, but with a budget of its own and without its cassette.

    One question where all goes well: with a picture where the model claims to take them, and for JSON where it claims
    the form. Where that is refused, less is asked for, so that the finding says what was refused.
    """
    budget, monotonic = Budget(calls=16), (clock or Clock()).monotonic
    started = monotonic()
    with client.apart(budget=budget, tries=1, clock=clock) as alone:
        model = alone.endpoint.model

        def put(*, images: bool, form: bool) -> ChatReply | ChatError:
            left = seconds - (monotonic() - started)
            if left <= 0.1:
                return ChatError("timeout", "no time was left")
            example = '{"colour": "NAME OF THE PICTURE\'S COLOUR"}' if images else '{"ok": true}'
            return alone.complete(
                [{"role": "user", "content": _TEXT.format(example)}],
                images=[_picture()] if images else (),
                response_format=_JSON if form else None,
                max_tokens=min(LONGEST, model.max_tokens),
                deadline=left,
            )

        probes = _findings(alone, put, images=model.images, form="json_object" in model.response_format)
    spent = budget.spent
    unknown = bool(spent.unpriced and not spent.money)
    return Preflight(
        alone.endpoint.name, tuple(probes), spent.calls, monotonic() - started, None if unknown else spent.money
    )


def _findings(client: ChatClient, put: Callable[..., Any], *, images: bool, form: bool) -> list[Probe]:
    outcome = first = put(images=images, form=form)
    asked_images, asked_form = images, form
    if asked_images and _may_be_the_question(outcome):
        outcome, asked_images = put(images=False, form=form), False
    if asked_form and _may_be_the_question(outcome):
        outcome, asked_form = put(images=False, form=False), False
    if isinstance(outcome, ChatError) and isinstance(first, ChatError) and not _stops(outcome):
        outcome, asked_images, asked_form = first, images, form  # less was of no use: the first answer tells more
    name = client.endpoint.name
    if isinstance(outcome, ChatError):
        return [_failure(client, outcome)]
    refused = first.detail if isinstance(first, ChatError) else ""
    return [
        Probe(name, "address", True, client.endpoint.base_url),
        _key(client),
        Probe(name, "answer", True, f"in {outcome.seconds:.1f} s"),
        Probe(name, "stream", client.streams or None, "in pieces" if client.streams else "in one piece"),
        _pictures(client, outcome, refused, claimed=images, asked=asked_images),
        _json(client, outcome, refused if asked_images == images else "", claimed=form, asked=asked_form),
        *_adapted(name, outcome),
        _tokens(name, outcome),
        _price(client, outcome),
    ]


def _may_be_the_question(outcome: ChatReply | ChatError) -> bool:
    return isinstance(outcome, ChatError) and outcome.kind in _MAY_BE_THE_QUESTION and not _stops(outcome)


def _stops(error: ChatError) -> bool:
    """Whether no job would be spared."""
    return error.kind in FATAL or error.detail.startswith(NO_CONNECTION)


def _failure(client: ChatClient, error: ChatError) -> Probe:
    name, address = client.endpoint.name, client.endpoint.base_url
    told = plain(error.detail) or error.kind
    if error.detail.startswith(NO_CONNECTION):
        return Probe(name, "address", False, f"nobody answers at {address} ({told})", fatal=True)
    if error.kind in FATAL:
        where = "" if error.status is None else f"{address} said {error.status}: "
        return Probe(name, FATAL[error.kind], False, f"{where}{told}", fatal=True)
    if error.kind == "timeout":
        return Probe(name, "answer", None, f"none within {SECONDS:.0f} s from {address}; the run continues")
    if error.kind == "cut_short":
        return Probe(name, "answer", True, f"longer than {LONGEST} tokens, and cut there")
    status = "" if error.status is None else f" {error.status}"
    return Probe(name, "answer", False, f"{error.kind}{status} from {address}: {told}; the run continues")


def _key(client: ChatClient) -> Probe:
    provider = client.endpoint.provider
    told = f"{provider.key} is taken" if client.has_key else f"{provider.key} is not set, and was not needed"
    return Probe(client.endpoint.name, "key", True, told)


def _pictures(client: ChatClient, reply: ChatReply, refused: str, *, claimed: bool, asked: bool) -> Probe:
    name = client.endpoint.name
    if not claimed:
        said = "the option images=false" if client.settings.images is False else "the providers' table"
        return Probe(name, "pictures", None, f"not taken, says {said}")
    if not asked:
        told = f"refused ({plain(refused)[:200]}); name the model with images=false"
        return Probe(name, "pictures", False, told)
    seen = _COLOUR in reply.text.casefold()
    told = "seen" if seen else f"taken, but a {_COLOUR} one is described as {plain(reply.text)[:80]!r}"
    return Probe(name, "pictures", seen, told)


def _json(client: ChatClient, reply: ChatReply, refused: str, *, claimed: bool, asked: bool) -> Probe:
    name = client.endpoint.name
    answer = read_json(reply.text)
    found = isinstance(answer, Answer) and isinstance(answer.value, dict)
    if claimed and not asked:
        told = f"the form was refused ({plain(refused)[:200]}); name the model with response_format=none"
        return Probe(name, "JSON", False, told)
    if "response_format left out" in reply.adaptations:
        told = "the form is refused, and left out of every request; name the model with response_format=none"
        return Probe(name, "JSON", False, told)
    how = "by its form" if claimed and asked else "by the prompt alone"
    return Probe(name, "JSON", found, how if found else f"not in the answer {plain(reply.text)[:80]!r}")


def _adapted(name: str, reply: ChatReply) -> list[Probe]:
    """What the endpoint wants otherwise; runs find it out by themselves, once."""
    told = [each for each in reply.adaptations if each != "response_format left out"]
    return [Probe(name, "options", None, f"the endpoint wants {'; '.join(told)}")] if told else []


def _tokens(name: str, reply: ChatReply) -> Probe:
    if reply.tokens_in is None or reply.tokens_out is None:
        return Probe(name, "tokens", None, "not counted by the endpoint; estimates stand in their place")
    return Probe(name, "tokens", True, f"{reply.tokens_in} in, {reply.tokens_out} out, as the endpoint counts")


def _price(client: ChatClient, reply: ChatReply) -> Probe:
    name, listed = client.endpoint.name, list_price(client.endpoint.model)
    if reply.money is None:
        return Probe(name, "price", None, f"unknown; --max-money cannot bound it ({PRICE_OPTIONS})")
    by_table = client.endpoint.model.money(reply.tokens_in, reply.tokens_out)
    told = dollars(reply.money)
    if by_table is None or abs(by_table - reply.money) > 1e-9:
        return Probe(name, "price", True, f"{told}, as the endpoint says; by the table: {listed}")
    return Probe(name, "price", True, f"{told} by the table: {listed}")


def _picture() -> Picture:
    import numpy  # only here: most of what reads this file asks nothing

    pixels = numpy.zeros((SIDE, SIDE, 3), dtype=numpy.uint8)
    pixels[:, :, 0] = 255
    return Picture.of(pixels)

