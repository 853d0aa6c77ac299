"""A task from outside, with a kitchen, fixtures and objects that the suite does not know."""

from __future__ import annotations

from pathlib import Path

from remac_env.tasks.goals import All, Inside, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.vocabulary import Noun

LAYOUT = Path(__file__).resolve().parents[1] / "data" / "galley_for_tests.toml"

_LOAF = {
    "group": "vegetable",
    "roles": ["bread"],
    "mass": 0.2,
    "friction": [1.0, 0.01, 0.002],
    "rest_height": 0.027,
    "needs_vessel_in": ["cabinet"],
    "body": {"form": "ellipsoid", "half": [0.06, 0.030, 0.027]},
    "grasp": {"mode": "side", "height": 0.003, "width": 0.060},
}
_TRAY = {
    "group": "vessel",
    "mass": 0.25,
    "friction": [1.0, 0.005, 0.0005],
    "rest_height": 0.0005,
    "vessel_in": ["cabinet"],
    "holds": 1,
    "inside_height": 0.009,
    "body": {"form": "dish", "radius": 0.100, "base_radius": 0.068, "height": 0.040, "wall": 0.0025},
    "grasp": {"mode": "rim", "height": 0.03, "width": 0.012, "reach": [0.093], "lean": [0.45], "any_yaw": True},
}

STORE_BREAD = TaskSpec(
    name="StoreBread",
    wordings=(
        "open the pantry door, place the tray into the pantry, place the {food} into the tray and turn on the tap",
        "store the {food} in the pantry, the tray has to hold it there",
        "store the {food} in the pantry",
    ),
    goal=All(
        Inside("{food}", "{vessel}"),
        Inside("{food}", "pantry", only_on=("{vessel}",)),
        SwitchedOn("tap"),
        Released("{food}"),
        Released("{vessel}"),
    ),
    roles=(Role("food", ("bread",), at="bench"), Role("vessel", ("tray",), at="bench")),
    fixtures=("bench", "pantry", "tap"),
    verbs={"store": ("turn on tap",)},
    layouts=("galley_for_tests",),
    nouns=(
        Noun("bench", "fixture", ("place to",)),
        Noun("pantry", "fixture", ("place to", "open door", "close door")),
        Noun("tap", "fixture", ("turn on", "turn off")),
        Noun("bread", "object", ("pick up",)),
        Noun("tray", "object", ("pick up", "place to")),
    ),
    categories={"loaf": _LOAF, "tray": _TRAY},
    layout_files={"galley_for_tests": str(LAYOUT)},
)
