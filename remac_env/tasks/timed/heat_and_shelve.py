"""Heat the vegetable on the stove and shelve the fish meanwhile; the stove is off in the end, before anything burns."""

from __future__ import annotations

from remac_env.rules.marks import HEATED
from remac_env.tasks.compound import Not
from remac_env.tasks.goals import All, Inside, Marked, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="HeatAndShelve",
    wordings=(
        "place the pan onto the stove, place the {food} into it, turn on the stove, place the {other} into the "
        "cabinet, and turn off the stove once the {food} is heated",
        "place the {other} into the cabinet and heat the {food} on the stove, which is off in the end",
        "heat the {food} on the stove, turn the stove off, and place the {other} into the cabinet",
    ),
    goal=All(
        Marked("{food}", HEATED),
        Not(SwitchedOn("stove")),
        Inside("{other}", "cabinet"),
        Released("{other}"),
    ),
    roles=(
        Role("food", ("vegetable",), needs=("cookable",)),
        Role("vessel", ("pan",)),
        Role("other", ("fish",)),
    ),
    fixtures=("counter", "stove", "cabinet"),
    processes=(
        ("heating", ()),
        ("burning", ()),
    ),
    layouts=("one_wall_large", "l_shaped_large", "galley", "u_shaped_large"),
    styles=("modern_1", "farmhouse", "scandinavian", "traditional_1"),
)
