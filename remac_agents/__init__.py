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
from remac_agents.methods import METHODS, register_method
from remac_agents.options import AgentOptions
from remac_agents.plan import Plan, PlanError
from remac_agents.report import Check, EpisodeReport, Exchange, Step, Usage
from remac_agents.roles import Roles, StopEpisode
from remac_agents.running.briefing import Bounds
from remac_agents.wiring.catalogue import ROLES
from remac_agents.wiring.filling import fill_roles
from remac_env.errors import OptionError, check_choice
from remac_env.files import prepare_file
from remac_env.option_rows import takes_options
from remac_env.plugins import group_of, installed
from remac_env.quoting import quoted
from remac_env.values import python_value

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
    "register_method",
    "roles",
]


def methods() -> list[str]:
    """The names of all methods."""
    return list(METHODS)


def roles() -> dict[str, list[str]]:
    """Role -> the names that fill it, those of installed packages (`remac.planners` ...) last."""
    return {role: [*names, *installed(group_of(role))] for role, names in ROLES.items()}


@takes_options(AgentOptions)
def make(name: str, **given: Any) -> Agent:
    """A method with its roles filled.

    A role (planner, conditions, checker, adjuster, reflector, handover, summariser) is a name of `roles()`,
    `package.module:Name`, `path/file.py:Name`, `provider:model`, a mapping {"name": ..., **options}, a function in
    place of the role's only method, or an object with the role's methods (remac_agents.roles). None: the `model` that
    is given, where it can speak for the role, else the offline one of `wiring.filling.DEFAULTS`.

    Args:
        name: one of `methods()`.
        {options}

    Raises:
        UnknownNameError: for an unknown method, role, model or keyword; lists the valid ones.
        OptionError: for a value out of its range, an object that does not fit its role, or a memory that cannot be
            written.
    """
    name = python_value(name)
    check_choice("method", name, METHODS)
    options = AgentOptions(**given)
    who = {role: getattr(options, role) for role in ROLES}
    return Agent(
        METHODS[name],
        fill_roles(who, options, asks_again=METHODS[name].asks_again),
        memory=_memory(options.memory),
        bounds=Bounds(
            rounds=options.max_rounds, retries=options.retries, adjustments=options.max_adjustments
        ),
        lead=options.lead,
        helper=options.helper,
        iterations=options.iterations,
    )


def _memory(given: object) -> Memory:
    if isinstance(given, Memory):
        return given
    if given is not None and not isinstance(given, str | Path):
        raise OptionError(f"memory {quoted(given)} is not valid; valid: a Memory, a path, or None")
    if given is not None:
        prepare_file(given, "memory")
    return Memory(given)

