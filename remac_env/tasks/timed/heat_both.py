"""Heat the fish in the microwave and the vegetable on the stove; what is forgotten on the stove burns."""

from __future__ import annotations

from remac_env.rules.marks import HEATED
from remac_env.tasks.compound import Not
from remac_env.tasks.goals import All, Marked, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="HeatBoth",
    wordings=(
        "place the pan onto the stove, place the {food} into it, turn on the stove, open the microwave door, "
        "place the {other} into the microwave, close its door, turn it on, and turn off the stove once the {food}"
        " is heated",
        "heat the {other} in the microwave, whose door has to be open first, and the {food} on the stove, which "
        "is off in the end",
        "heat the {food} on the stove, turn the stove off, and heat the {other} in the microwave",
    ),
    goal=All(
        Marked("{food}", HEATED),
        Not(SwitchedOn("stove")),
        Marked("{other}", HEATED),
    ),
    roles=(
        Role("food", ("vegetable",), needs=("cookable",)),
        Role("vessel", ("pan",)),
        Role("other", ("fish",), needs=("microwavable",)),
    ),
    fixtures=("counter", "stove", "microwave"),
    processes=(
        ("heating", ()),
        ("burning", ("{food}",)),
        ("timer", ("microwave",)),
    ),
    layouts=("one_wall_large", "l_shaped_large", "galley", "u_shaped_large"),
    styles=("modern_1", "farmhouse", "scandinavian", "traditional_1"),
)
