"""Heat the vegetable on the stove. Hidden: a pan must hold it."""

from __future__ import annotations

from remac_env.tasks.goals import All, Inside, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="HeatOnStove",
    wordings=(
        "place the pan onto the stove, pick up the {food} from the counter, place it into the pan "
        "and turn on the stove",
        "pick up the {food} from the counter and heat it on the stove, the pan has to hold it there",
        "heat the {food} on the stove",
    ),
    goal=All(
        Inside("{food}", "pan"),
        Inside("pan", "stove"),
        SwitchedOn("stove", under="pan"),
        Released("{food}"),
        Released("pan"),
    ),
    roles=(Role("food", ("vegetable",), needs=("cookable",)), Role("vessel", ("pan",))),
    fixtures=("counter", "stove"),
    verbs={"heat": ("turn on stove",)},
    styles=("industrial", "rustic", "modern_1", "transitional_1", "traditional_2"),
    layouts=(
        "one_wall_small",
        "one_wall_large",
        "l_shaped_small",
        "galley",
        "u_shaped_large",
        "g_shaped_small",
        "wraparound",
    ),
    in_table=True,
)
