"""How `remac plan` and `remac experiment` reach the language models that fill their roles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import typer

from remac_bench import agents
from remac_bench.console import FAILED, plain
from remac_bench.errors import UsageError


@dataclass(kw_only=True)
class Reach:
    """The flags that say it; see `flags`."""

    base_url: str | None = None
    providers: str | None = None
    via: str | None = None
    preflight: bool = True
    cassette: str | None = None
    replay: bool = False
    max_calls: int | None = None
    max_tokens: int | None = None
    max_money: float | None = None
    max_seconds: float | None = None

    def __post_init__(self) -> None:
        """Refuse a provider, or a file of providers, that is not valid, and a replay of nothing.

        Raises:
            UnknownNameError, OptionError: naming what is valid.
            UsageError: for --replay without --cassette.
        """
        agents.check_reach(via=self.via, providers=self.providers)
        if self.replay and self.cassette is None:
            raise UsageError("--replay needs --cassette FILE")

    @classmethod
    def of(cls, context: typer.Context) -> Reach:
        """From the flags of a command."""
        return cls(**{field.name: context.params[field.name] for field in fields(cls)})

    def routed(self, text: str) -> str:
        """A role's text, in which a model of the paper goes by its route.

        Raises:
            UnknownNameError, OptionError: see `remac_agents.llm.resolving.route`.
        """
        return agents.by_route(text, via=self.via, providers=self.providers)

    def fill(self, role: str, text: object) -> Any:
        """Who fills a role; a model with a budget of its own.

        Raises:
            UnknownNameError, OptionError: see `remac_agents.wiring.catalogue.make_role`.
        """
        from remac_agents.wiring.catalogue import make_role

        if not isinstance(text, str) or not agents.is_model(text.partition(",")[0].strip(), self.providers):
            return make_role(role, text)
        from remac_agents.llm import Budget  # only here: no offline role needs the client
        from remac_agents.prompting.models import LIMITS, Models

        bounds: dict[str, Any] = {
            name: LIMITS.get(name) if (bound := getattr(self, f"max_{name}")) is None else bound
            for name in ("calls", "tokens", "money", "seconds")
        }
        reached = {"base_url": self.base_url, "providers": self.providers, "cassette": self._tape}
        return make_role(role, text, models=Models(budget=Budget(**bounds), **reached))

    @cached_property
    def _tape(self) -> Any:
        """The cassette that all roles share; None where there is none.

        Raises:
            OptionError: if it cannot be read, or written.
        """
        if self.cassette is None:
            return None
        from remac_agents.llm import Cassette

        return Cassette(self.cassette, mode="replay" if self.replay else "fill")

    def check(self, roles: Mapping[str, object]) -> None:
        """Ask each model among these one tiny question first.

        Raises:
            typer.Exit: 2 where a model could answer nothing.
        """
        if self.preflight and any(hasattr(role, "client") for role in roles.values()):
            from remac_bench.commands.preflight import check_models

            known: dict[str, Any] = {"base_url": self.base_url, "providers": self.providers}
            check_models(roles, agents.Access(**known, cassette=self.cassette, replay=self.replay))


def tell_unscored(reasons: Sequence[str]) -> None:
    """Say that plans could not be asked for, and end the command.

    Raises:
        typer.Exit: 1 where there are any.
    """
    if reasons:
        more = "" if len(reasons) == 1 else f", and {len(reasons) - 1} more"
        typer.echo(
            f"infrastructure error, not scored: {plain(reasons[0])}{more}; the same command asks again", err=True
        )
        raise typer.Exit(FAILED)
