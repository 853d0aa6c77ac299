"""Put the vegetable into the wall cabinet. Hidden: the cabinet door is closed."""

from __future__ import annotations

from remac_env.tasks.goals import All, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec

SPEC = TaskSpec(
    name="OpenCabinetPnP",
    wordings=(
        "open the cabinet door, pick up the {food} from the counter and place it into the cabinet",
        "pick up the {food} from the counter and place it into the cabinet, the cabinet door has to be open first",
        "place the {food} into the cabinet",
    ),
    goal=All(Inside("{food}", "cabinet", only_on=("plate",)), Released("{food}")),
    roles=(Role("food", ("vegetable",)), Role("plate", ("plate",), at="cabinet")),
    fixtures=("counter", "cabinet"),
    styles=(
        "modern_1", "industrial", "scandinavian", "coastal", "modern_2", "traditional_1", "traditional_2",
        "farmhouse", "rustic", "mediterranean", "transitional_1", "transitional_2",
    ),  # fmt: skip
    layouts=(
        "one_wall_small",
        "one_wall_large",
        "l_shaped_small",
        "l_shaped_large",
        "galley",
        "u_shaped_small",
        "u_shaped_large",
        "g_shaped_large",
    ),
    in_table=True,
)
