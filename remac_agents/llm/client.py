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

from remac_agents.llm.adapting import Manners
from remac_agents.llm.asking import Asker
from remac_agents.llm.budget import Budget
from remac_agents.llm.cassette import Cassette
from remac_agents.llm.clock import Clock
from remac_agents.llm.limiter import Limiter
from remac_agents.llm.outcomes import PATIENT, ChatError, ChatReply
from remac_agents.llm.providers import Endpoint
from remac_agents.llm.redaction import Redactor, plain
from remac_agents.llm.request import CHARACTERS_PER_TOKEN, ChatRequest, Picture, digest, read_messages
from remac_agents.llm.resolving import resolve
from remac_agents.llm.settings import ModelSettings, check_bounds, read_model_name
from remac_agents.llm.transport import Transport
from remac_agents.llm.wire import Caps

SEEN_IDS = 10_000


class Unset(Enum):
    """That nothing was said, where None says something."""

    UNSET = "unset"


class ChatClient:
    """Calls one model. Thread-safe; one for a run, or several that share a limiter, a budget and a cassette.

    Attributes:
        endpoint: what is called, with the settings in force.
        settings: how the model is asked.
        limiter, budget, cassette: as given; a limiter and a budget of its own where none was.
    """

    def __init__(
        self,
        endpoint: Endpoint | str,
        *,
        base_url: str | None = None,
        settings: ModelSettings | None = None,
        limiter: Limiter | None = None,
        budget: Budget | None = None,
        cassette: Cassette | None = None,
        manners: Manners | None = None,
        versions: Mapping[str, str] | None = None,
        caps: Caps | None = None,
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
            manners: what was learnt of how endpoints want to be asked; clients of a run share it.
            versions: what else answers hang on, such as the prompts' version; kept apart on the cassette.
            caps: how much of an answer is read.
            clock: the time; given by tests.
            jitter: draws from [0, 1); given by tests.
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
        clock = clock or Clock()
        self.limiter = limiter or Limiter(clock=clock)
        self._versions = dict(versions or {})
        self._environ = environ
        key = (os.environ if environ is None else environ).get(self.endpoint.provider.key, "").strip()
        self._key_problem = _key_problem(self.endpoint, key)
        self._redactor = Redactor([key])
        self._transport = Transport("" if self._key_problem else key, clock=clock, caps=caps)
        jitter = jitter or random.Random().random
        self._asker = Asker(self._transport, self.limiter, self.budget, manners or Manners(), clock, jitter, tries)
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
        return self.endpoint.model.stream or self.endpoint.model.stream_only

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
            OptionError: for invalid messages or bounds.
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
            stream=self.streams,
        )
        canonical = self._redactor.value(request.canonical())
        key = digest(canonical)
        outcome = self._unsendable(request) or self._played(canonical)
        if outcome is None and self._key_problem:
            outcome = ChatError("unauthorised", self._key_problem)
        if outcome is None:
            outcome = self._clean(replace(self._asker.ask(request, deadline), key=key))
            return self._recorded(canonical, outcome)
        return self._clean(replace(outcome, key=key))

    def _unsendable(self, request: ChatRequest) -> ChatError | None:
        model = request.endpoint.model
        if request.images and not model.images:
            return ChatError("unsupported", f"{request.endpoint.name} takes no images (option images)")
        # Half the usual estimate of tokens is certainly too low; what lies between, the endpoint decides.
        fewest = sum(len(text) for _, text in request.messages) / (2 * CHARACTERS_PER_TOKEN)
        if model.context and fewest > model.context:
            told = f"at least {fewest:.0f} tokens; {model.name} takes {model.context} (option context)"
            return ChatError("context_too_long", told)
        return None

    def _played(self, canonical: Mapping[str, Any]) -> ChatReply | ChatError | None:
        outcome = None if self.cassette is None else self.cassette.play(canonical)
        return None if outcome is None else replace(outcome, attempts=0, seconds=0.0, took=outcome.seconds)

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
