"""How `remac plan` and `remac experiment` reach the language models that fill their roles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import typer

from remac_agents.options import AgentOptions, ModelOptions
from remac_bench.console import FAILED, plain
from remac_bench.errors import UsageError
from remac_bench.playing import agents
from remac_bench.playing.settings import Settings
from remac_env.option_rows import rows, same


@dataclass(kw_only=True)
class Reach:
    """The flags that say it; see `flags`."""

    base_url: str | None = same(AgentOptions, "base_url")
    providers: str | None = same(AgentOptions, "providers")
    via: str | None = same(AgentOptions, "via")
    cassette: str | None = same(AgentOptions, "cassette")
    replay: bool = same(AgentOptions, "replay")
    preflight: bool = same(Settings, "preflight", default=True)
    budget: Mapping[str, Any] = field(default_factory=dict)

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
        given = context.params
        budget = {name: given[name] for name in agents.BUDGET}
        return cls(**{name: given[name] for name in rows(cls)}, budget=budget)

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

        budget = ModelOptions(**self.budget).budget
        bounds: dict[str, Any] = {n: LIMITS.get(n) if bound is None else bound for n, bound in budget.items()}
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
