"""The chat client: a question to a language model, and its reply or an error as a value. Nothing here raises for what
an endpoint does; only wrong arguments raise."""

from __future__ import annotations

import os
import random
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from enum import Enum
from typing import Any

from remac_agents.llm.budget import Budget, Cost
from remac_agents.llm.cassette import Cassette
from remac_agents.llm.clock import Clock
from remac_agents.llm.judging import judge
from remac_agents.llm.limiter import Limiter
from remac_agents.llm.outcomes import KINDS, PATIENT, ChatError, ChatReply
from remac_agents.llm.providers import Endpoint, resolve
from remac_agents.llm.redaction import Redactor, plain
from remac_agents.llm.request import CHARACTERS_PER_TOKEN, ChatRequest, Picture, digest, read_messages
from remac_agents.llm.retry import wait_before
from remac_agents.llm.settings import ModelSettings, check_bounds, read_model_name
from remac_agents.llm.transport import READ_S, Transport
from remac_agents.llm.wire import Caps

SEEN_IDS = 10_000


class Unset(Enum):
    """That nothing was said, where None says something."""

    UNSET = "unset"


class ChatClient:
    """Calls one model. Thread-safe; one for a run, or several that share a limiter, a budget and a cassette."""

    def __init__(
        self,
        endpoint: Endpoint | str,
        *,
        base_url: str | None = None,
        settings: ModelSettings | None = None,
        limiter: Limiter | None = None,
        budget: Budget | None = None,
        cassette: Cassette | None = None,
        versions: Mapping[str, str] | None = None,
        caps: Caps | None = None,
        read_s: float = READ_S,
        clock: Clock | None = None,
        jitter: Callable[[], float] | None = None,
        environ: Mapping[str, str] | None = None,
        tries: int = PATIENT,
    ) -> None:
        """Open a client; nothing is sent yet.

        Args:
            endpoint: from `resolve`, or the name for it, with options behind it or without (`read_model_name`).
            base_url: see `resolve`.
            settings: how the model is asked; None: as its name says, else as its provider's data say. Answers come in
                pieces wherever the model offers it; the replies are the same.
            limiter: how many requests may be under way.
            budget: what may be spent.
            cassette: where exchanges are recorded or come from.
            versions: what else answers hang on, such as the prompts' version; kept apart on the cassette.
            caps: how much of an answer is read.
            read_s: the longest wait for the next bytes, s.
            clock, jitter: time, and draws from [0, 1); given by tests.
            environ: where the key is looked up; None: the environment.
            tries: requests that one call sends at most.
        """
        if isinstance(endpoint, str):
            name, named = read_model_name(endpoint)
            settings = settings or named
            endpoint = resolve(name, base_url=base_url or settings.base_url)
        self.settings = settings or ModelSettings()
        self.endpoint = self.settings.applied(endpoint)
        self.budget = budget or Budget()
        self.cassette = cassette
        self._stream = self.endpoint.model.stream or self.endpoint.model.stream_only
        self._clock = clock or Clock()
        self.limiter = limiter or Limiter(clock=self._clock)
        self._versions = dict(versions or {})
        self._environ, self._tries = environ, tries
        self._jitter = jitter or random.Random().random
        key = (os.environ if environ is None else environ).get(self.endpoint.provider.key, "").strip()
        self._key_problem = _key_problem(self.endpoint, key)
        self._redactor = Redactor([key])
        self._transport = Transport("" if self._key_problem else key, clock=self._clock, caps=caps, read_s=read_s)
        self._seen: dict[str, None] = {}
        self._lock = threading.Lock()

    def __repr__(self) -> str:
        return f"ChatClient({self.endpoint.name!r}, base_url={self.endpoint.base_url!r})"

    def __enter__(self) -> ChatClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def streams(self) -> bool:
        """Whether answers are asked for in pieces."""
        return self._stream

    @property
    def has_key(self) -> bool:
        """Whether a key is sent along."""
        return self._transport.has_key

    def apart(self, *, budget: Budget, tries: int, clock: Clock | None = None) -> ChatClient:
        """A client of the same model that shares nothing with this one: no cassette, no limiter, another budget."""
        more: dict[str, Any] = {"budget": budget, "tries": tries, "clock": clock, "environ": self._environ}
        return ChatClient(self.endpoint, settings=self.settings, **more)

    def redacted(self, text: str) -> str:
        """A text without this client's key, for records."""
        return self._redactor.exact(text)

    def close(self) -> None:
        """Release the connections."""
        self._transport.close()

    def complete(
        self,
        messages: Sequence[Mapping[str, str]],
        *,
        images: Sequence[Picture] = (),
        response_format: Mapping[str, Any] | None = None,
        max_tokens: int | None = None,
        temperature: float | Unset | None = Unset.UNSET,
        deadline: float | None = None,
        seed: int | None = None,
        label: str = "",
    ) -> ChatReply | ChatError:
        """Ask once; sends as many requests as it takes and helps.

        Args:
            messages: {"role": "system" | "user" | "assistant", "content": text}, in order.
            images: shown with the last message of the user.
            response_format: sent where the model offers its type; else left out, which a flag of the reply says.
            max_tokens: the longest answer, reasoning included; None: the model's default.
            temperature: 0..2; None: the model's own. Not given: as the settings say.
            deadline: seconds for the whole call, waiting and repeated requests included; None: as the settings say.
            seed: for endpoints that take one; None: as the settings say.
            label: which question of which episode; equal requests with different labels are apart on a cassette.

        Raises:
            OptionError: for messages or bounds that are none.
        """
        settings, model = self.settings, self.endpoint.model
        deadline = model.seconds if deadline is None else deadline
        temperature = settings.temperature if isinstance(temperature, Unset) else temperature
        check_bounds(max_tokens=max_tokens, temperature=temperature, deadline=deadline)
        request = ChatRequest(
            endpoint=self.endpoint,
            messages=read_messages(messages, images=bool(images)),
            images=tuple(images),
            response_format=response_format,
            max_tokens=max_tokens or model.max_tokens,
            temperature=temperature,
            seed=settings.seed if seed is None else seed,
            versions=self._versions,
            label=label,
        )
        canonical = self._redactor.value(request.canonical())
        key = digest(canonical)
        outcome = self._unsendable(request) or self._played(canonical)
        if outcome is None:
            outcome = self._ask(request, deadline)
            outcome = self._clean(replace(outcome, key=key))
            return self._recorded(canonical, outcome)
        return self._clean(replace(outcome, key=key))

    def _unsendable(self, request: ChatRequest) -> ChatError | None:
        model = request.endpoint.model
        if request.images and not model.images:
            return ChatError("unsupported", f"{request.endpoint.name} takes no images")
        # Half the usual estimate of tokens is certainly too low; what lies between, the endpoint decides.
        fewest = sum(len(text) for _, text in request.messages) / (2 * CHARACTERS_PER_TOKEN)
        if model.context and fewest > model.context:
            return ChatError("context_too_long", f"at least {fewest:.0f} tokens; {model.name} takes {model.context}")
        return None

    def _played(self, canonical: Mapping[str, Any]) -> ChatReply | ChatError | None:
        outcome = None if self.cassette is None else self.cassette.play(canonical)
        return None if outcome is None else replace(outcome, attempts=0, seconds=0.0)

    def _ask(self, request: ChatRequest, seconds: float) -> ChatReply | ChatError:
        if self._key_problem:
            return ChatError("unauthorised", self._key_problem)
        started = self._clock.monotonic()
        left = self.budget.seconds_left()
        deadline = started + (seconds if left is None else min(seconds, left))
        tries: dict[str, int] = {}
        sent = 0
        try:
            while True:
                outcome, was_sent = self._try(request, deadline)
                sent += was_sent
                wait = self._wait(outcome, tries, deadline)
                if wait is None:
                    return replace(outcome, attempts=sent, seconds=self._clock.monotonic() - started)
                self._clock.sleep(wait)
        finally:
            self.budget.book_seconds(self._clock.monotonic() - started)

    def _wait(self, outcome: ChatReply | ChatError, tries: dict[str, int], deadline: float) -> float | None:
        """Seconds until another try; None: none would help, or there is no time for it."""
        if isinstance(outcome, ChatReply):
            return None
        tries[outcome.kind] = tries.get(outcome.kind, 0) + 1
        total = sum(tries.values())
        if tries[outcome.kind] >= KINDS[outcome.kind].tries or total >= self._tries:
            return None
        if not outcome.infrastructure:
            return 0.0  # the endpoint is well and needs no rest
        wait = wait_before(total, outcome.retry_after, self._jitter)
        return None if self._clock.monotonic() + wait >= deadline else wait

    def _try(self, request: ChatRequest, deadline: float) -> tuple[ChatReply | ChatError, bool]:
        """One request, and whether it was sent."""
        with self.limiter.place(deadline) as got:
            if not got:
                return ChatError("timeout", "other requests, or a pause of the endpoint, left no time"), False
            model = request.endpoint.model
            tokens = request.tokens_estimated()
            worst = Cost(tokens + request.max_tokens, model.money(tokens, request.max_tokens))
            broken = self.budget.refuse(worst)
            if broken:
                return ChatError("over_budget", broken), False
            actual = worst
            try:
                raw = self._transport.send(request, stream=self._stream, deadline=deadline)
                outcome = raw if isinstance(raw, ChatError) else judge(raw, request)
                actual = self._cost(outcome, request)
            finally:
                self.budget.book(worst, actual)
            self._tell_limiter(outcome)
            return outcome, True

    def _cost(self, outcome: ChatReply | ChatError, request: ChatRequest) -> Cost:
        """What a request did cost: as the endpoint says, or else an estimate."""
        if outcome.tokens_in is not None and outcome.tokens_out is not None:
            return Cost(outcome.tokens_in + outcome.tokens_out, outcome.money)
        if isinstance(outcome, ChatError) and outcome.status != 200 and outcome.kind not in ("timeout", "truncated"):
            return Cost(0, 0.0)  # refused before any work was done
        longest = request.max_tokens
        if isinstance(outcome, ChatReply):
            longest = min(longest, int(len(outcome.text + outcome.reasoning) / CHARACTERS_PER_TOKEN) + 1)
        return Cost(request.tokens_estimated() + longest, outcome.money)

    def _tell_limiter(self, outcome: ChatReply | ChatError) -> None:
        if isinstance(outcome, ChatReply) or not KINDS[outcome.kind].infrastructure:
            self.limiter.succeeded()
        elif outcome.kind == "rate_limited":
            self.limiter.rate_limited(wait_before(1, outcome.retry_after, self._jitter))
        elif KINDS[outcome.kind].weighs:
            self.limiter.failed()

    def _clean(self, outcome: ChatReply | ChatError) -> ChatReply | ChatError:
        """The outcome without keys; an endpoint may echo what it was sent."""
        blot = self._redactor
        if isinstance(outcome, ChatError):
            lines = [plain(blot.text(line)) for line in outcome.detail.split("\n")]
            keep = "\n" if outcome.kind == "cassette_miss" else " "
            return outcome.with_detail(keep.join(line for line in lines if line))
        names = ("text", "reasoning", "model", "response_id", "fingerprint", "finish_reason")
        cleaned: dict[str, Any] = {name: blot.sound(getattr(outcome, name)) for name in names}
        return replace(outcome, **cleaned)

    def _recorded(self, canonical: Mapping[str, Any], outcome: ChatReply | ChatError) -> ChatReply | ChatError:
        outcome = self._flag_repeated(outcome)
        if self.cassette is None:
            return outcome
        try:
            self.cassette.record(canonical, outcome)
        except OSError:
            if isinstance(outcome, ChatReply):
                return replace(outcome, flags=(*outcome.flags, "not_recorded"))
        return outcome

    def _flag_repeated(self, outcome: ChatReply | ChatError) -> ChatReply | ChatError:
        """An id that was given before marks an answer that may belong to another request."""
        if isinstance(outcome, ChatError) or not outcome.response_id:
            return outcome
        with self._lock:
            repeated = outcome.response_id in self._seen
            self._seen[outcome.response_id] = None
            if len(self._seen) > SEEN_IDS:
                del self._seen[next(iter(self._seen))]
        return replace(outcome, flags=(*outcome.flags, "id_repeated")) if repeated else outcome


def _key_problem(endpoint: Endpoint, key: str) -> str:
    """Why there is no usable key, without showing it; "" if all is well."""
    provider = endpoint.provider
    if not key:
        return f"set {provider.key} to your key of {provider.title}" if provider.key_required else ""
    if not key.isascii() or not key.isprintable() or " " in key:
        return f"{provider.key} holds characters that no key has"
    return ""
