"""Which role is filled by whom, when some are given, some have defaults, and a language model may step in."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from remac_agents.options import ModelOptions
from remac_agents.roles import Roles
from remac_agents.text.printable import quoted
from remac_agents.wiring.catalogue import MODEL_ROLES, make_role, read_role
from remac_env.errors import OptionError

if TYPE_CHECKING:
    from remac_agents.prompting.models import Models

DEFAULTS = {
    "planner": "literal",
    "checker": "truth",
    "conditions": "rule",
    "adjuster": "rule",
    "reflector": "rule",
    "handover": "reflections",
    "summariser": "rule",
}
"""Role -> who fills it where nobody is given and no model speaks for it."""


def fill_roles(given: Mapping[str, Any], options: ModelOptions, *, asks_again: bool = False) -> Roles:
    """The roles of one agent; those that are language models share budget, cassette and limiter.

    Args:
        given: role -> who fills it, None where nobody is given.
        asks_again: the planner is told of steps that failed: the literal one then mends its plan, for which it needs
            the rules.

    Raises:
        UnknownNameError, OptionError: see `remac_agents.make`.
    """
    models = _models(options) if options.given or any(_may_be_model(who) for who in given.values()) else None
    chosen = _chosen(given, options, models)
    if asks_again and chosen["planner"] == "literal":
        chosen["planner"] = {"name": "literal", "mends": True}
    return Roles(**{role: make_role(role, who, models=models) for role, who in chosen.items()})


def fillers(given: Mapping[str, Any], **options: Any) -> dict[str, Any]:
    """Role -> who would fill it, for roles as `make` takes them; nobody is made and nothing is asked.

    Args:
        given: role -> who fills it; those that are missing are not given.
        options: keywords of `options.ModelOptions` that say which model there is, and where.

    Raises:
        UnknownNameError, OptionError: for a model that is not valid.
    """
    read, every = ModelOptions(**options), {role: given.get(role) for role in DEFAULTS}
    return _chosen(every, read, _models(read) if read.given else None)


def _chosen(given: Mapping[str, Any], options: ModelOptions, models: Models | None) -> dict[str, Any]:
    chosen = {role: DEFAULTS[role] if who is None else who for role, who in given.items()}
    if options.model is not None and models is not None:
        chosen |= dict.fromkeys(_taken_over(given, options, models), options.model)
    return chosen


def _may_be_model(who: object) -> bool:
    return isinstance(who.get("name") if isinstance(who, Mapping) else who, str)


def _taken_over(given: Mapping[str, Any], options: ModelOptions, models: Models) -> list[str]:
    """The roles that the model fills."""
    from remac_agents.llm.settings import read_settings

    if not isinstance(options.model, str):
        raise OptionError(f"model {quoted(options.model)} is not valid; valid: a text provider:model")
    told = read_role(options.model, models)
    eyes = models.client(told.pop("name"), read_settings(told)).endpoint.model.images
    return [role for role in MODEL_ROLES if given[role] is None and (eyes or role != "checker")]


def _models(options: ModelOptions) -> Models:
    from remac_agents.llm import Budget, Cassette, Limiter, Manners  # only here: no offline agent needs the client
    from remac_agents.prompting.models import LIMITS, Models

    if options.limiter is not None and not isinstance(options.limiter, Limiter):
        raise OptionError(f"limiter {quoted(options.limiter)} is not valid; valid: a remac_agents.llm.Limiter, or None")
    if options.manners is not None and not isinstance(options.manners, Manners):
        raise OptionError(f"manners {quoted(options.manners)} is not valid; valid: a remac_agents.llm.Manners, or None")
    if options.replay and options.cassette is None:
        raise OptionError("replay needs a cassette; valid: cassette=FILE, replay=True")
    cassette = options.cassette
    if isinstance(cassette, str | Path):
        cassette = Cassette(cassette, mode="replay" if options.replay else "fill")
    if cassette is not None and not isinstance(cassette, Cassette):
        raise OptionError(f"cassette {quoted(cassette)} is not valid; valid: a path, a Cassette, or None")
    bounds: dict[str, Any] = {n: LIMITS.get(n) if bound is None else bound for n, bound in options.budget.items()}
    return Models(
        budget=Budget(**bounds),
        cassette=cassette,
        limiter=options.limiter,
        manners=options.manners,
        base_url=options.base_url,
        providers=options.providers,
        via=options.via,
    )
