"""Defrost fish or meat under running water. Hidden: a bowl must hold it."""

from __future__ import annotations

from remac_env.tasks.goals import All, Inside, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="DefrostInBowl",
    wordings=(
        "place the bowl into the sink, pick up the {food} from the counter, place it into the bowl "
        "and turn on the faucet",
        "pick up the {food} from the counter and defrost it in the sink, the bowl has to hold it there",
        "defrost the {food} in the sink",
    ),
    goal=All(
        Inside("{food}", "bowl"),
        Inside("bowl", "sink"),
        SwitchedOn("faucet"),
        Released("{food}"),
        Released("bowl"),
    ),
    roles=(Role("food", ("fish", "meat"), needs=("freezable",)), Role("vessel", ("bowl",))),
    fixtures=("counter", "sink", "faucet"),
    verbs={"defrost": ("turn on faucet",)},
    styles=("coastal", "mediterranean", "modern_2", "traditional_2", "transitional_1"),
    layouts=(
        "one_wall_large",
        "l_shaped_small",
        "l_shaped_large",
        "u_shaped_large",
        "g_shaped_small",
        "wraparound",
    ),
    in_table=True,
)
