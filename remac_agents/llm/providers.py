"""Who serves language models, and what they offer and cost: `resolve` picks an endpoint, `route` a way to a model.

The facts are data: providers.toml, and a file of one's own that adds to it or overrides it (provider_files.py).
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from remac_env.errors import check_choice

OWN_MACHINE = "on this machine"
"""In place of the day of a list price: a server at a loopback address costs nothing, unless it or an option says so."""

AUTO = "auto"
"""In place of a provider in `via`: the first route whose key is set."""


@dataclass(frozen=True)
class Model:
    """A model at a provider, as `providers.toml` says it.

    Attributes:
        name: what requests call it.
        images: whether it takes pictures.
        response_format: which formats it can be held to, of "json_object" and "json_schema".
        stream, stream_only: whether it can, or must, answer in pieces; stream_usage: and then count tokens.
        temperature: whether it takes one.
        max_tokens_field: how it calls the bound on an answer.
        context: tokens of prompt and answer together; 0: unknown.
        max_tokens: the bound that is asked for first; max_tokens_bound: to which it may be raised, 0: unknown.
        seconds: how long a call may take where nobody says otherwise.
        reasoning_tokens: about how many tokens it thinks a call, for estimates alone.
        extra: fields that are sent with every request.
        price_in, price_out: US dollars per million tokens, None: unknown; priced_on: as of this date.
        note: what users should know, for tables.
    """

    name: str
    images: bool = True
    response_format: tuple[str, ...] = ()
    stream: bool = True
    stream_only: bool = False
    stream_usage: bool = True
    temperature: bool = True
    max_tokens_field: str = "max_tokens"
    context: int = 0
    max_tokens: int = 8192
    max_tokens_bound: int = 0
    seconds: float = 300.0
    reasoning_tokens: int = 0
    extra: Mapping[str, Any] = field(default_factory=dict)
    price_in: float | None = None
    price_out: float | None = None
    priced_on: str = ""
    note: str = ""

    def money(self, tokens_in: int | None, tokens_out: int | None) -> float | None:
        """US dollars for so many tokens; None where tokens or price are unknown. What is free needs no count."""
        if self.price_in is None or self.price_out is None:
            return None
        if not self.price_in and not self.price_out:
            return 0.0
        if tokens_in is None or tokens_out is None:
            return None
        return (tokens_in * self.price_in + tokens_out * self.price_out) / 1e6


@dataclass(frozen=True)
class Provider:
    """An OpenAI-compatible endpoint, as `providers.toml` says it.

    Attributes:
        name, title: what model names begin with, and what people call it.
        base_url: where it is; movable: users may say another address.
        key: the environment variable of its key; key_required: without one nothing is sent.
        default: what holds for models that are not in `models`; any_model: whether there may be such.
        models: by name.
    """

    name: str
    title: str
    base_url: str
    key: str
    default: Model
    key_required: bool = True
    movable: bool = False
    any_model: bool = False
    models: Mapping[str, Model] = field(default_factory=dict)

    def ready(self, environ: Mapping[str, str] | None = None) -> bool:
        """Whether its key is set, or it does without."""
        return not self.key_required or bool((os.environ if environ is None else environ).get(self.key, "").strip())


@dataclass(frozen=True)
class Endpoint:
    """A model ready to be called: at which provider, and at the address `base_url`, to which paths are added."""

    provider: Provider
    model: Model
    base_url: str

    @property
    def name(self) -> str:
        """`provider:model`."""
        return f"{self.provider.name}:{self.model.name}"


@dataclass(frozen=True)
class Catalogue:
    """All providers, and the models of the paper: name -> routes, each `provider:model`, the best first."""

    providers: Mapping[str, Provider]
    paper: Mapping[str, tuple[str, ...]]

    def names(self) -> list[str]:
        """Every name that can be resolved without further ado."""
        listed = [f"{p.name}:{model}" for p in self.providers.values() for model in p.models]
        return [*self.paper, *listed, *(f"{p.name}:<model>" for p in self.providers.values() if p.any_model)]

    def routes(self, name: str) -> tuple[str, ...]:
        """The routes to a model of the paper, by its name (case does not matter) or by one of them; else the name."""
        for alias, routes in self.paper.items():
            if name.casefold() == alias.casefold() or name in routes:
                return routes
        return (name,)

    def check_via(self, via: object) -> None:
        """Refuse what is neither a provider nor "auto".

        Raises:
            UnknownNameError: listing the valid ones.
        """
        check_choice("via", via, (AUTO, *self.providers))

    def ready(self, full: str, environ: Mapping[str, str] | None = None) -> bool:
        """Whether the key for `provider:model` is set, or none is needed."""
        provider = self.providers.get(full.partition(":")[0])
        return provider is not None and provider.ready(environ)
