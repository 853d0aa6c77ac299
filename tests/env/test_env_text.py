"""What the kitchen's text says of rounds and places: facts of the scene, for one robot and for two."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import pytest

import remac_env
from remac_env.frozen import FrozenMap
from remac_env.rules.scene import public_scene
from remac_env.testing.text import STATE_WORDS
from remac_env.text import describe

RULES = re.compile(r"\b(doors?|needs?|must|requires?|without|raw|wet|hot|spill|first|before)\b", re.I)
"""Words in which a rule that has to be found out would be told."""


def kitchen(task: str = "HeatOnStove", **options: Any) -> Any:
    env = remac_env.parallel_env(task, backend="symbolic", **options)
    env.reset(seed=3)
    return env


def told(scene: Any, **options: Any) -> str:
    return describe(public_scene(scene), ["wait"], "tidy up", **options)


@pytest.mark.parametrize("clock", ["rounds", "events"])
@pytest.mark.parametrize("robots", [1, 2])
def test_time_and_the_commands_that_are_about_no_object_are_defined(robots: int, clock: str) -> None:
    text = told(kitchen(robots=robots).start.scene, clock=clock)
    for name in ("`wait`", "`done`", "`navigate aside`", "In a round" if clock == "rounds" else "Commands take time"):
        assert text.count(name) == 1
    place = "A fixture is used from its place, and so is an object that is there; `navigate to` goes to that place."
    assert place in text
    together = "all of them together" if clock == "rounds" else "whatever the others do"
    assert (together in text) is ("Two robots cannot be in the same place" in text) is (robots == 2)
    assert "The same place serves the sink and the faucet." in text
    assert "such as a filled vessel, cannot be picked up" in text


def test_what_this_kitchen_lacks_is_not_spoken_of() -> None:
    scene = kitchen(robots=2).start.scene
    plain = replace(
        scene,
        objects=FrozenMap({name: replace(facts, holds=0) for name, facts in scene.objects.items()}),
        fixtures=FrozenMap({name: replace(facts, station=name) for name, facts in scene.fixtures.items()}),
    )
    assert "vessel" not in told(plain) and "serves" not in told(plain) and "While one robot" not in told(plain)
    close = replace(scene, conflicts=frozenset({frozenset(("stove", "sink"))}))
    assert "While one robot is by the sink and the faucet, no other can be by the stove." in told(close)


def test_what_takes_one_thing_is_told_from_the_slots() -> None:
    scene = kitchen().start.scene
    assert "The cabinet, the sink and the microwave take one thing each, or one vessel with" in told(scene)
    assert "; the stove takes 4." in told(scene) and "counter takes" not in told(scene)
    cut = {"stove": 1, "sink": 1}
    few = FrozenMap({n: replace(facts, slots=facts.slots[: cut.get(n, 0)]) for n, facts in scene.fixtures.items()})
    fewer = told(replace(scene, fixtures=few))
    assert "The stove and the sink take one thing each" in fewer and "the stove takes" not in fewer
    none = FrozenMap({name: replace(facts, slots=()) for name, facts in scene.fixtures.items()})
    assert "one thing" not in told(replace(scene, fixtures=none))
    assert public_scene(scene).used_from("sink") == scene.used_from("sink")
    assert set(public_scene(scene).stations) == set(scene.stations)


@pytest.mark.parametrize("task", remac_env.tasks())
@pytest.mark.parametrize("robots", [1, 2])
def test_neither_states_nor_rules_that_are_to_be_found_out(task: str, robots: int) -> None:
    scene = kitchen(task, robots=robots, starts="mixed").start.scene
    words = told(scene)
    for name in (*scene.fixtures, *scene.objects):
        words = re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", "", words)
    assert not STATE_WORDS.search(words) and not RULES.search(words), words


def test_a_rule_would_be_found() -> None:
    assert RULES.search("The fish must not touch the sink without a vessel.")
    assert RULES.search("Open the door first.")


def test_the_digest_of_a_start_knows_nothing_of_the_text(monkeypatch: pytest.MonkeyPatch) -> None:
    before = kitchen().start.digest
    monkeypatch.setattr("remac_env.episode.describe", lambda *_, **__: "another text")
    env = kitchen()
    assert env.start.digest == before
