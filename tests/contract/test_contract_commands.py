"""Commands do not give the answer away: in every kitchen stand the same vessels, doors and switches."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

import remac_env
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import starts as drawing
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.rules.scene import public_scene
from remac_env.start import Start
from remac_env.state import contents
from remac_env.tasks import get
from remac_env.tasks.goals import All, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.testing import ContractError, check_commands, check_task

TASKS = tuple(remac_env.tasks())
ROBOTS = ("robot_0", "robot_1")
LAYOUTS = layouts.names()


def start(spec: TaskSpec, seed: int, kind: str) -> Start:
    """A start in one layout after the other."""
    layout = LAYOUTS[seed % len(LAYOUTS)]
    drawn, _ = TaskWorlds(spec).start(seed, style=None, layout=layout, starts=kind, robots=ROBOTS, perception_noise=0.0)
    return drawn


def vessels(begun: Start) -> set[str]:
    return {name for name, facts in begun.scene.objects.items() if facts.holds}


def structure(spec: TaskSpec, begun: Start) -> set[str]:
    """The commands about whatever holds, opens or runs."""
    words = TaskWorlds(spec).vocabulary
    fixtures = {name for name, facts in begun.scene.fixtures.items() if facts.slots or facts.switches}
    told = [words.parse(text) for text in words.commands(begun.scene)]
    return {s.text for s in told if s is not None and s.target in fixtures | vessels(begun)}


@pytest.mark.parametrize("kind", ["paper", "mixed"])
def test_all_tasks_have_the_same_commands_for_what_holds_opens_or_runs(kind: str) -> None:
    seen = set()
    for task in TASKS:
        for seed in range(20):
            begun = start(get(task), seed, kind)
            seen.add(frozenset(structure(get(task), begun)))
            own = {noun for role in get(task).roles for noun in role.nouns}
            spare = vessels(begun) - own
            assert len(spare) >= 2, (task, seed)
            for name in spare:
                place = begun.world.objects[name].place
                assert place.relation == "slot" and not contents(begun.world, name), (task, seed, name)
                assert begun.scene.slots[place.where].fixture == "counter", (task, seed, name)
    assert len(seen) == 1, [sorted(one ^ min(seen, key=sorted)) for one in seen]
    (commands,) = seen
    assert {f"place to {noun}" for noun in ("plate", "bowl", "pan", "sink", "stove")} <= commands
    assert {"open cabinet door", "open microwave door", "turn on faucet", "turn on stove"} <= commands


def _fetch(vessel: str) -> TaskSpec:
    return TaskSpec(
        name="PutIntoVessel",
        wordings=("put the {food} away",) * 3,
        goal=All(Inside("{food}", "{vessel}"), Released("{food}")),
        roles=(Role("food", ("vegetable",)), Role("vessel", (vessel,))),
        fixtures=("counter",),
        layouts=LAYOUTS,
    )


def test_which_vessel_a_task_needs_changes_no_command() -> None:
    for seed in range(10):
        told = {
            vessel: structure(_fetch(vessel), start(_fetch(vessel), seed, "paper"))
            for vessel in ("pan", "bowl", "plate")
        }
        assert told["pan"] == told["bowl"] == told["plate"], seed


@pytest.mark.parametrize("task", TASKS)
def test_names_are_listed_in_an_order_that_tells_nothing(task: str) -> None:
    """In the order of the draw, the task's own objects would come first."""
    env = remac_env.parallel_env(task, backend="symbolic", text="states")
    for seed in range(5):
        _, infos = env.reset(seed=seed)
        names = sorted(env.start.scene.objects)
        assert list(public_scene(env.start.scene).objects) == names
        assert f"Objects: {', '.join(names)}." in infos["robot_0"]["text"]
        lines = infos["robot_0"]["text"].splitlines()
        assert [n for line in lines for n in names if line.startswith(f"The {n} is on or in")] == names


def _without_spare_vessels(others: Any, *given: object) -> dict[str, Any]:
    return dict(others)


@pytest.mark.parametrize("task", ["DefrostInBowl", "HeatOnStove", "OpenCabinetPnP"])
def test_a_kitchen_with_the_task_s_vessel_alone_is_found_out(task: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def make() -> Any:
        return remac_env.parallel_env(task, backend="symbolic")

    check_commands(make, seeds=range(3))
    monkeypatch.setattr(drawing, "_with_vessels", _without_spare_vessels)
    with pytest.raises(ContractError, match="give the answer away"):
        check_commands(make, seeds=range(3))


def test_a_task_without_distractors_is_refused() -> None:
    bare = replace(get("HeatOnStove"), name="HeatInEmptyKitchen", distractors=(0, 0))
    with pytest.raises(ContractError, match="no other vessel than pan"):
        check_task(bare, seeds=(0,), robots=(1,), starts=("paper",), rounds=2)
