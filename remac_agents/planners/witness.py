"""The planner that knows everything and is in no hurry: a plan that works, found part after part, not the shortest."""

from __future__ import annotations

from remac_agents.plan import Plan, PlanError
from remac_agents.planners.oracle import for_robots
from remac_agents.roles import PlanRequest
from remac_env.oracle.witness import witness


class WitnessPlanner:
    """Search for one part of the goal after the other (remac_env.oracle.witness), for goals too long for the oracle."""

    needs_truth = needs_rules = True

    def plan(self, request: PlanRequest) -> Plan | PlanError:
        """A plan that works, or an error where none was found."""
        if request.world is None or request.rules is None or request.goal_test is None:
            return PlanError("the witness was not given the truth")
        scene, world = for_robots(request.rules, request.world, request.robots)
        found = witness(scene, world, request.goal_test)
        if found is None:
            return PlanError("no plan was found")
        return Plan.of({robot: [joint[robot] for joint in found.rounds] for robot in request.robots})
