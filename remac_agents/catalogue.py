"""Names of roles, and how anything that fills one is found: one resolver for Python callers and the command line.

    literal                      a name of ROLES
    package.module:Name          a class, an object or a plain function of an importable module
    path/file.py:Name            the same from a file
    http://127.0.0.1:8000/plan   a planner that is sent the request as JSON
    answers:FILE.json            a planner whose answers lie in a file
A class is made with the options that are given; a function is called in place of the role's only verb.
"""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Mapping
from typing import Any

from remac_agents.from_file import load_file
from remac_env.errors import OptionError, UnknownNameError

ROLES: dict[str, dict[str, str]] = {
    "planner": {
        "literal": "remac_agents.planners.literal:LiteralPlanner",
        "oracle": "remac_agents.planners.oracle:OraclePlanner",
        "noop": "remac_agents.planners.noop:NoopPlanner",
        "random": "remac_agents.planners.random:RandomPlanner",
        "human": "remac_agents.planners.human:HumanPlanner",
    },
    "checker": {
        "truth": "remac_agents.checkers.truth:TruthChecker",
        "noisy": "remac_agents.checkers.noisy:NoisyChecker",
        "none": "remac_agents.checkers.none:NoChecker",
    },
    "conditions": {"rule": "remac_agents.conditions.rule:RuleConditions"},
    "adjuster": {"rule": "remac_agents.adjusters.rule:RuleAdjuster"},
    "reflector": {"rule": "remac_agents.reflectors.rule:RuleReflector"},
    "summariser": {"rule": "remac_agents.summarisers.rule:RuleSummariser"},
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
    "summariser": ("summarise", "explain"),
}
"""Role -> the methods that its protocol asks for."""


FORMS = ("package.module:Name", "path/file.py:Name")
PLANNER_FORMS = ("http://HOST:PORT/PATH", "answers:FILE.json")
"""What may stand in place of a name: for every role, and for planners alone."""


def make_role(role: str, given: object) -> Any:
    """Who fills a role.

    Args:
        role: a key of ROLES.
        given: a text of the forms above; a mapping {"name": text, **options of its class}; a plain function; or a
            ready object.

    Raises:
        UnknownNameError: for a name that is not known or cannot be imported; lists the valid ones.
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
    if missing and len(VERBS[role]) == 1 and callable(made) and not inspect.isclass(made):
        return FunctionRole(made, VERBS[role][0])
    if missing or inspect.isclass(made):
        lacks = f"lacks {', '.join(missing)}()" if missing else "is a class, not an object of it"
        raise OptionError(f"{role} {made!r} {lacks}; see remac_agents.roles")
    return made


class FunctionRole:
    """A plain function in place of a role's only verb."""

    def __init__(self, function: Any, verb: str) -> None:
        self._function = function
        self.needs_truth = bool(getattr(function, "needs_truth", False))
        setattr(self, verb, function)

    def __repr__(self) -> str:
        return f"FunctionRole({self._function!r})"


def _construct(role: str, name: str, options: Mapping[str, Any]) -> Any:
    if role == "planner" and name.startswith(("http://", "https://")):
        from remac_agents.planners.http import HttpPlanner

        return _make(HttpPlanner, role, name, {"url": name, **options})
    if role == "planner" and name.startswith("answers:"):
        from remac_agents.planners.answers import AnswersPlanner

        return _make(AnswersPlanner, role, name, {"path": name.removeprefix("answers:"), **options})
    found = _find(role, name)
    if inspect.isclass(found):
        return _make(found, role, name, options)
    if options:
        raise OptionError(f"{role} {name!r} takes no options {dict(options)!r}: it is no class")
    return found


def _find(role: str, name: str) -> Any:
    """The class, object or function of a name."""
    source, colon, attribute = ROLES[role].get(name, name).rpartition(":")
    is_module = all(part.isidentifier() for part in source.split("."))
    if not colon or not (is_module or source.endswith(".py")):
        forms = (*FORMS, *PLANNER_FORMS) if role == "planner" else FORMS
        raise UnknownNameError(f"unknown {role} {name!r}; valid: {', '.join((*ROLES[role], *forms))}")
    try:
        module = load_file(source) if source.endswith(".py") else importlib.import_module(source)
    except (ImportError, OSError, SyntaxError, ValueError) as error:
        raise UnknownNameError(f"{role} {name!r} cannot be imported: {error}") from error
    if not hasattr(module, attribute):
        public = [word for word, value in vars(module).items() if callable(value) and not word.startswith("_")]
        there = ", ".join(public) or "nothing"
        raise UnknownNameError(f"{role} {name!r}: {source} has no {attribute!r}; it has: {there}")
    return getattr(module, attribute)


def _make(maker: Any, role: str, name: str, options: Mapping[str, Any]) -> Any:
    try:
        inspect.signature(maker).bind(**options)
    except TypeError as error:
        raise OptionError(f"{role} {name!r} does not take {dict(options)!r}: {error}") from error
    except ValueError:
        pass  # made by native code, without a signature: it speaks for itself
    return maker(**options)
