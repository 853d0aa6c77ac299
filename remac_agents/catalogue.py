"""Names of roles, and what they make. A role may also be an object of yours, or `package.module:Name`."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

from remac_env.errors import OptionError, UnknownNameError

ROLES: dict[str, dict[str, str]] = {
    "planner": {
        "literal": "remac_agents.planners.literal:LiteralPlanner",
        "oracle": "remac_agents.planners.oracle:OraclePlanner",
        "noop": "remac_agents.planners.noop:NoopPlanner",
        "random": "remac_agents.planners.random:RandomPlanner",
    },
    "checker": {
        "truth": "remac_agents.checkers.truth:TruthChecker",
        "noisy": "remac_agents.checkers.noisy:NoisyChecker",
        "none": "remac_agents.checkers.none:NoChecker",
    },
    "conditions": {"rule": "remac_agents.conditions.rule:RuleConditions"},
    "adjuster": {"rule": "remac_agents.adjusters.rule:RuleAdjuster"},
    "reflector": {"rule": "remac_agents.reflectors.rule:RuleReflector"},
    "handover": {
        "reflections": "remac_agents.handovers.reflections:ReflectionHandover",
        "search": "remac_agents.handovers.search:SearchHandover",
    },
}
"""Role -> name -> where its class is."""

VERBS = {
    "planner": ("plan",),
    "checker": ("check",),
    "conditions": ("before", "after"),
    "adjuster": ("adjust",),
    "reflector": ("reflect",),
    "handover": ("share",),
}
"""Role -> the methods that its protocol asks for."""


def make_role(role: str, given: object) -> Any:
    """Who fills a role.

    Args:
        role: a key of ROLES.
        given: a name; `package.module:Name`; a mapping {"name": name, **options of its class}; or a ready
        object.

    Raises:
        UnknownNameError: for a name that is not known; lists the valid ones.
        OptionError: for options or objects that do not fit the role.
    """
    if isinstance(given, str):
        given = {"name": given}
    if isinstance(given, Mapping):
        options = {str(key): value for key, value in given.items() if key != "name"}
        made = _construct(role, str(given.get("name", "")), options)
    else:
        made = given
    missing = [verb for verb in VERBS[role] if not callable(getattr(made, verb, None))]
    if missing:
        raise OptionError(f"{role} {made!r} lacks {', '.join(missing)}(); see remac_agents.roles")
    return made


def _construct(role: str, name: str, options: Mapping[str, Any]) -> Any:
    address = ROLES[role].get(name, name)
    module, colon, attribute = address.partition(":")
    if not colon:
        valid = ", ".join([*ROLES[role], "package.module:Name"])
        raise UnknownNameError(f"unknown {role} {name!r}; valid: {valid}")
    try:
        maker = getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, ValueError) as error:
        raise UnknownNameError(f"{role} {name!r} cannot be imported: {error}") from error
    try:
        return maker(**options)
    except TypeError as error:
        raise OptionError(f"{role} {name!r} does not take {dict(options)!r}: {error}") from error
