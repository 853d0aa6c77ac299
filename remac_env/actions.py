"""Checks actions before anything moves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from remac_env.errors import ActionError, check_choice
from remac_env.quoting import quoted
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.values import python_value


def check_actions(actions: Mapping[str, Any], agents: Sequence[str]) -> dict[str, int]:
    """Whole numbers, one for each agent.

    Raises:
        ActionError: naming the agent whose action is missing, unexpected or not a whole number.
    """
    if not isinstance(actions, Mapping):
        raise ActionError(f"actions must map agents to tokens, got {type(actions).__name__}; valid: {list(agents)}")
    if actions.keys() != set(agents):
        missing = [name for name in agents if name not in actions]
        problem = f"missing {missing}, unexpected {quoted([name for name in actions if name not in agents])}"
        raise ActionError(f"actions for the wrong agents: {problem}; valid: {list(agents)}")
    return {name: check_token(actions[name], name) for name in agents}


def decode(
    tokens: Mapping[str, int], legal: Mapping[int, Subtask]
) -> tuple[dict[str, Subtask], dict[str, Outcome]]:
    """Subtasks of legal tokens; the others wait and are `invalid`."""
    subtasks = {name: legal.get(token, WAIT) for name, token in tokens.items()}
    strange = {name: token for name, token in tokens.items() if token not in legal}
    told = {name: f"token {quoted(token)} names nothing in this kitchen" for name, token in strange.items()}
    return subtasks, {name: failure("invalid", words) for name, words in told.items()}


def check_robot(name: Any, robots: Sequence[str]) -> str:
    """`name`, where it is one of these robots.

    Raises:
        UnknownNameError: otherwise.
    """
    if type(name) is not str or name not in robots:
        check_choice("robot", name, robots)
    return str(name)


def check_token(value: Any, name: str) -> int:
    """`value` as an int.

    Raises:
        ActionError: unless it is an integer, or a NumPy array of one integer. Floats, NaN and booleans are refused.
    """
    if type(value) is int:
        return value
    token = python_value(value)
    if isinstance(token, bool) or not isinstance(token, int):
        given = f"{quoted(value)} ({type(value).__name__})"
        raise ActionError(f"action of {name} is {given}; valid: a whole number, a token")
    return token
