"""What nobody needs to look for: what robots feel in their grippers, and that fixtures stay in their places."""

from __future__ import annotations

from remac_agents.roles import Verdict, View
from remac_env.rules.conditions import Condition
from remac_env.rules.predicates import PREDICATES


def untold(condition: Condition, view: View) -> Verdict:
    """What the gripper says, or that nobody carries fixtures about; no value where somebody has to look."""
    row = PREDICATES.get(condition.predicate)
    if row is not None and row.fixtures_always and condition.args[0] in view.scene.fixtures:
        return Verdict(condition, True, "fixtures stay in their places")
    value = condition.felt(view.scene, view.holding)
    return Verdict(condition, value, "" if value is None else "felt in the gripper")
