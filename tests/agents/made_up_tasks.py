"""Kitchens that nobody ships: other nouns, other hidden constraints."""

from __future__ import annotations

from agent_kitchens import MadeUpKitchen

from remac_env.rules.facts import FixtureFacts, ObjectFacts
from remac_env.tasks.goals import All, DoorIs, Inside, Marked, SwitchedOn

BENCH = FixtureFacts("bench", "bench", "bench_left", slots=("bench.0", "bench.1", "bench.2", "bench.3"))
STATIONS = {"bench.2": "bench_right", "bench.3": "bench_right"}


def towels(**changes: object) -> MadeUpKitchen:
    """Hidden: the dryer's door is closed, and it runs only when shut again."""
    dryer = FixtureFacts(
        "dryer", "dryer", "dryer", door=True, switches=("dryer",), slots=("dryer.0",), shut_to_run=True
    )
    settings: dict[str, object] = {
        "name": "DryTowel",
        "sentence": "dry the towel in the dryer",
        "goal": All(Inside("towel", "dryer"), DoorIs("dryer", "closed"), SwitchedOn("dryer")),
        "fixtures": {"bench": BENCH, "dryer": dryer},
        "objects": {"towel": ObjectFacts("towel", "towel"), "soap": ObjectFacts("soap", "soap")},
        "places": {"towel": "bench.0", "soap": "bench.3"},
        "verbs": {"dry": ("turn on dryer",)},
        "slot_stations": STATIONS,
    }
    return MadeUpKitchen(**(settings | changes))  # type: ignore[arg-type]


def dough(**changes: object) -> MadeUpKitchen:
    """Hidden: dough needs a tray in the furnace."""
    furnace = FixtureFacts("furnace", "furnace", "furnace", slots=("furnace.0",))
    lamp = FixtureFacts("burner plate", "lamp", "furnace", switches=("burner plate",))
    settings: dict[str, object] = {
        "name": "BakeDough",
        "sentence": "bake the dough in the furnace",
        "goal": All(Inside("dough", "tray"), Inside("tray", "furnace"), SwitchedOn("burner plate")),
        "fixtures": {"bench": BENCH, "furnace": furnace, "burner plate": lamp},
        "objects": {
            "dough": ObjectFacts("dough", "dough", needs_vessel_in=frozenset({"furnace"})),
            "tray": ObjectFacts("tray", "tray", vessel_in=frozenset({"furnace"}), holds=2),
        },
        "places": {"dough": "bench.0", "tray": "bench.2"},
        "verbs": {"bake": ("turn on burner plate",)},
        "slot_stations": STATIONS,
    }
    return MadeUpKitchen(**(settings | changes))  # type: ignore[arg-type]


BASIN = FixtureFacts("basin", "basin", "basin", slots=("basin.0", "basin.1"))
TAP = FixtureFacts("tap", "tap", "basin", switches=("tap",), wets=("basin",))
LOCKER = FixtureFacts("locker", "locker", "locker", door=True, slots=("locker.0",))
CHEST = FixtureFacts("chest", "chest", "chest", door=True, slots=("chest.0",))


def washings(**changes: object) -> MadeUpKitchen:
    """Two objects are washed in one basin and put away behind two doors; 11 rounds at least (searched once)."""
    settings: dict[str, object] = {
        "name": "WashTwo",
        "sentence": "wash the plum in the basin, place it into the locker, wash the pear in the basin and place it "
        "into the chest",
        "goal": All(
            Marked("plum", "washed"), Marked("pear", "washed"), Inside("plum", "locker"), Inside("pear", "chest")
        ),
        "fixtures": {"bench": BENCH, "basin": BASIN, "tap": TAP, "locker": LOCKER, "chest": CHEST},
        "objects": {name: ObjectFacts(name, name, washable=True) for name in ("plum", "pear")},
        "places": {"plum": "bench.0", "pear": "bench.3"},
        "verbs": {"wash": ("turn on tap",)},
        "slot_stations": STATIONS,
        "max_rounds": 60,
    }
    return MadeUpKitchen(**(settings | changes))  # type: ignore[arg-type]
