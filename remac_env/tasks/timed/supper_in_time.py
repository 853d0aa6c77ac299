"""Three things have to be in their places by the deadline: too much for one robot."""

from __future__ import annotations

from remac_env.tasks.goals import All, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="SupperInTime",
    wordings=(
        "place the {food} into the microwave, place the {other} into the cabinet, and place the {third} into the "
        "sink, within 110 seconds",
        "place the {third} into the sink, the {other} into the cabinet, and the {food} into the microwave, within"
        " 110 seconds",
        "place the {food} into the microwave, the {other} into the cabinet and the {third} into the sink within "
        "110 seconds",
    ),
    goal=All(
        Inside("{food}", "microwave"),
        Inside("{other}", "cabinet"),
        Inside("{third}", "sink"),
        Released("{food}"),
        Released("{other}"),
        Released("{third}"),
    ),
    roles=(
        Role("food", ("vegetable",), needs=("microwavable",)),
        Role("other", ("fish",)),
        Role("third", ("mug",)),
    ),
    fixtures=("counter", "sink", "microwave", "cabinet"),
    # One robot is slower by the skill table already, where commands take less time than in physics: a search over all
    # that it can do ends without a plan (16 starts, four floor plans). Two take up to 100 s in physics
    # (benchmarks/timed_physics.py), in `galley`, where drives go a long way round each other.
    deadline=110.0,
    layouts=("one_wall_large", "l_shaped_large", "galley", "u_shaped_large"),
    styles=("modern_1", "farmhouse", "scandinavian", "traditional_1"),
)
