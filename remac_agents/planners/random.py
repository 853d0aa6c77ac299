"""The planner that rolls dice: legal commands, drawn from a generator of the episode."""

from __future__ import annotations

from remac_agents.plan import MAX_STEPS, Commands, Plan
from remac_agents.roles import PlanRequest
from remac_env.errors import whole_number
from remac_env.seeding import generator


class RandomPlanner:
    """Draws commands at random.

    Args:
        steps: how many subtasks a robot gets, 0..200.
    """

    needs_truth = needs_rules = False

    def __init__(self, *, steps: int = 12) -> None:
        self.steps = whole_number("steps", steps, 0, MAX_STEPS)
        self._seed, self._iteration = 0, 0

    def begin_episode(self, seed: int, iteration: int) -> None:
        """Draw what this seed and iteration hold."""
        self._seed, self._iteration = seed, iteration

    def plan(self, request: PlanRequest) -> Plan:
        """For each robot a row of random commands other than `done`."""
        options = [subtask for subtask in Commands(request.commands).values() if subtask.skill != "done"]
        rows = {}
        for robot in request.robots:
            chance = generator(self._seed, "random planner", self._iteration, robot)
            rows[robot] = [options[int(index)] for index in chance.integers(len(options), size=self.steps)]
        return Plan.of(rows)
