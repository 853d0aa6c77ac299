"""Rinse the vegetable under running water, which takes its time, and stow the fish meanwhile."""

from __future__ import annotations

from remac_env.rules.marks import WASHED
from remac_env.tasks.compound import Not
from remac_env.tasks.goals import All, Inside, Marked, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="RinseAndStow",
    wordings=(
        "place the {food} into the sink, turn on the faucet, place the {other} into the microwave, and turn off "
        "the faucet once the {food} is washed",
        "place the {other} into the microwave and wash the {food} in the sink, the faucet is off in the end",
        "wash the {food} in the sink, turn the faucet off, and place the {other} into the microwave",
    ),
    goal=All(
        Marked("{food}", WASHED),
        Not(SwitchedOn("faucet")),
        Inside("{other}", "microwave"),
        Released("{other}"),
    ),
    roles=(
        Role("food", ("vegetable",), needs=("washable",)),
        Role("other", ("fish",), needs=("microwavable",)),
    ),
    fixtures=("counter", "sink", "faucet", "microwave"),
    processes=(
        ("rinsing", ()),
    ),
    layouts=("one_wall_large", "l_shaped_large", "galley", "u_shaped_large"),
    styles=("modern_1", "farmhouse", "scandinavian", "traditional_1"),
)
