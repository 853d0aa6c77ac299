"""Place the vegetable into a cabinet whose door falls shut when nobody stands there.

somebody has to keep it open."""

from __future__ import annotations

from remac_env.tasks.goals import All, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="FallingDoor",
    wordings=(
        "open the cabinet door, stay there, and pick up the {food} and place it into the cabinet",
        "place the {food} into the cabinet, somebody has to keep its door open",
        "place the {food} into the cabinet, whose door falls shut",
    ),
    goal=All(
        Inside("{food}", "cabinet"),
        Released("{food}"),
    ),
    roles=(
        Role("food", ("vegetable",)),
    ),
    fixtures=("counter", "cabinet"),
    processes=(
        ("falling_shut", ("cabinet",)),
    ),
    layouts=("one_wall_large", "l_shaped_large", "galley", "u_shaped_large"),
    styles=("modern_1", "farmhouse", "scandinavian", "traditional_1"),
)
