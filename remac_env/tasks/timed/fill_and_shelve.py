"""Fill the bowl in the sink and shelve the fish meanwhile; the water is off in time, or all runs over."""

from __future__ import annotations

from remac_env.rules.marks import FILLED
from remac_env.tasks.compound import Not
from remac_env.tasks.goals import All, Inside, Marked, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="FillAndShelve",
    wordings=(
        "place the bowl into the sink, turn on the faucet, place the {other} into the cabinet, and turn off the "
        "faucet once the bowl is filled",
        "place the {other} into the cabinet and fill the bowl in the sink, the faucet is off in the end",
        "fill the bowl in the sink, turn the faucet off, and place the {other} into the cabinet",
    ),
    goal=All(
        Marked("bowl", FILLED),
        Not(SwitchedOn("faucet")),
        Inside("{other}", "cabinet"),
        Released("{other}"),
    ),
    roles=(
        Role("vessel", ("bowl",)),
        Role("other", ("fish",)),
    ),
    fixtures=("counter", "sink", "faucet", "cabinet"),
    processes=(
        ("filling", ("{vessel}",)),
        ("overflowing", ("{vessel}",)),
    ),
    layouts=("one_wall_large", "l_shaped_large", "galley", "u_shaped_large"),
    styles=("modern_1", "farmhouse", "scandinavian", "traditional_1"),
)
