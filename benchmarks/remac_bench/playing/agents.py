"""What the benchmark knows of remac_agents: methods, roles, options and the models that they ask."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from remac_agents.options import AgentOptions
from remac_bench.errors import UsageError
from remac_env.errors import OptionError, check_choice
from remac_env.option_rows import Switch, option, rows, same
from remac_env.quoting import quoted

DEFAULT_ITERATIONS = 2
"""RE and REMAC play iterations 0, 1, 2: learn, plan with what was learnt, share the work."""


def _keywords(*groups: str) -> tuple[str, ...]:
    return tuple(name for group in groups for name, row in rows(AgentOptions).items() if row.group == group)


ROLES = _keywords("role")
"""Keywords of `remac_agents.make` that name a role."""

BUDGET = _keywords("budget")
"""Its keywords that bound what a job may spend on language models."""

BOUNDS = _keywords("bound")
"""Its keywords that bound what an agent does in an episode."""

PERSON = "human"
"""The method of a person who plays, and the planner that it is made for."""

OPTIONS = (*ROLES, "model", *BUDGET, *BOUNDS, *_keywords("robot"))
"""Its keywords that a job may set. Not `memory`: every job has one of its own."""


@dataclass(frozen=True, kw_only=True)
class Access:
    """How language models, and roles that are code from outside, are reached."""

    base_url: str | None = same(AgentOptions, "base_url")
    providers: str | None = same(AgentOptions, "providers")
    cassette: str | None = same(AgentOptions, "cassette")
    replay: bool = same(AgentOptions, "replay")
    isolated: bool = option(
        True, "Code from outside runs in processes of its own; tables say so where it does not.", Switch(),
        flag="--isolation/--no-isolation",
    )  # fmt: skip

    @property
    def told(self) -> dict[str, Any]:
        """For the record: files without their folders, and the digest of the providers'."""
        name = None if self.cassette is None else Path(self.cassette).name
        told = {"base_url": self.base_url, "cassette": name, "replay": self.replay}
        told |= {} if self.isolated else {"isolated": False}
        if self.providers is None:
            return told
        from remac_agents.llm.provider_files import digest

        return {**told, "providers": f"{Path(self.providers).name} {digest(self.providers)}"}

    @classmethod
    def recorded(cls, told: Mapping[str, Any]) -> Access:
        """What a record tells of it: no file that could be read again.

        Raises:
            OptionError: for what no version writes.
        """
        given = {name: value for name, value in told.items() if name != "providers"}
        for name, value in given.items():
            if not isinstance(value, bool if name in ("replay", "isolated") else str | None):
                raise OptionError(f"access.{name} {quoted(value)} is not valid; valid: as a run writes it")
        return cls(**given)


def asked_models(agent: Mapping[str, Any], *, providers: str | None = None) -> list[str]:
    """The language models that an agent with these options asks; none for an offline one.

    Args:
        providers: see Access.
    """
    from remac_agents.wiring.catalogue import ROLES as KNOWN

    named = [_bare(agent["model"])] if "model" in agent else []
    for name in ROLES:
        text = _bare(agent.get(name, ""))
        if text and text not in KNOWN[name] and is_model(text, providers):
            named.append(text)
    return sorted(set(named))


def is_model(text: str, providers: str | None = None) -> bool:
    """Whether a name speaks of a language model of a known provider."""
    from remac_agents.llm.resolving import is_model as known

    return known(text, file=providers)


def check_reach(*, via: str | None, providers: str | None) -> None:
    """Refuse a provider, or a file of providers, that is not valid, also where no model is asked.

    Raises:
        UnknownNameError, OptionError: naming what is valid.
    """
    if via is None and providers is None:
        return
    from remac_agents.llm.resolving import load

    catalogue = load(providers)
    if via is not None:
        catalogue.check_via(via)


def by_route(text: str, *, via: str | None, providers: str | None = None) -> str:
    """A role, or a model, with options: one that names a model of the paper gets the route by which it is reached.

    Raises:
        UnknownNameError, OptionError: see `remac_agents.llm.resolving.route`.
    """
    name, comma, options = text.partition(",")
    if via is None or not is_model(name.strip(), providers):
        return text
    from remac_agents.llm.resolving import route

    return route(name.strip(), via=via, file=providers) + comma + options


def _bare(text: object) -> str:
    """The name of a role or model without its options."""
    return str(text).partition(",")[0].strip()


def with_planner(method: str, agent: Mapping[str, Any]) -> dict[str, Any]:
    """An agent's keywords; with the planner that its method is made for, where that is a person and none is given."""
    return {**({"planner": PERSON} if method == PERSON else {}), **agent}


def asks_person(agent: Mapping[str, Any]) -> bool:
    """Whether an agent with these keywords asks somebody who types."""
    return _bare(agent.get("planner", "")) == PERSON


def role(text: object) -> object:
    """A role from its text: "noisy", "package.module:Name", or with options "noisy,miss=0.2".

    Raises:
        UsageError: for an option that is not name=value.
    """
    from remac_agents.wiring.catalogue import read_role

    if not isinstance(text, str) or "," not in text:
        return text
    try:
        return read_role(text)
    except OptionError as error:
        raise UsageError(f"role {error}") from error


def reflector_of(planner: str, *, providers: str | None = None) -> str:
    """Who reflects on what a planner learns itself: the same model with the same options, or the rules."""
    return planner if is_model(_bare(planner), providers) else "rule"


def changed_options(given: Mapping[str, Any]) -> dict[str, Any]:
    """Those keywords of `remac_agents.make` that are given (not None) and not at their defaults.

    With a model every role that is given counts: a role that is not is the model's.

    Raises:
        OptionError: for an invalid bound on what models may take.
    """
    from remac_agents.wiring.filling import DEFAULTS


    known = rows(AgentOptions)
    for name in BUDGET:
        known[name].check(name, given.get(name))
    kept = {name: value for name, value in given.items() if value is not None}
    defaults = {name: row.default for name, row in known.items()}
    if "model" not in kept:
        defaults |= DEFAULTS
    return {name: value for name, value in kept.items() if value != defaults.get(name)}


def methods() -> list[str]:
    """The names of all methods."""
    import remac_agents

    return list(remac_agents.methods())


def planners() -> list[str]:
    """The names of all planners that come along."""
    from remac_agents.wiring.catalogue import ROLES

    return list(ROLES["planner"])


def methods_to_compare() -> list[str]:
    """The same, with the controls of an equal budget right behind the methods that learn."""
    from remac_agents.methods import METHODS

    names = list(METHODS)
    learners = [names.index(name) for name, method in METHODS.items() if method.remembers]
    last = max(learners, default=-1) + 1
    controls = [name for name in names if is_control(name)]
    others = [name for name in names if name not in controls]
    return [*others[:last], *controls, *others[last:]]


def is_control(method: str) -> bool:
    """Whether a method has further tries and learns nothing from them."""
    from remac_agents.methods import METHODS

    return method in METHODS and METHODS[method].iterates and not METHODS[method].remembers


def is_learner(method: str) -> bool:
    """Whether a method has further tries and learns from them."""
    from remac_agents.methods import METHODS

    return method in METHODS and METHODS[method].iterates and METHODS[method].remembers


def default_robots(method: str) -> int:
    """How many robots a method is made for."""
    from remac_agents.methods import METHODS

    check_choice("method", method, METHODS)
    return METHODS[method].robots


def default_iterations(method: str) -> int:
    """The number of a method's last iteration: 0 for one that would only play the same again."""
    from remac_agents.methods import METHODS

    check_choice("method", method, METHODS)
    return DEFAULT_ITERATIONS if METHODS[method].iterates else 0
