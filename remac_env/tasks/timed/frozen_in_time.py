"""Shut the fish and the meat away before they have melted: too much for one robot."""

from __future__ import annotations

from remac_env.tasks.goals import All, DoorIs, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="FrozenInTime",
    wordings=(
        "open the cabinet door, place the {food} into the cabinet and close its door, open the microwave door, "
        "place the {other} into the microwave and close its door, before either has melted",
        "place the {other} into the microwave and the {food} into the cabinet, and have both doors closed before "
        "either has melted",
        "place the {food} into the cabinet and the {other} into the microwave, and close both doors before they "
        "have melted",
    ),
    goal=All(
        Inside("{food}", "cabinet"),
        DoorIs("cabinet", "closed"),
        Inside("{other}", "microwave"),
        DoorIs("microwave", "closed"),
        Released("{food}"),
        Released("{other}"),
    ),
    roles=(
        Role("food", ("fish",), needs=("freezable",)),
        Role("other", ("meat",), needs=("freezable",)),
    ),
    fixtures=("counter", "cabinet", "microwave"),
    processes=(
        ("melting", ("{food}", "{other}")),
    ),
    layouts=("one_wall_large", "l_shaped_large", "galley", "u_shaped_large"),
    styles=("modern_1", "farmhouse", "scandinavian", "traditional_1"),
)
