"""The exact hand-over: the fewest rounds in which a team reaches what the single-robot plan reaches."""

from __future__ import annotations

import math
from collections.abc import Sequence

from remac_agents.handovers.reflections import ReflectionHandover
from remac_agents.plan import Plan
from remac_agents.planners.oracle import for_robots
from remac_agents.roles import HandoverRequest
from remac_env.errors import whole_number
from remac_env.oracle import most_states, search_plan
from remac_env.rules.facts import Rules
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import STEP_ASIDE, Subtask
from remac_env.state import FixtureState, Place, WorldState

MAX_STATES = 60_000
"""States to look at before the search gives up."""


_Result = tuple[dict[str, tuple[str, str]], dict[str, FixtureState], dict[str, frozenset[str]]]


class SearchHandover:
    """Searches over the single-robot plan's subtasks; falls back to the paper's hand-over if that fails."""

    needs_truth = needs_rules = True
    tries_company = True

    def __init__(self, *, max_states: int = MAX_STATES) -> None:
        """Args: max_states: where to give up."""
        self._max_states = whole_number("max_states", max_states, 1)
        self._fallback = ReflectionHandover()

    def share(self, request: HandoverRequest) -> Plan | None:
        """A shortest plan for the team, or None where nothing is gained.

        Raises:
            ValueError: if it was not given the world.
        """
        if request.view.world is None or request.view.rules is None:
            raise ValueError(
                "the searching hand-over was not given the WorldState; infos[robot]['world'] is missing"
            )
        if request.kept or request.failing:  # the search knows of nothing that happens by itself
            return self._fallback.share(request)
        scene, world = for_robots(request.view.rules, request.view.world, request.team)
        wanted = _result(scene, _simulate(scene, world, request.lead, request.plan))
        found = search_plan(
            scene,
            world,
            lambda state: _result(scene, state) == wanted,
            commands=[*dict.fromkeys(request.plan), STEP_ASIDE],
            bound=lambda state: _rounds_at_least(_result(scene, state), wanted, len(scene.robots)),
            max_rounds=len(request.plan),
            max_states=min(self._max_states, most_states(scene)),
        )
        if found is None:
            return self._fallback.share(request)
        if found.length >= len(request.plan):
            return None
        return Plan.of({name: [joint[name] for joint in found.rounds] for name in scene.robots})


def _simulate(scene: Rules, world: WorldState, robot: str, steps: Sequence[Subtask]) -> WorldState:
    """The world after the plan, by the skill table."""
    for step in steps:
        world, _ = transition(scene, world, {robot: step})
    return world


def _result(scene: Rules, world: WorldState) -> _Result:
    """What counts as the same end: places, doors, switches and marks, but not which of several like slots."""
    places = {name: _where(scene, item.place) for name, item in world.objects.items()}
    if len(scene.robots) > 2:  # then the search takes robots for alike
        places = {name: (relation, "" if relation == "held" else where) for name, (relation, where) in places.items()}
    return places, dict(world.fixtures), {name: item.marks for name, item in world.objects.items()}


def _rounds_at_least(now: _Result, wanted: _Result, robots: int) -> int:
    """A lower bound: an object out of place is still to be taken up and placed, a fixture to be worked once.

    One round may leave marks on many objects, and move what leaves them: marks alone count for one round.
    """
    steps = [1 if place[0] == "held" else 2 for name, place in now[0].items() if place != wanted[0][name]]
    steps += [1 for name, state in now[1].items() if state != wanted[1][name]]
    return max(max(steps, default=0), math.ceil(sum(steps) / robots), int(now[2] != wanted[2]))


def _where(scene: Rules, place: Place) -> tuple[str, str]:
    if place.relation != "slot":
        return place.relation, place.where
    fixture = scene.slots[place.where].fixture
    return "slot", place.where if scene.fixtures[fixture].switch_per_slot else fixture
