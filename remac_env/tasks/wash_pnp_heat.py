"""Wash the vegetable, then heat it in the microwave. Hidden: the microwave door is closed, and has to be closed again.

The fifth task of the released code; not in the paper's tables.
"""

from __future__ import annotations

from remac_env.rules.marks import WASHED
from remac_env.tasks.goals import All, Inside, Marked, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="WashPnPHeat",
    wordings=(
        "open the microwave door, pick up the {food} from the counter, wash it in the sink, "
        "place it into the microwave, close the microwave door and turn on the microwave",
        "wash the {food} in the sink and heat it in the microwave, the microwave door has to be open first",
        "wash the {food} in the sink, then heat it in the microwave",
    ),
    goal=All(Marked("{food}", WASHED), Inside("{food}", "microwave"), SwitchedOn("microwave"), Released("{food}")),
    roles=(Role("food", ("vegetable",), needs=("washable", "microwavable")),),
    fixtures=("counter", "sink", "faucet", "microwave"),
    verbs={"wash": ("turn on faucet",), "heat": ("turn on microwave",)},
    styles=("modern_1", "farmhouse", "scandinavian", "traditional_1", "transitional_2"),
    layouts=(
        "one_wall_small",
        "one_wall_large",
        "l_shaped_small",
        "l_shaped_large",
        "galley",
        "u_shaped_small",
        "u_shaped_large",
        "g_shaped_small",
        "g_shaped_large",
        "wraparound",
    ),
)
