"""Rounds rehearsed by the event clock in the skill table: a plan then knows how long what goes on by itself takes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from remac_env.backends.symbolic import SymbolicBackend
from remac_env.events.clock import EventClock, Order
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.start import Start
from remac_env.state import WorldState

Choose = Callable[[WorldState, Mapping[str, float]], Mapping[str, Subtask] | None]
"""From the world and what goes on by itself (`EventClock.going_on`), what every robot does in the next round; None: it
is over."""


def rehearse(rules: Rules, world: WorldState, choose: Choose, *, rounds: int) -> list[Mapping[str, Subtask]]:
    """The rounds that are chosen, at most so many. What takes its time begins anew; a round ends when all have ended.

    A round of waits alone lasts until something happens, 5 s at most, as in an episode.
    """
    backend = SymbolicBackend()
    backend.reset(Start(rules, world, "", "", {}, {}, {}, {}, seed=0))
    clock, played = EventClock(backend, rules, deadline=math.inf), list[Mapping[str, Subtask]]()
    while len(played) < rounds and (joint := choose(backend.world, clock.going_on)) is not None:
        played.append(joint)
        told = set(clock.run({robot: Order(step) for robot, step in joint.items()}))
        while len(told) < len(joint) or len(clock.ready) < len(joint):
            told |= clock.run({robot: Order(WAIT) for robot in clock.ready}).keys()
    return played
