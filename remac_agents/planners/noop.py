"""The planner that does nothing: the floor of every comparison."""

from __future__ import annotations

from remac_agents.plan import Plan
from remac_agents.roles import PlanRequest


class NoopPlanner:
    """Plans no subtask at all."""

    needs_truth = needs_rules = False

    def plan(self, request: PlanRequest) -> Plan:
        """An empty row for each robot."""
        return Plan.of(dict.fromkeys(request.robots, ()))
