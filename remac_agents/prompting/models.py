"""The language models of one agent: one budget, one cassette and one limiter for all its roles, and a book of what was
said. What keeps a model from answering ends the episode; what lies in its answer does not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from remac_agents.llm import (
    Budget,
    Cassette,
    ChatClient,
    ChatError,
    ChatReply,
    Limiter,
    Manners,
    ModelSettings,
    Picture,
    load,
    resolve,
    route,
)
from remac_agents.llm.clock import Clock
from remac_agents.llm.outcomes import Bill
from remac_agents.report import Exchange, Usage
from remac_agents.roles import StopEpisode

LIMITS: dict[str, float] = {"calls": 1000, "tokens": 5_000_000, "seconds": 24 * 3600.0}
"""Bounds of a job where none are given. An episode with a model in every role takes about 60 calls, and a model
that reasons minutes for each: a job is not to fail because its model is slow."""

STOPPING = ("over_budget",)
"""Kinds of errors that end the episode as a failure of the agent; those of the infrastructure end it unjudged."""


@dataclass
class Page:
    """What was said in one episode."""

    label: str = ""
    round: int = 0
    exchanges: list[Exchange] = field(default_factory=list)
    pictures: dict[str, bytes] = field(default_factory=dict)
    errors: list[str] = field(default_factory=list)
    asked: dict[str, int] = field(default_factory=dict)
    answered: dict[str, str] = field(default_factory=dict)
    repeats: int = 0
    bill: Bill = Bill()
    thought: float = 0.0


class Models:
    """Shared by the roles of one agent. Its budget bounds a job: all episodes of the agent together."""

    def __init__(
        self,
        *,
        budget: Budget | None = None,
        cassette: Cassette | None = None,
        limiter: Limiter | None = None,
        manners: Manners | None = None,
        base_url: str | None = None,
        providers: Path | str | None = None,
        via: str | None = None,
        clock: Clock | None = None,
        environ: Mapping[str, str] | None = None,
    ) -> None:
        """Nothing is asked yet.

        Args:
            budget: None: LIMITS.
            limiter: may be shared with other agents.
            manners: what was learnt of how endpoints want to be asked; may be shared too.
            base_url: of models that may be anywhere and are named without an address.
            providers: a file of providers that adds to those built in, or overrides them.
            via: the provider by which models are reached, or "auto"; see `remac_agents.llm.resolving.route`.
            clock: given by tests.
            environ: given by tests.
        """
        self.budget = budget or Budget(**LIMITS)  # type: ignore[arg-type]
        self.cassette, self.page = cassette, Page()
        self.providers, self._via = providers, via
        self._limiter, self._base_url = limiter or Limiter(clock=clock), base_url
        self._more: dict[str, Any] = {"clock": clock, "environ": environ, "manners": manners or Manners()}
        self._clients: dict[tuple[str, str, str], ChatClient] = {}

    def client(self, model: str, settings: ModelSettings | None = None) -> ChatClient:
        """The client of a model; the same for the same model and settings.

        Raises:
            UnknownNameError: for an unknown model or route; lists the valid ones.
            OptionError: for an address that no request may go to.
        """
        settings = settings or ModelSettings()
        model = route(model, via=self._via, file=self.providers, environ=self._more["environ"])
        provider = load(self.providers).providers.get(model.partition(":")[0])
        movable = provider is not None and provider.movable
        own = settings.base_url
        endpoint = resolve(model, base_url=self._base_url if own is None and movable else own, file=self.providers)
        key = (endpoint.name, endpoint.base_url, settings.key)
        if key not in self._clients:
            shared: dict[str, Any] = {"budget": self.budget, "cassette": self.cassette, "limiter": self._limiter}
            self._clients[key] = ChatClient(endpoint, settings=settings, **shared, **self._more)
        return self._clients[key]

    def begin_episode(self, label: str, errors: list[str]) -> None:
        """Open a new page. `label` keeps the episode's questions apart on the cassette; `errors` takes up errors."""
        self.page = Page(label, errors=errors)

    def begin_round(self, number: int) -> None:
        """How many rounds were played before what is said from here on."""
        self.page.round = number

    def ask(
        self,
        client: ChatClient,
        role: str,
        messages: Sequence[Mapping[str, str]],
        *,
        about: str = "",
        images: Sequence[Picture] = (),
        response_format: Mapping[str, Any] | None = None,
    ) -> ChatReply | ChatError:
        """Put one question and note it.

        Raises:
            StopEpisode: if nobody can answer any more: the endpoint is down, or the budget spent.
        """
        page = self.page
        number = page.asked[role] = page.asked.get(role, 0) + 1
        label = f"{page.label}/{role}/{number}"
        outcome = client.complete(messages, images=images, response_format=response_format, label=label)
        self._note(client, role, about, messages, images, outcome)
        if isinstance(outcome, ChatReply):
            return outcome
        if outcome.infrastructure or outcome.kind in STOPPING:
            raise StopEpisode(f"{role}: {outcome.kind}: {outcome.detail}", infrastructure=outcome.infrastructure)
        return outcome

    def answered(self, question: str) -> str | None:
        """What was answered in this episode to a question that is kept; that is not a call and costs nothing."""
        text = self.page.answered.get(question) if question else None
        self.page.repeats += text is not None
        return text

    def keep(self, question: str, text: str) -> None:
        """Keep a usable answer, so that the question need not be put again in this episode; "" is not a question."""
        if question:
            self.page.answered[question] = text

    @property
    def exchanges(self) -> tuple[Exchange, ...]:
        """Questions and answers of the episode, in order."""
        return tuple(self.page.exchanges)

    @property
    def pictures(self) -> Mapping[str, bytes]:
        """Digest -> PNG of what was shown in the episode."""
        return dict(self.page.pictures)

    @property
    def usage(self) -> Usage:
        """What the episode took. A question is one call, however many requests it took; all of them are booked."""
        page = self.page
        calls = [exchange for exchange in page.exchanges if exchange.error not in STOPPING]
        return Usage(
            calls=len(calls),
            prompt_tokens=page.bill.tokens_in,
            completion_tokens=page.bill.tokens_out,
            money=page.bill.money,
            unpriced=page.bill.unpriced,
            seconds=sum(exchange.seconds for exchange in calls),
            repeats=page.repeats,
            requests=page.bill.requests,
        )

    @property
    def spent(self) -> tuple[int, float]:
        """Tokens that were written in the episode, and the seconds that it took: those recorded, from a cassette."""
        return self.page.bill.tokens_out, self.page.thought

    def _note(
        self,
        client: ChatClient,
        role: str,
        about: str,
        messages: Sequence[Mapping[str, str]],
        images: Sequence[Picture],
        outcome: ChatReply | ChatError,
    ) -> None:
        page, reply = self.page, outcome if isinstance(outcome, ChatReply) else None
        bill = outcome.bill
        page.bill += bill
        page.thought += outcome.took or outcome.seconds
        page.pictures.update({picture.digest: picture.png for picture in images})
        page.exchanges.append(
            Exchange(
                round=page.round,
                role=role,
                label=about,
                messages=tuple((message["role"], client.redacted(message["content"])) for message in messages),
                reply=reply.text if reply else "",
                reasoning=reply.reasoning if reply else "",
                error=None if reply else outcome.kind,  # type: ignore[union-attr]
                tokens=bill.tokens_in + bill.tokens_out,
                money=None if bill.unpriced or not bill.requests else bill.money,
                seconds=outcome.seconds,
                pictures=tuple(picture.digest for picture in images),
                requests=bill.requests,
                adaptations=outcome.adaptations,
            )
        )
