"""Checks actions before anything moves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from remac_env.errors import ActionError
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.values import python_value


def check_actions(actions: Mapping[str, Any], agents: Sequence[str]) -> dict[str, int]:
    """Whole numbers, one for each agent.

    Raises:
        ActionError: naming the agent whose action is missing, unexpected or not a whole number.
    """
    if not isinstance(actions, Mapping):
        raise ActionError(f"actions must map agents to tokens, got {type(actions).__name__}; agents: {list(agents)}")
    if actions.keys() != set(agents):
        missing = [name for name in agents if name not in actions]
        problem = f"missing {missing}, unexpected {[name for name in actions if name not in agents]}"
        raise ActionError(f"actions for the wrong agents: {problem}; agents: {list(agents)}")
    return {name: check_token(actions[name], name) for name in agents}


def decode(
    tokens: Mapping[str, int], legal: Mapping[int, Subtask]
) -> tuple[dict[str, Subtask], dict[str, Outcome]]:
    """Subtasks of legal tokens; the others wait and are `invalid`."""
    subtasks = {name: legal.get(token, WAIT) for name, token in tokens.items()}
    strange = {name: token for name, token in tokens.items() if token not in legal}
    return subtasks, {n: failure("invalid", f"token {t} names nothing in this kitchen") for n, t in strange.items()}


def check_token(value: Any, name: str) -> int:
    """`value` as an int.

    Raises:
        ActionError: unless it is an integer, or a NumPy array of one integer. Floats, NaN and booleans are refused.
    """
    if type(value) is int:
        return value
    token = python_value(value)
    if isinstance(token, bool) or not isinstance(token, int):
        raise ActionError(f"action of {name} is {value!r} ({type(value).__name__}); valid: a whole number, a token")
    return token
