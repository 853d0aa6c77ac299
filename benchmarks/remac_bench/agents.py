"""The one place where the benchmark meets remac_agents."""

from __future__ import annotations

import inspect
import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

from remac_bench.errors import UsageError
from remac_env.errors import check_choice

if TYPE_CHECKING:
    from remac_bench.jobs import Job

DEFAULT_ITERATIONS = 2
"""RE and REMAC play iterations 0, 1, 2: learn, plan with what was learnt, share the work."""


ROLES = ("planner", "conditions", "checker", "adjuster", "reflector", "handover", "summariser")
"""Keywords of `remac_agents.make` that name a role."""

OPTIONS = (*ROLES, "retries", "max_adjustments", "max_rounds", "lead", "helper")
"""Its keywords that a job may set. Not `memory`: every job has one of its own."""


class Agent(Protocol):
    """What the runner asks of an agent."""

    def reset(self, observations: Any, infos: Any) -> None:
        """Begin an episode."""

    def act(self, observations: Any, infos: Any) -> dict[str, int]:
        """A token for every robot."""

    def close_episode(self, observations: Any, infos: Any) -> None:
        """End an episode; what was learnt goes into the memory."""

    def report(self) -> Any:
        """What the episode leaves behind: remac_agents' EpisodeReport."""


def make(job: Job) -> Agent:
    """The job's agent, with a memory of its own that lives in this process.

    Raises:
        UnknownNameError, OptionError: for a method, planner or other role that does not exist.
    """
    import remac_agents

    options: dict[str, Any] = {
        name: role(value) if name in ROLES else value for name, value in job.agent.items()
    }
    agent: Agent = remac_agents.make(job.method, **options)
    return agent


def role(text: object) -> object:
    """A role from its text: "noisy", "package.module:Name", or with options "noisy,miss=0.2".

    Raises:
        UsageError: for an option that is not name=value.
    """
    if not isinstance(text, str) or "," not in text:
        return text
    name, *options = (part.strip() for part in text.split(","))
    read: dict[str, Any] = {"name": name}
    for option in options:
        key, equals, value = option.partition("=")
        if not key.isidentifier() or not equals:
            raise UsageError(f"role {text!r}: {option!r} is not valid; valid: name,option=value,option=value")
        try:
            read[key] = json.loads(value)
        except json.JSONDecodeError:
            read[key] = value
    return read


def changed_options(given: Mapping[str, Any]) -> dict[str, Any]:
    """Those keywords of `remac_agents.make` that are given (not None) and not at their defaults."""
    import remac_agents

    parameters = inspect.signature(remac_agents.make).parameters
    return {n: v for n, v in given.items() if v is not None and v != parameters[n].default}


def methods() -> list[str]:
    """The names of all methods."""
    import remac_agents

    return list(remac_agents.methods())


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
