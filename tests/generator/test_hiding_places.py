"""With knowledge="seen" nothing tells behind which shut door a thing is, in any template, by both clocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest
from knowledge_helpers import given, kitchen

import remac_env
from remac_env.errors import SamplingError
from remac_env.generator import templates
from remac_env.generator.certified import scene_of
from remac_env.seeding import generator
from remac_env.state import Place
from remac_env.tasks.spec import TaskSpec

ROUNDS = 6
CLOCKS: list[dict[str, Any]] = [{"masks": "grammar"}, {"masks": "feasible", "clock": "events"}]


def hiding(spec: TaskSpec, robots: int) -> dict[str, TaskSpec]:
    """Shut store -> the task with one and the same object in it; what is in its way there changes places with it."""
    assert spec.setup is not None
    scene, world = scene_of(spec, robots, "seen")
    shut = [name for name, facts in scene.fixtures.items() if facts.slots and world.fixtures[name].door == "closed"]
    inside = {place.where: noun for noun, place in spec.setup.places.items() if place.relation == "slot"}
    away = [noun for where, noun in inside.items() if scene.slots[where].fixture in shut]
    name = min(away or inside.values())
    found = {}
    for store in shut:
        places = dict(spec.setup.places)
        where = scene.fixtures[store].slots[0]
        if inside.get(where, name) != name:
            places[inside[where]] = places[name]
        there = replace(spec, setup=replace(spec.setup, places={**places, name: Place("slot", where)}))
        if not there.goal.holds(*scene_of(there, robots, "seen")):
            found[store] = there
    return found


def drawn(name: str) -> tuple[dict[str, TaskSpec], int]:
    """A task of a template in every store that is shut, and for how many robots."""
    row = templates.load()[name]
    robots = 2 if row.team else 1
    for grade in sorted(row.sizes):
        for seed in range(195000, 195006):
            try:
                spec = remac_env.generate(grade, seed, template=name, knowledge="seen", robots=robots)
            except SamplingError:
                continue
            if len(found := hiding(spec, robots)) > 1:
                return found, robots
    return {}, robots


def tell_apart(specs: Mapping[str, TaskSpec], robots: int, options: Mapping[str, Any], seed: str) -> str:
    """What commands tell the kitchens apart, "" where none of those that were tried does; no store is opened."""
    envs = [kitchen(spec, robots=robots, **options) for spec in specs.values()]
    told = [given(env, *env.reset(seed=0)) for env in envs]
    first, chance, orders = envs[0], generator(0, "hiding places", seed), "at once"
    known = first.vocabulary.commands(first.start.scene)
    commands = [text for text in known if text not in {f"open {store} door" for store in specs}]
    for _ in range(ROUNDS):
        if any(each != told[0] for each in told):
            return orders
        if not first.agents or any(env.goal.holds(env.start.scene, env.world) for env in envs):
            break
        chosen = {robot: commands[int(chance.integers(len(commands)))] for robot in first.agents}
        orders = ", ".join(chosen.values())
        codes = {robot: first.vocabulary.encode(text) for robot, text in chosen.items()}
        steps = [env.step(codes) for env in envs]
        told = [given(env, step[0], step[4]) for env, step in zip(envs, steps, strict=True)]
    return ""


@pytest.mark.parametrize("options", CLOCKS, ids=["rounds", "events"])
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[] if name == "fruit stowed" else pytest.mark.long) for name in templates.load()],
)
def test_nothing_tells_behind_which_door_a_thing_is(name: str, options: dict[str, Any]) -> None:
    specs, robots = drawn(name)
    if not specs:
        pytest.skip("its tasks have one shut store at most, or none but such as reach the goal")
    assert tell_apart(specs, robots, options, name) == ""


def test_who_knows_everything_is_told() -> None:
    specs, robots = drawn("fruit stowed")
    full = {store: replace(spec, knowledge="full") for store, spec in specs.items()}
    assert len(full) > 1 and tell_apart(full, robots, CLOCKS[0], "") == "at once"


@pytest.mark.long
@pytest.mark.parametrize("knowledge", ["seen", "full"])
def test_no_window_shows_what_is_behind_it(knowledge: str) -> None:
    """An oven and a microwave have one; who knows everything may look through it. Neither a robot's pictures tell nor
    those that people are shown (`render` and `render_work`, as in `remac play`)."""
    template = {"template": "fruit on the counter", "knowledge": "seen"}
    made = (remac_env.generate(1, seed, **template) for seed in range(197000, 197009))
    specs = next(found for spec in made if {"oven", "microwave"} <= (found := hiding(spec, 1)).keys())
    looks: dict[str, Any] = {"obs": "state+images", "image_size": 256, "cameras": "front,station"}
    envs = [kitchen(replace(spec, knowledge=knowledge), robots=1, **looks) for spec in specs.values()]
    shown = [[env.reset(seed=0)[0]["robot_0"] for env in envs]]
    glazed = [env for env, store in zip(envs, specs, strict=True) if store in ("oven", "microwave")]
    people = [[env.render_work(whole=True) for env in glazed]]
    for text in ("navigate to oven", "navigate to microwave"):
        shown += [[env.step({"robot_0": env.vocabulary.encode(text)})[0]["robot_0"] for env in envs]]
        people += [[env.render_work(whole=True) for env in glazed]]
    robots = [[seen[camera] for seen in each] for each in shown for camera in ("front", "station")]
    for views in (robots, people):
        alike = [all((picture == first).all() for picture in others) for first, *others in views]
        assert all(alike) is (knowledge == "seen")
