"""What a record says of time, where robots do not wait for each other: orders, thoughts, and what lasted how long."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from remac_agents.running.pace import timed
from remac_bench.records import OrderEntry, OutcomeEntry, SpanEntry
from remac_env.envs.event_parallel import STOP
from remac_env.errors import UnknownNameError
from remac_env.thinking import NO_THOUGHT, Thought

MOST_MOMENTS = 3000
"""Moments that a search for the shortest makespan looks at: some ten seconds for two robots."""

Infos = Mapping[str, Mapping[str, Any]]


class StepBook:
    """The steps of one episode: what robots were told, with what thought, and what ended when."""

    def __init__(self) -> None:
        self.orders: list[dict[str, OrderEntry]] = []
        self._at: dict[str, str] = {}

    def order(self, env: Any, actions: Mapping[str, int], infos: Infos, thoughts: Mapping[str, Thought]) -> None:
        """Note what robots are told that must decide, and tell the kitchen what was thought."""
        if not timed(infos):
            return
        told: dict[str, OrderEntry] = {}
        for robot in [robot for robot, info in infos.items() if info["ready"] and robot in actions]:
            thought, text = thoughts.get(robot, NO_THOUGHT), subtask_text(env, actions[robot])
            env.note_thought(robot, thought)
            told[robot] = OrderEntry(
                command=text, tokens=thought.tokens, seconds=thought.seconds, declared=thought.declared
            )
            self._at[robot] = text
        stopped = [r for r, info in infos.items() if not info["ready"] and actions.get(r) == info.get("stop", -1)]
        self.orders.append(told | {robot: OrderEntry(command=STOP) for robot in stopped})

    def ended(self, env: Any, actions: Mapping[str, int], infos: Infos) -> dict[str, OutcomeEntry]:
        """How everything ended that ended in the step: with rounds that is every robot's subtask."""
        if not timed(infos):
            return {
                robot: OutcomeEntry(subtask=subtask_text(env, actions[robot]), **_outcome(info["outcome"]))
                for robot, info in infos.items()
            }
        told = {robot: info["outcome"] for robot, info in infos.items() if info["outcome"]}
        return {robot: OutcomeEntry(subtask=self._at[robot], **_outcome(each)) for robot, each in told.items()}


def replayed(env: Any, orders: Mapping[str, OrderEntry], infos: Infos) -> tuple[dict[str, int], dict[str, Thought]]:
    """The tokens of a step that was recorded, and what had been thought by the robots that had to decide."""
    tokens = {robot: info["continue"] for robot, info in infos.items()}
    tokens |= {robot: token_of(env, order.command) for robot, order in orders.items()}
    decided = {robot: order for robot, order in orders.items() if order.command != STOP}
    return tokens, {robot: Thought(each.tokens, each.seconds, each.declared) for robot, each in decided.items()}


def timeline(env: Any) -> list[SpanEntry]:
    """What lasted how long in the episode; nothing with rounds, whose outcomes say it."""
    return [SpanEntry(**span.as_values) for span in getattr(env, "timeline", ())]


def shortest(env: Any) -> dict[str, Any]:
    """The fields of a record that say how soon the episode could be done, by the skill table's seconds."""
    from remac_env.events.makespan import makespan

    found = makespan(env.start, env.goal, deadline=env.max_seconds, max_states=MOST_MOMENTS)
    return {"optimum_seconds": found.optimum, "optimum_seconds_lower": found.lower}


def subtask_text(env: Any, token: int) -> str:
    """What records call a token: its command, or "token N" for one that names nothing."""
    try:
        return str(env.vocabulary.decode(int(token)))
    except UnknownNameError:
        return f"token {int(token)}"


def token_of(env: Any, text: str) -> int:
    """The token of what `subtask_text` says."""
    number = odd_token(text)
    return int(env.vocabulary.encode(text)) if number is None else number


def odd_token(text: str) -> int | None:
    """The number of a token that names no subtask; None for a subtask."""
    found = re.fullmatch(r"token (-?[0-9]{1,18})", text)
    return None if found is None else int(found[1])


def _outcome(told: Mapping[str, Any]) -> dict[str, Any]:
    """An outcome as records have it: None where there is no reason."""
    return {**told, "reason": told["reason"] or None} if told else {"status": "failure"}
