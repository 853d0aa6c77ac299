"""The facts of a layout, and that a faulty layout file is refused with a message that says what is wrong."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from types import MappingProxyType

import pytest

from remac_env.errors import KitchenFileError, UnknownNameError
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import layout_checks
from remac_env.kitchen.scene import build_scene

NAME = "one_wall_large"
TEXT = (layouts.FOLDER / f"{NAME}.toml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def layout() -> layouts.Layout:
    return layouts.load(NAME)


def parse(text: str) -> layouts.Layout:
    return layouts.parse(text, name="broken", file="broken.toml")


def test_facts_need_no_simulator() -> None:
    code = (
        f"import sys; from remac_env.kitchen import layout; layout.load({NAME!r}); assert 'mujoco' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(__file__).parents[2])


def test_every_shipped_layout_loads() -> None:
    assert NAME in layouts.names()
    for name in layouts.names():
        assert layouts.load(name).name == name


def test_unknown_layout_lists_the_valid_ones() -> None:
    with pytest.raises(UnknownNameError, match=NAME):
        layouts.load("pantry")


def test_nouns_of_the_tasks_are_there(layout: layouts.Layout) -> None:
    assert {"counter", "cabinet", "microwave", "sink", "faucet", "stove", "fridge"} <= set(layout.fixtures)
    assert {name for name, fixture in layout.fixtures.items() if fixture.door} == {"cabinet", "microwave"}
    assert layout.fixtures["faucet"].switches == ("faucet",)
    assert layout.fixtures["microwave"].switches == ("microwave",)
    assert layout.fixtures["sink"].switches == ()


def test_switches_of_the_stove_are_its_slots_in_order(layout: layouts.Layout) -> None:
    stove = layout.fixtures["stove"]
    assert stove.switches == tuple(slot.name for slot in stove.slots) == tuple(f"stove.{i}" for i in range(4))
    assert layout.switch_owner("stove.2") is stove
    with pytest.raises(UnknownNameError, match="stove.0"):
        layout.switch_owner("oven")


def test_slots_belong_to_their_fixtures_and_stations(layout: layouts.Layout) -> None:
    for name, slot in layout.slots.items():
        assert slot.name == name
        assert slot in layout.fixtures[slot.fixture].slots
        assert slot.station in layout.stations
        assert slot.station in layout.fixtures[slot.fixture].stations
        station = layout.stations[slot.station]
        assert layout.facing(station) is layout.frame(slot.fixture), "a robot would turn its back on it"
        x, _ = layout.facing(station).local(station.x, station.y)
        assert abs(slot.center[0] - x) < 0.45, "out of an arm's reach"


@pytest.mark.parametrize("name", layouts.names())
def test_the_counter_has_room_for_all_that_a_task_may_put_on_it(name: str) -> None:
    """Eight distractors, two objects of the task and a free slot, over four stations; nothing else is a counter."""
    layout = layouts.load(name)
    scene = build_scene(layout, {}, ())
    slots = scene.fixtures["counter"].slots
    assert len(slots) >= 11 and len(scene.stations_of("counter")) >= 4
    worktops = [fixture for fixture in layout.fixtures.values() if fixture.kind == "counter"]
    assert set(slots) == {slot.name for fixture in worktops for slot in fixture.slots}
    assert scene.fixtures["counter"].station == layout.fixtures["counter"].station
    assert {scene.slots[slot].fixture for slot in slots} == {"counter"}
    assert not scene.conflicts, "robots could not use them at the same time"
    parts = [fixture.name for fixture in layout.fixtures.values() if fixture.part_of]
    assert not set(parts) & set(scene.fixtures), "robots know the counter as one"


def test_ornaments_are_nobody_s_target(layout: layouts.Layout) -> None:
    for fixture in layout.fixtures.values():
        if fixture.kind in ("ornament", "wall_cabinet", "hood", "window", "shelf"):
            assert fixture.station is None and not fixture.slots and not fixture.switches and not fixture.door


def test_stations_conflict_when_near(layout: layouts.Layout) -> None:
    assert layout.conflicts() == frozenset()
    near = replace(layout.stations["sink"], name="near", x=layout.stations["sink"].x + 0.5)
    crowded = replace(layout, stations=MappingProxyType({**layout.stations, "near": near}))
    assert crowded.conflicts() == {frozenset(("near", "sink")), frozenset(("near", "counter_right"))}


def test_robots_have_room(layout: layouts.Layout) -> None:
    for first, second in combinations((*layout.stations.values(), *layout.asides), 2):
        assert first.distance(second) >= layout_checks.station_gap() - 1e-9


def test_mappings_cannot_be_changed(layout: layouts.Layout) -> None:
    with pytest.raises(TypeError):
        layout.slots["new"] = next(iter(layout.slots.values()))  # type: ignore[index]


FAULTS = {
    "fixture through the side wall": ("left = 2.40", "left = 3.00", ["microwave", "leaves the room"]),
    "fixture inside another": ("left = 0.60", "left = 0.40", ["sink", "overlaps fixture counter", "0.200 m"]),
    "microwave in the wall cabinet": (
        "z = [1.60, 2.25]",
        "z = [1.10, 2.25]",
        ["microwave_cabinet", "overlaps fixture microwave"],
    ),
    "slot off the counter": (
        "at = [0.37, 0.24]",
        "at = [0.55, 0.24]",
        ["counter.2", "reaches off its surface", "[-0.350, 0.600]"],
    ),
    "slot beyond the wall": ("at = [0.37, 0.24]", "at = [0.37, 0.60]", ["counter.2", "reaches off its surface"]),
    "overlapping slots": ("at = [0.11, 0.24]", "at = [0.20, 0.24]", ["counter.1", "overlaps counter.2"]),
    "no size": (
        "at = [2.04, 0.24], half = [0.13, 0.14]",
        "at = [2.04, 0.24], half = [0.0, 0.14]",
        ["counter.5", "positive"],
    ),
    "unknown key": ("left = 2.40", "left = 2.40\ncolour = 'red'", ["fixtures.microwave.colour", "unknown key", "left"]),
    "unknown key in a slot": (
        "at = [0.37, 0.24]",
        "wide = 1, at = [0.37, 0.24]",
        ["fixtures.counter.slots[2].wide", "half"],
    ),
    "unknown top key": ("version = 1", "version = 1\nname = 'x'", ["name", "unknown key", "stations"]),
    "unknown kind": ('kind = "stove"', 'kind = "smoker"', ["fixtures.stove.kind", "smoker", "microwave"]),
    "doors beyond number": ("doors = 2", f"doors = {10**400}", ["fixtures.", ".doors", "from 1 to 12"]),
    "half a door": ("doors = 2", "doors = 0.5", ["fixtures.", ".doors", "0.5 is not a whole number"]),
    "unknown front": ('["drawers", "doors"]', '["drawers", "hatch"]', ["fronts", "hatch", "drawers, door, doors"]),
    "unknown ornament": ('shape = "clock"', 'shape = "cat"', ["fixtures.clock.shape", "cat", "plant"]),
    "unknown station": ('station = "stove"', 'station = "hob"', ["fixtures.stove.station", "hob", "counter_mid"]),
    "missing key": ("left = 2.40\n", "", ["fixtures.microwave.left", "missing"]),
    "not a number": ("left = 2.40", "left = '2.40'", ["fixtures.microwave.left", "not a finite number"]),
    "not finite": ("left = 2.40", "left = nan", ["fixtures.microwave.left", "not a finite number"]),
    "a truth value is no number": ("left = 2.40", "left = true", ["fixtures.microwave.left", "not a finite number"]),
    "span reversed": (
        "x = [-1.85, -1.40]\nz = [1.35, 1.95]",
        "x = [-1.40, -1.85]\nz = [1.35, 1.95]",
        ["fixtures.cabinet.x", "low < high"],
    ),
    "three numbers wanted": (
        "at = [1.68, 0.54, 1.82]",
        "at = [1.68, 0.54]",
        ["fixtures.plant.at", "list of 3 numbers"],
    ),
    "stations too near": ("at = [0.94, -0.85]", "at = [0.85, -0.85]", ["stations.sink", "counter_mid", "0.84"]),
    "station in the counter": ("at = [0.94, -0.85]", "at = [0.94, -0.10]", ["stations.sink", "cannot be reached"]),
    "station in the side wall": ("at = [-2.55, -0.85]", "at = [-2.90, -0.85]", ["stations.fridge", "side wall"]),
    "part of nothing": ('part_of = "counter"', 'part_of = "bench"', ["fixtures.island.part_of", "bench", "counter"]),
    "part of itself": ('part_of = "counter"', 'part_of = "island"', ["fixtures.island.part_of", "island", "counter"]),
    "part of another kind": ('part_of = "counter"', 'part_of = "sink"', ["fixtures.island.part_of", "no counter"]),
    "slots of a part at another wall": (
        'station = "counter_island_left"',
        'station = "counter_mid"',
        ["fixtures.island.station", "does not face wall 'island'", "counter_island_right"],
    ),
    "not TOML": ("version = 1", "version = = 1", ["not valid TOML"]),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_are_refused(fault: str) -> None:
    old, new, expected = FAULTS[fault]
    assert TEXT.count(old) >= 1, "the fault cannot be planted any more"
    with pytest.raises(KitchenFileError) as caught:
        parse(TEXT.replace(old, new, 1))
    for part in ["broken.toml", *expected]:
        assert part in str(caught.value)


def test_a_part_has_slots() -> None:
    start = TEXT.index("slots = [", TEXT.index("[fixtures.island]"))
    without = TEXT[:start] + TEXT[TEXT.index("]\n", start) + 2 :]
    with pytest.raises(KitchenFileError, match=r"fixtures.island.slots: a part without slots"):
        parse(without)
    assert parse(without.replace('part_of = "counter"\n', "")).fixtures["island"].station is None


def test_a_door_must_not_swing_into_anything() -> None:
    obstacle = '\n[fixtures.obstacle]\nkind = "ornament"\nshape = "jars"\nat = [2.60, 0.00, 0.90]\n'
    with pytest.raises(KitchenFileError, match="fixtures.microwave: its door swings into fixture obstacle"):
        parse(TEXT + obstacle)
    parse(TEXT + obstacle.replace("2.60, 0.00", "2.05, 0.00"))


def test_a_file_from_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(TEXT, encoding="utf-8")
    assert layouts.read(tmp_path / "mine.toml").name == "mine"
    with pytest.raises(KitchenFileError, match="none.toml"):
        layouts.read(tmp_path / "none.toml")
