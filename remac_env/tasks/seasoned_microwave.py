"""Open the microwave, put the vegetable in, season it, close the door: the paper's real-robot task (its Table 3).

Hidden: the microwave door is closed. Scored by its four phases.
"""

from __future__ import annotations

from remac_env.rules.marks import SEASONED
from remac_env.tasks.goals import All, DoorIs, Inside, Marked, Released
from remac_env.tasks.spec import Role, TaskSpec

_IN = All(Inside("{food}", "microwave"), Released("{food}"))
_SEASONED = Marked("{food}", SEASONED)

SPEC = TaskSpec(
    name="SeasonedMicrowave",
    wordings=(
        "open the microwave door, pick up the {food} from the counter and place it into the microwave, "
        "season it with the seasoning and close the microwave door",
        "place the {food} into the microwave, season it with the seasoning and close the microwave door, "
        "which has to be open first",
        "place the {food} into the microwave, season it with the seasoning and close the microwave door",
    ),
    goal=All(Inside("{food}", "microwave"), _SEASONED, DoorIs("microwave", "closed"), Released("{food}")),
    roles=(Role("food", ("vegetable",), needs=("microwavable",)), Role("shaker", ("seasoning",))),
    fixtures=("counter", "microwave"),
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
    phases=(
        ("open microwave", DoorIs("microwave", "open")),
        ("vegetable in microwave", _IN),
        ("seasoned", _SEASONED),
        ("close microwave", DoorIs("microwave", "closed")),
    ),
)
