"""Rinse the vegetable and then heat it in the microwave, and shelve the fish while either takes its time."""

from __future__ import annotations

from remac_env.rules.marks import HEATED, WASHED
from remac_env.tasks.goals import All, Inside, Marked, Released
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="RinseThenHeat",
    wordings=(
        "place the {food} into the sink, turn on the faucet, place the {other} into the cabinet, place the {food}"
        " into the microwave once it is washed, close the microwave door and turn the microwave on",
        "place the {other} into the cabinet, and wash the {food} in the sink and heat it in the microwave, whose "
        "door has to be open first",
        "wash the {food} in the sink, heat it in the microwave, and place the {other} into the cabinet",
    ),
    goal=All(
        Marked("{food}", WASHED),
        Marked("{food}", HEATED),
        Inside("{other}", "cabinet"),
        Released("{other}"),
    ),
    roles=(
        Role("food", ("vegetable",), needs=("washable", "microwavable")),
        Role("other", ("fish",)),
    ),
    fixtures=("counter", "sink", "faucet", "microwave", "cabinet"),
    processes=(
        ("rinsing", ()),
        ("heating", ()),
        ("timer", ("microwave",)),
    ),
    layouts=("one_wall_large", "l_shaped_large", "galley", "u_shaped_large"),
    styles=("modern_1", "farmhouse", "scandinavian", "traditional_1"),
)
