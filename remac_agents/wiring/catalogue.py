"""Names of roles, and how anything that fills one is found: one resolver for Python callers and the command line.

    literal                      a name of ROLES, or one that an installed package adds (remac_env/plugins.py)
    package.module:Name          a class, an object or a plain function of an importable module
    path/file.py:Name            the same from a file
    http://127.0.0.1:8000/plan   a planner that is sent the request as JSON
    answers:FILE.json            a planner whose answers lie in a file
    policy:FILE.npz              a planner that is a trained policy, as numbers
    pddl:COMMAND                 a planner that is another program, which reads PDDL
    provider:model               a language model (docs/models.md), or a name of the paper's models, such as "o3"
Options stand behind a name: name,option=value (text/options.py). A class is made with the options that are given; a
function is called in place of the role's only verb.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from remac_agents.roles.grants import reads_truth
from remac_agents.text.options import FORM, read_value, split_options
from remac_agents.text.printable import quoted
from remac_env.errors import OptionError
from remac_env.plugins import FORMS, find, group_of, installed, load
from remac_env.values import python_values

if TYPE_CHECKING:
    from remac_agents.prompting.models import Models

ROLES: dict[str, dict[str, str]] = {
    "planner": {
        "literal": "remac_agents.planners.literal:LiteralPlanner",
        "witness": "remac_agents.planners.witness:WitnessPlanner",
        "oracle": "remac_agents.planners.oracle:OraclePlanner",
        "noop": "remac_agents.planners.noop:NoopPlanner",
        "random": "remac_agents.planners.random:RandomPlanner",
        "reader": "remac_agents.planners.reader:ReaderPlanner",
        "memorised": "remac_agents.planners.memorised:MemorisedPlanner",
        "timely": "remac_agents.planners.timely:TimelyPlanner",
        "human": "remac_agents.planners.human:HumanPlanner",
    },
    "checker": {
        "truth": "remac_agents.checkers.truth:TruthChecker",
        "noisy": "remac_agents.checkers.noisy:NoisyChecker",
        "none": "remac_agents.checkers.none:NoChecker",
        "vision": "remac_agents.checkers.vision:VisionChecker",
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

MODEL_ROLES: dict[str, str] = {
    "planner": "remac_agents.planners.llm:LlmPlanner",
    "checker": "remac_agents.checkers.vlm:VlmChecker",
    "conditions": "remac_agents.conditions.llm:LlmConditions",
    "adjuster": "remac_agents.adjusters.llm:LlmAdjuster",
    "reflector": "remac_agents.reflectors.llm:LlmReflector",
    "handover": "remac_agents.handovers.llm:LlmHandover",
    "summariser": "remac_agents.summarisers.llm:LlmSummariser",
}
"""Role -> the class that fills it with a language model."""

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


MODEL_FORMS = ("provider:model",)
PLANNER_FORMS = ("http://HOST:PORT/PATH", "answers:FILE.json", "policy:FILE.npz", "pddl:COMMAND")
"""What may stand in place of a name beside `remac_env.plugins.FORMS`: for roles of MODEL_ROLES, for planners alone."""

PLANNERS_AT = {
    "http://": ("remac_agents.planners.http:HttpPlanner", "url"),
    "https://": ("remac_agents.planners.http:HttpPlanner", "url"),
    "answers:": ("remac_agents.planners.answers:AnswersPlanner", "path"),
    "policy:": ("remac_agents.planners.policy:PolicyPlanner", "path"),
    "pddl:": ("remac_agents.planners.pddl:PddlPlanner", "command"),
}
"""Beginning of a planner's text -> its class, and the argument that says where it is: a URL is the whole text."""


def make_role(role: str, given: object, *, models: Models | None = None) -> Any:
    """Who fills a role.

    Args:
        role: a key of ROLES.
        given: a text of the forms above, with options or without; a mapping {"name": text, **options of its class}; a
            plain function; or a ready object.
        models: what roles that are language models share; None: each has a budget of its own and no cassette.

    Raises:
        UnknownNameError: for a name that is not known or cannot be imported; lists the valid ones.
        OptionError: for options or objects that do not fit the role.
    """
    given = python_values(given)
    if isinstance(given, str):
        given = read_role(given, models)
    if isinstance(given, Mapping):
        options = {str(key): value for key, value in given.items() if key != "name"}
        made = _construct(role, str(given.get("name", "")), options, models)
    else:
        made = given
    missing = [verb for verb in VERBS[role] if not callable(getattr(made, verb, None))]
    if missing and len(VERBS[role]) == 1 and callable(made) and not inspect.isclass(made):
        return FunctionRole(made, VERBS[role][0])
    if missing or inspect.isclass(made):
        lacks = f"lacks {', '.join(missing)}()" if missing else "is a class, not an object of it"
        raise OptionError(f"{role} {quoted(made)} {lacks}; valid: an object of remac_agents.roles")
    return made


def read_role(text: str, models: Models | None = None) -> dict[str, Any]:
    """A role from its text: {"name": ..., **options}. What a model's options mean, the model's settings say.

    Args:
        models: who knows which providers there are; None: those that are built in.

    Raises:
        OptionError: for an option without a value, or one that is given twice.
    """
    model = _is_model(text.partition(",")[0].strip(), _providers(models))
    name, options = split_options(text, commas=not model)
    return {"name": name, **(options if model else {option: read_value(value) for option, value in options.items()})}


def looks_at_pictures(role: str, given: object, *, providers: Path | str | None = None) -> bool:
    """Whether who is given for a role must be shown pictures (`needs_images`); nobody is made.

    Args:
        providers: a file of providers that adds to those built in.

    Raises:
        UnknownNameError: as for `make_role`.
    """
    return bool(getattr(_named(role, given, providers), "needs_images", False))


def picture_size(role: str, given: object, *, providers: Path | str | None = None) -> int | None:
    """Pixels of a side of the pictures that who is given for a role makes use of (`picture_size`); None: any."""
    size = getattr(_named(role, given, providers), "picture_size", None)
    return None if size is None else int(size)


def cameras_of(role: str, given: object, *, providers: Path | str | None = None) -> tuple[str, ...] | None:
    """The pictures that who is given for a role makes use of (`cameras`); None: those that there usually are."""
    cameras = getattr(_named(role, given, providers), "cameras", None)
    return None if cameras is None else tuple(cameras)


def _named(role: str, given: object, providers: Path | str | None) -> Any:
    """The class or object that is given for a role, without making one; None for what lies at an address."""
    name = given.get("name", "") if isinstance(given, Mapping) else given
    if not isinstance(name, str):
        return name
    name = name.partition(",")[0].strip()
    if role in MODEL_ROLES and name not in ROLES[role] and _is_model(name, providers):
        return load(role, MODEL_ROLES[role])
    if role == "planner" and name.startswith(tuple(PLANNERS_AT)):
        return None
    return _find(role, name)


def is_plugin(role: str, given: object, *, providers: Path | str | None = None) -> bool:
    """Whether a text names code from outside that is imported: no name of ours, no model, no address, no file of
    answers, and no program, which has processes of its own."""
    name = given.get("name", "") if isinstance(given, Mapping) else given
    if not isinstance(name, str) or name.partition(",")[0].strip() in ROLES[role]:
        return False
    bare = name.partition(",")[0].strip()
    if bare in installed(group_of(role)):
        return True
    ours = role == "planner" and name.startswith(tuple(PLANNERS_AT))
    return ":" in name and not ours and not (role in MODEL_ROLES and _is_model(bare, providers))


def find_plugin(role: str, given: object) -> Any:
    """The class, object or function that a text names, with its module imported; errors as those of `make_role`."""
    told = given if isinstance(given, Mapping) else read_role(str(given))
    return _find(role, str(told.get("name", "")))


class FunctionRole:
    """A plain function in place of a role's only verb."""

    outside = True

    def __init__(self, function: Any, verb: str) -> None:
        self._function = function
        self.needs_truth, self.needs_rules = reads_truth(function), bool(getattr(function, "needs_rules", False))
        self.needs_images = bool(getattr(function, "needs_images", False))
        setattr(self, verb, function)

    def __repr__(self) -> str:
        return f"FunctionRole({self._function!r})"


def _construct(role: str, name: str, options: Mapping[str, Any], models: Models | None) -> Any:
    if role in MODEL_ROLES and name not in ROLES[role] and _is_model(name, _providers(models)):
        return _make(load(role, MODEL_ROLES[role]), role, name, {"model": name, "models": models, **options})
    begins = next((text for text in PLANNERS_AT if role == "planner" and name.startswith(text)), None)
    if begins is not None:
        address, argument = PLANNERS_AT[begins]
        where = name if argument == "url" else name.removeprefix(begins)
        return _make(load(role, address), role, name, {argument: where, **options})
    found = _find(role, name)
    if inspect.isclass(found):
        return _make(found, role, name, options)
    if options:
        raise OptionError(f"{role} {name!r} takes no options {dict(options)!r}: it is not a class")
    return found


def _is_model(name: str, providers: Path | str | None) -> bool:
    from remac_agents.llm.resolving import is_model  # only here: no offline role needs the client

    return is_model(name, file=providers)


def _providers(models: Models | None) -> Path | str | None:
    return None if models is None else models.providers


def _find(role: str, name: str) -> Any:
    """The class, object or function of a name."""
    forms = (*FORMS, *(MODEL_FORMS * (role in MODEL_ROLES)), *(PLANNER_FORMS * (role == "planner")))
    more = f"; options: {FORM}" if "," in name else ""
    return find(role, name, own=ROLES[role], group=group_of(role), forms=forms, more=more)


def _make(maker: Any, role: str, name: str, options: Mapping[str, Any]) -> Any:
    try:
        taken = inspect.signature(maker)
    except ValueError:
        return maker(**options)  # made by native code, without a signature: it speaks for itself
    try:
        taken.bind(**options)
    except TypeError as error:
        told = {option: value for option, value in options.items() if option != "models"}
        valid = ", ".join(option for option in taken.parameters if option not in ("model", "models")) or "no options"
        raise OptionError(f"{role} {name!r} does not take {told!r}: {error}; valid: {valid}") from error
    return maker(**options)
