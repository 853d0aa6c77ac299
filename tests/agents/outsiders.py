"""Tasks by someone who has not read the rules: other nouns, other fixtures, other objects that nobody says."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import remac_env
from remac_env.tasks.goals import All, DoorIs, Goal, Inside, Marked, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.vocabulary import Noun

LAYOUT = Path(__file__).resolve().parents[1] / "data" / "scullery_for_tests.toml"

_FIXTURES = (
    Noun("ledge", "fixture", ("place to",)),
    Noun("larder", "fixture", ("place to", "open door", "close door")),
    Noun("hob", "fixture", ("place to", "turn on", "turn off")),
    Noun("basin", "fixture", ("place to",)),
    Noun("spout", "fixture", ("turn on", "turn off")),
    Noun("oven", "fixture", ("place to", "open door", "close door", "turn on", "turn off")),
)
_FOOD = {
    "group": "vegetable",
    "mass": 0.12,
    "friction": [1.0, 0.01, 0.002],
    "rest_height": 0.027,
    "attributes": ["washable"],
    "body": {"form": "ellipsoid", "half": [0.05, 0.030, 0.027]},
    "grasp": {"mode": "side", "height": 0.003, "width": 0.060},
}
_DISH = {
    "group": "vessel",
    "mass": 0.25,
    "friction": [1.0, 0.005, 0.0005],
    "rest_height": 0.0005,
    "holds": 1,
    "inside_height": 0.009,
    "body": {"form": "dish", "radius": 0.100, "base_radius": 0.068, "height": 0.040, "wall": 0.0025},
    "grasp": {"mode": "rim", "height": 0.03, "width": 0.012, "reach": [0.093], "lean": [0.45], "any_yaw": True},
}
CATEGORIES: Mapping[str, Mapping[str, object]] = {
    "herb": {**_FOOD, "roles": ["herb"]},
    "bun": {**_FOOD, "roles": ["bun"]},
    "sponge": {**_FOOD, "roles": ["sponge"], "attributes": []},
    "dumpling": {**_FOOD, "roles": ["dumpling"], "needs_vessel_in": ["stove"]},
    "crab": {**_FOOD, "roles": ["crab"], "needs_vessel_in": ["sink", "microwave"]},
    "pot": {**_DISH, "roles": ["pot"], "vessel_in": ["stove"]},
    "colander": {**_DISH, "roles": ["colander"], "vessel_in": ["sink"]},
    "casserole": {**_DISH, "roles": ["casserole"], "vessel_in": ["microwave"]},
}
_THINGS = tuple(
    Noun(name, "object", ("pick up", "place to") if table.get("holds") else ("pick up",))
    for name, table in CATEGORIES.items()
)


def _task(
    name: str,
    wordings: tuple[str, str, str],
    goal: Goal,
    roles: tuple[Role, ...],
    fixtures: tuple[str, ...],
    verbs: Mapping[str, tuple[str, ...]] | None = None,
) -> TaskSpec:
    return TaskSpec(
        name=name,
        wordings=wordings,
        goal=goal,
        roles=roles,
        fixtures=fixtures,
        verbs=verbs or {},
        layouts=("scullery_for_tests",),
        nouns=(*_FIXTURES, *_THINGS),
        categories=CATEGORIES,
        layout_files={"scullery_for_tests": str(LAYOUT)},
    )


def _on_ledge(name: str, noun: str) -> Role:
    return Role(name, (noun,), at="ledge")


FETCH = _task(  # hidden: the object to fetch stands behind a closed door
    "FetchSponge",
    (
        "open the larder door, pick up the {thing} from the larder and place it into the basin",
        "place the {thing} into the basin, the larder in which it lies has to be opened first",
        "put the {thing} into the basin",
    ),
    All(Inside("{thing}", "basin"), Released("{thing}")),
    (Role("thing", ("sponge",), at="larder"),),
    ("ledge", "larder", "basin"),
)
ROAST = _task(  # hidden: the door is closed, and has to be closed again before it runs
    "RoastBun",
    (
        "open the oven door, pick up the {food}, place it into the oven, close the oven door and turn on the oven",
        "roast the {food} in the oven, whose door is to be opened first and closed then",
        "roast the {food} in the oven",
    ),
    All(Inside("{food}", "oven"), SwitchedOn("oven"), Released("{food}")),
    (_on_ledge("food", "bun"),),
    ("ledge", "oven"),
    {"roast": ("turn on oven",)},
)
BOIL = _task(  # hidden: a dumpling needs a pot, and the pot stands behind a closed door
    "BoilEgg",
    (
        "open the larder door, place the pot onto the hob, place the {food} into the pot and turn on the hob",
        "boil the {food} on the hob, the pot from the larder has to hold it there",
        "boil the {food} on the hob",
    ),
    All(Inside("{food}", "pot"), Inside("pot", "hob"), SwitchedOn("hob", under="pot"), Released("{food}")),
    (_on_ledge("food", "dumpling"), Role("vessel", ("pot",), at="larder")),
    ("ledge", "larder", "hob"),
    {"boil": ("turn on hob",)},
)
RINSE = _task(  # hidden: a crab needs a colander in the basin
    "RinseCrab",
    (
        "place the colander into the basin, place the {food} into the colander and turn on the spout",
        "rinse the {food} in the basin, the colander has to hold it there",
        "rinse the {food} in the basin",
    ),
    All(Inside("{food}", "colander"), Inside("colander", "basin"), SwitchedOn("spout"), Released("{food}")),
    (_on_ledge("food", "crab"), _on_ledge("vessel", "colander")),
    ("ledge", "basin", "spout"),
    {"rinse": ("turn on spout",)},
)
TWO = _task(  # hidden: two doors are closed
    "StashTwo",
    (
        "open the larder door, place the {one} into the larder, open the oven door and place the {other} into the oven",
        "place the {one} into the larder and the {other} into the oven, both have to be opened first",
        "place the {one} into the larder and place the {other} into the oven",
    ),
    All(Inside("{one}", "larder"), Inside("{other}", "oven"), Released("{one}"), Released("{other}")),
    (_on_ledge("one", "herb"), _on_ledge("other", "bun")),
    ("ledge", "larder", "oven"),
)
CROWDED = _task(  # hidden: the door is closed, and something else fills the only slot
    "CrowdedOven",
    (
        "open the oven door, move the sponge from the oven to the ledge and place the {food} into the oven",
        "place the {food} into the oven, the sponge in it has to go first",
        "place the {food} into the oven",
    ),
    All(Inside("{food}", "oven"), Released("{food}")),
    (_on_ledge("food", "bun"), Role("obstacle", ("sponge",), at="oven")),
    ("ledge", "oven"),
)
SHUT = _task(  # hidden: the door is closed at first; said: it is closed in the end
    "ShutLarder",
    (
        "open the larder door, place the {food} into the larder and close the larder door",
        "place the {food} into the larder, which is to be opened first, and close the larder door",
        "place the {food} into the larder and close the larder door",
    ),
    All(Inside("{food}", "larder"), DoorIs("larder", "closed"), Released("{food}")),
    (_on_ledge("food", "herb"),),
    ("ledge", "larder"),
)
WASHED_AWAY = _task(  # hidden: the herb lies behind a door, and the oven is closed too
    "WashHerb",
    (
        "open the larder door, turn on the spout, wash the {food} in the basin, open the oven door and place it there",
        "wash the {food} in the basin and place it into the oven, larder and oven have to be opened first",
        "wash the {food} in the basin, then place it into the oven",
    ),
    All(Marked("{food}", "washed"), Inside("{food}", "oven"), Released("{food}")),
    (Role("food", ("herb",), at="larder"),),
    ("ledge", "larder", "basin", "spout", "oven"),
    {"wash": ("turn on spout",)},
)
TASKS = (FETCH, ROAST, BOIL, RINSE, TWO, CROWDED, SHUT, WASHED_AWAY)


def register() -> None:
    """Make the tasks known."""
    for spec in TASKS:
        remac_env.register_task(spec)
