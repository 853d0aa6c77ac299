"""Heat the vegetable in the microwave, which turns itself off, and fill the bowl meanwhile."""

from __future__ import annotations

from remac_env.rules.marks import FILLED, HEATED
from remac_env.tasks.compound import Not
from remac_env.tasks.goals import All, Marked, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="MicrowaveAndFill",
    wordings=(
        "open the microwave door, place the {food} into the microwave, close its door, turn it on, place the bowl"
        " into the sink, turn on the faucet, and turn it off once the bowl is filled",
        "fill the bowl in the sink, the faucet is off in the end, and heat the {food} in the microwave, whose "
        "door has to be open first",
        "heat the {food} in the microwave, and fill the bowl in the sink and turn the faucet off",
    ),
    goal=All(
        Marked("{food}", HEATED),
        Marked("bowl", FILLED),
        Not(SwitchedOn("faucet")),
    ),
    roles=(
        Role("food", ("vegetable",), needs=("microwavable",)),
        Role("vessel", ("bowl",)),
    ),
    fixtures=("counter", "sink", "faucet", "microwave"),
    processes=(
        ("heating", ("{food}",)),
        ("timer", ("microwave",)),
        ("filling", ("{vessel}",)),
        ("overflowing", ("{vessel}",)),
    ),
    layouts=("one_wall_large", "l_shaped_large", "galley", "u_shaped_large"),
    styles=("modern_1", "farmhouse", "scandinavian", "traditional_1"),
)
