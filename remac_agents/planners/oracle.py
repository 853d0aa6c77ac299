"""The planner that searches: the shortest plan from the true state of the kitchen to the task's goal."""

from __future__ import annotations

from dataclasses import replace

from remac_agents.plan import Plan, PlanError
from remac_agents.roles import PlanRequest
from remac_env import oracle
from remac_env.rules.facts import Rules
from remac_env.state import FrozenMap, WorldState


class OraclePlanner:
    """Exact search by remac_env.oracle, over the robots that it plans for."""

    needs_truth = needs_rules = True

    def plan(self, request: PlanRequest) -> Plan | PlanError:
        """A shortest plan, or an error where there is none."""
        if request.world is None or request.rules is None or request.goal_test is None:
            return PlanError("the oracle was not given the truth")
        # Who acts by itself reckons with the others: what they hold and where they stand.
        robots = request.facts.robots if request.question == "act" else request.robots
        scene, world = for_robots(request.rules, request.world, robots)
        found = oracle.solve(scene, world, request.goal_test)
        if found is None:
            return PlanError("no plan reaches the goal")
        return Plan.of({robot: [joint[robot] for joint in found.rounds] for robot in request.robots})


def for_robots(scene: Rules, world: WorldState, robots: tuple[str, ...]) -> tuple[Rules, WorldState]:
    """The kitchen with these robots alone."""
    kept = FrozenMap({name: world.robots[name] for name in robots})
    return replace(scene, robots=robots), replace(world, robots=kept)
