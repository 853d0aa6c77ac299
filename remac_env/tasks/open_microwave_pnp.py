"""Put the vegetable into the microwave. Hidden: the microwave door is closed."""

from __future__ import annotations

from remac_env.tasks.goals import All, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="OpenMicrowavePnP",
    wordings=(
        "open the microwave door, pick up the {food} from the counter and place it into the microwave",
        "pick up the {food} from the counter and place it into the microwave, the microwave door has to be open first",
        "place the {food} into the microwave",
    ),
    goal=All(Inside("{food}", "microwave"), Released("{food}")),
    roles=(Role("food", ("vegetable",), needs=("microwavable",)), Role("plate", ("plate",), at="microwave")),
    fixtures=("counter", "microwave"),
    styles=("farmhouse", "modern_1", "scandinavian", "traditional_1", "transitional_2"),
    layouts=(
        "one_wall_small",
        "one_wall_large",
        "l_shaped_large",
        "galley",
        "u_shaped_small",
        "g_shaped_small",
        "g_shaped_large",
        "wraparound",
    ),
    in_table=True,
)
