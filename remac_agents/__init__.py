"""Planners for REMAC Kitchen: the paper's methods over roles that anyone can fill.

agent = remac_agents.make("REMAC", planner="literal", checker="truth")
for iteration in range(3):
    obs, infos = env.reset(seed=7)
    agent.reset(obs, infos)
    while env.agents:
        obs, _, _, _, infos = env.step(agent.act(obs, infos))
    agent.close_episode(obs, infos)
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from remac_agents.agent import Agent
from remac_agents.memory import Memory, Run
from remac_agents.methods import METHODS
from remac_agents.plan import Plan, PlanError
from remac_agents.report import Check, EpisodeReport, Exchange, Step, Usage
from remac_agents.roles import Roles, StopEpisode
from remac_agents.running.briefing import Bounds
from remac_agents.wiring.catalogue import ROLES
from remac_agents.wiring.filling import fill_roles, read_options
from remac_env.errors import OptionError, check_choice, whole_number
from remac_env.files import prepare_file
from remac_env.plugins import group_of, installed
from remac_env.values import python_value, python_values

__all__ = [
    "Agent",
    "Bounds",
    "Check",
    "EpisodeReport",
    "Exchange",
    "Memory",
    "Plan",
    "PlanError",
    "Roles",
    "Run",
    "Step",
    "StopEpisode",
    "Usage",
    "make",
    "methods",
    "roles",
]


def methods() -> list[str]:
    """The names of all methods."""
    return list(METHODS)


def roles() -> dict[str, list[str]]:
    """Role -> the names that fill it, those of installed packages (`remac.planners` ...) last."""
    return {role: [*names, *installed(group_of(role))] for role, names in ROLES.items()}


def make(
    name: str,
    *,
    planner: Any = None,
    checker: Any = None,
    conditions: Any = None,
    adjuster: Any = None,
    reflector: Any = None,
    handover: Any = None,
    summariser: Any = None,
    memory: Memory | str | Path | None = None,
    retries: int = 2,
    max_adjustments: int = 20,
    max_rounds: int = 60,
    lead: str | None = None,
    helper: str | None = None,
    iterations: int | None = None,
    **models: Any,
) -> Agent:
    """A method with its roles filled.

    Args:
        name: one of `methods()`.
        planner, checker, conditions, adjuster, reflector, handover, summariser: a name of `roles()`,
            `package.module:Name`, `path/file.py:Name`, `provider:model`, a mapping {"name": ..., **options}, a
            function in place of the role's only method, or an object with the role's methods (remac_agents.roles).
            A planner may also be `http://HOST:PORT/PATH` or `answers:FILE.json` (docs/planners.md). None: the
            `model` that is given, where it can speak for the role, else the offline one of `filling.DEFAULTS`.
        memory: a Memory, a path of a JSON-lines file, or None for one in this process.
        retries: how often a subtask whose post-conditions fail is tried again.
        max_adjustments, max_rounds: after so many in an episode the plan is no longer changed, or ends.
        lead: the robot that works alone or leads; None: the first by name.
        helper: the second robot of a team; None: the first by name of the others.
        iterations: number of the last iteration on a start, where it is known; REMAC's team forms by then.
        models: keywords of `filling.ModelOptions`: model, base_url, providers, via, cassette, replay, max_calls,
            max_tokens, max_money, max_seconds, limiter, manners (docs/models.md).

    Raises:
        UnknownNameError: for an unknown method, role or model; lists the valid ones.
        OptionError: for a value out of its range, an object that does not fit its role, or a memory that cannot be
            written.
    """
    name, lead, helper = map(python_value, (name, lead, helper))
    check_choice("method", name, METHODS)
    bounds = _bounds(rounds=max_rounds, retries=retries, adjustments=max_adjustments)
    iterations = None if iterations is None else whole_number("iterations", iterations, 0)
    given = {
        "planner": planner,
        "checker": checker,
        "conditions": conditions,
        "adjuster": adjuster,
        "reflector": reflector,
        "handover": handover,
        "summariser": summariser,
    }
    roles = fill_roles(given, read_options(python_values(models)), asks_again=METHODS[name].asks_again)
    return Agent(
        METHODS[name], roles, memory=_memory(memory), bounds=bounds, lead=lead, helper=helper, iterations=iterations
    )


def _bounds(*, rounds: int, retries: int, adjustments: int) -> Bounds:
    return Bounds(
        rounds=whole_number("max_rounds", rounds, 0),
        retries=whole_number("retries", retries, 0),
        adjustments=whole_number("max_adjustments", adjustments, 0),
    )


def _memory(given: object) -> Memory:
    if isinstance(given, Memory):
        return given
    if given is not None and not isinstance(given, str | Path):
        raise OptionError(f"memory {given!r} is not valid; valid: a Memory, a path, or None")
    if given is not None:
        prepare_file(given, "memory")
    return Memory(given)

