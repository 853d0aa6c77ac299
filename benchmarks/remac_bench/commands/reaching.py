"""How `remac plan` and `remac experiment` reach the language models that fill their roles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from remac_bench import agents


@dataclass(frozen=True, kw_only=True)
class Reach:
    """The flags that say it; see `flags`."""

    base_url: str | None = None
    providers: str | None = None
    via: str | None = None
    preflight: bool = True

    def __post_init__(self) -> None:
        """Refuse a provider, or a file of providers, that is not valid.

        Raises:
            UnknownNameError, OptionError: naming what is valid.
        """
        agents.check_reach(via=self.via, providers=self.providers)

    def routed(self, text: str) -> str:
        """A role's text, in which a model of the paper goes by its route.

        Raises:
            UnknownNameError, OptionError: see `remac_agents.llm.providers.route`.
        """
        return agents.by_route(text, via=self.via, providers=self.providers)

    def fill(self, role: str, text: object) -> Any:
        """Who fills a role; a model with a budget of its own.

        Raises:
            UnknownNameError, OptionError: see `remac_agents.catalogue.make_role`.
        """
        from remac_agents.catalogue import make_role

        if not isinstance(text, str) or not agents.is_model(text.partition(",")[0].strip(), self.providers):
            return make_role(role, text)
        from remac_agents.models import Models  # only here: no offline role needs the client

        return make_role(role, text, models=Models(base_url=self.base_url, providers=self.providers))

    def check(self, roles: Mapping[str, object]) -> None:
        """Ask each model among these one tiny question first.

        Raises:
            typer.Exit: 2 where a model could answer nothing.
        """
        if self.preflight and any(hasattr(role, "client") for role in roles.values()):
            from remac_bench.commands.preflight import check_models

            check_models(roles)
