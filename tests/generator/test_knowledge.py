"""With knowledge="seen" nothing that a planner is given tells what nobody has seen."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from knowledge_helpers import given, kitchen

import remac_agents
import remac_env
from remac_agents.planners.literal import LiteralPlanner
from remac_env.errors import SamplingError
from remac_env.generator import templates
from remac_env.kitchen import annexes
from remac_env.tasks.spec import TaskSpec


def hidden_in(spec: TaskSpec) -> dict[str, str]:
    """Store -> an object behind its shut door."""
    assert spec.setup is not None
    shut = {name for name, facts in annexes.load().items() if facts.door and name not in spec.setup.doors}
    where = {place.where.partition(".")[0]: noun for noun, place in spec.setup.places.items()}
    return {store: noun for store, noun in where.items() if store in shut}


def hiding() -> TaskSpec:
    """A task with two stores that hide something."""
    specs = (remac_env.generate(2, seed, template="some plates", knowledge="seen") for seed in range(20))
    return next(spec for spec in specs if len(hidden_in(spec)) > 1)


def swapped(spec: TaskSpec) -> tuple[TaskSpec, str, str]:
    """The same task with what stands in one shut store exchanged for what stands in another; all that is proven of it
    is other then."""
    assert spec.setup is not None
    one, other = list(hidden_in(spec).values())[:2]
    places = dict(spec.setup.places)
    places[one], places[other] = places[other], places[one]
    proven = {key: spec.generated[key] + 1 for key in ("lower", "upper", "hidden", "untold")} | {"problem": "other"}
    return replace(spec, setup=replace(spec.setup, places=places), generated={**spec.generated, **proven}), one, other


HIDDEN = 202502
"""A mixed start of HeatAndShelve with the vegetable in the shut microwave."""

PLAN = (
    "navigate to counter", "navigate to {one}", "pick up {one}", "place to plate", "navigate to trolley",
    "pick up {one}", "pick up {other}", "open cabinet door", "navigate to {other}", "navigate to cabinet", "wait",
)  # fmt: skip


@pytest.mark.parametrize(
    "options", [{"masks": "grammar"}, {"masks": "feasible"}, {"clock": "events"}, {"reward": "progress"}]
)
def test_swapping_hidden_contents_changes_nothing_that_is_given(options: dict[str, Any]) -> None:
    spec = hiding()
    other, a, b = swapped(spec)
    first, second = (kitchen(each, robots=1, **options) for each in (spec, other))
    begins = [given(env, *env.reset(seed=0)) for env in (first, second)]
    assert begins[0] == begins[1] and first.world != second.world
    for text in PLAN:
        command = first.vocabulary.encode(text.format(one=a, other=b))
        steps = [env.step({"robot_0": command}) for env in (first, second)]
        told = [given(env, step[0], *step[4:], *step[1:4]) for env, step in zip((first, second), steps, strict=True)]
        assert told[0] == told[1], text


@pytest.mark.parametrize("method", ["RE", "REMAC"])
def test_what_a_planner_is_asked_is_the_same(method: str) -> None:
    class Notes(LiteralPlanner):
        def plan(self, request: Any) -> Any:
            asked.append(repr(request))
            return super().plan(request)

    requests = []
    for spec in (hiding(), swapped(hiding())[0]):
        asked: list[str] = []
        env = kitchen(spec, robots=1)
        agent = remac_agents.make(method, planner=Notes(explores=True))
        observations, infos = env.reset(seed=0)
        agent.reset(observations, infos)
        for _ in range(4):
            observations, *_, infos = env.step(agent.act(observations, infos))
        requests.append(asked)
    assert requests[0] and requests[0] == requests[1]


@pytest.mark.long
@pytest.mark.parametrize(("seed", "template"), [(0, "fruit on the counter"), (0, "packets from the stores (built)")])
def test_no_picture_of_physics_shows_what_is_behind_doors(seed: int, template: str) -> None:
    spec = remac_env.generate(2, seed, template=template, knowledge="seen")
    assert spec.setup is not None
    one, other = [noun for noun in spec.goal.names() if noun in spec.setup.places][:2]
    places = dict(spec.setup.places)
    places[one], places[other] = places[other], places[one]
    there = replace(spec, setup=replace(spec.setup, places=places))
    envs = [remac_env.parallel_env(each, robots=1, obs="state+images") for each in (spec, there)]
    seen = [env.reset(seed=0)[0]["robot_0"] for env in envs]
    for text in ("navigate to counter", f"navigate to {one}", "navigate to stove"):
        assert all((seen[0][key] == seen[1][key]).all() for key in seen[0]), text
        seen = [env.step({"robot_0": env.vocabulary.encode(text)})[0]["robot_0"] for env in envs]


@pytest.mark.parametrize(("knowledge", "told"), [("seen", {}), ("full", {"heating vegetable": 0.0})])
def test_what_nobody_has_seen_is_not_told_to_be_heating(knowledge: str, told: dict[str, float]) -> None:
    """Else whoever turns on a shut microwave learns what is in it: by name, by a figure, or as a wait ends early."""
    given = {"robots": 1, "backend": "symbolic", "clock": "events", "starts": "mixed", "knowledge": knowledge}
    env = remac_env.parallel_env("HeatAndShelve", **given)
    env.reset(seed=HIDDEN)
    assert env.world.objects["vegetable"].place.where.startswith("microwave")

    def step(text: str) -> tuple[Any, Any]:
        observations, *_, infos = env.step({"robot_0": env.vocabulary.encode(text)})
        return observations["robot_0"]["observation"], infos["robot_0"]

    step("navigate to microwave")
    assert step("turn on microwave")[1]["processes"] == told
    step("close microwave door")  # is shut: refused, which takes a second
    waits = [step("wait") for _ in range(10)]
    assert {info["tau"] for _, info in waits} == ({4.0, 5.0} if told else {5.0})
    assert any(seen[-len(env._time._places) :].any() for seen, _ in waits) == bool(told)
    step("turn off microwave")
    assert "vegetable" not in step("open microwave door")[1]["unseen"]


def test_full_knowledge_would_tell() -> None:
    spec = replace(hiding(), knowledge="full")
    first, second = (kitchen(each, robots=1) for each in (spec, swapped(spec)[0]))
    assert given(first, *first.reset(seed=0)) != given(second, *second.reset(seed=0))


def test_what_a_robot_has_seen_the_team_knows() -> None:
    spec = hiding()
    store, name = next(iter(hidden_in(spec).items()))
    env = kitchen(spec, robots=2)
    _, infos = env.reset(seed=0)
    assert name in infos["robot_1"]["unseen"]
    assert f"the {name}" in infos["robot_1"]["text"].partition("Nobody has seen ")[2]

    def step(one: str, two: str = "wait") -> dict[str, Any]:
        code = env.vocabulary.encode
        return env.step({"robot_0": code(one), "robot_1": code(two)})[4]

    assert step(f"navigate to {name}")["robot_0"]["outcome"]["reason"] == "not_found"
    step(f"navigate to {store}")
    assert name in step("wait")["robot_1"]["unseen"]
    assert name not in step(f"open {store} door")["robot_1"]["unseen"]
    assert step("navigate aside")["robot_0"]["outcome"]["status"] == "success"
    assert step("wait", f"navigate to {name}")["robot_1"]["outcome"]["status"] == "success"


def test_knowledge_is_for_any_task() -> None:
    env = remac_env.parallel_env("HeatOnStove", robots=1, backend="symbolic", knowledge="seen", starts="mixed")
    hidden = 0
    for seed in range(12):
        _, infos = env.reset(seed=seed)
        hidden += len(infos["robot_0"]["unseen"])
    assert hidden


def test_who_knows_everything_is_told_what_it_was_told_before() -> None:
    env = remac_env.parallel_env("HeatOnStove", robots=1, backend="symbolic", starts="mixed")
    _, infos = env.reset(seed=3)
    assert infos["robot_0"]["unseen"] == [] and "Nobody has seen" not in infos["robot_0"]["text"]


def other_way_round(name: str, row: templates.Template) -> list[tuple[TaskSpec, TaskSpec]]:
    """Tasks of a template, each with the one in which what two shut stores hide is exchanged; one is enough."""
    for grade in sorted(row.sizes, reverse=True):
        for seed in range(6):
            try:
                spec = remac_env.generate(grade, seed, template=name, knowledge="seen", robots=2 if row.team else 1)
            except SamplingError:
                continue
            if len(hidden_in(spec)) > 1:
                return [(spec, swapped(spec)[0])]
    return []


def test_most_templates_hide_something_in_two_stores() -> None:
    stores = [name for name, facts in annexes.load().items() if facts.door]
    rows = [row for row in templates.load().values() if not row.family]
    assert sum(len(set(stores) & set(row.annexes)) > 1 for row in rows) > 20


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name == "packets into the chest" else pytest.mark.long)
        for name, row in templates.load().items()
        if not row.family
    ],
)
def test_no_template_tells_what_nobody_has_seen(name: str) -> None:
    """Masks, text, commands and both views of it: what one robot is given, and the state of all."""
    row = templates.load()[name]
    for one, other in other_way_round(name, row):
        for masks in ("grammar", "feasible"):
            envs = [kitchen(spec, robots=2 if row.team else 1, masks=masks) for spec in (one, other)]
            told = [given(env, *env.reset(seed=0)) for env in envs]
            assert told[0] == told[1] and envs[0].world != envs[1].world
            for text in ("navigate to counter", "open cabinet door", *(f"navigate to {n}" for n in one.goal.names())):
                lead, code = min(envs[0].agents), envs[0].vocabulary.encode
                orders = {robot: code(text if robot == lead else "wait") for robot in envs[0].agents}
                steps = [env.step(orders) for env in envs]
                told = [given(env, step[0], step[4]) for env, step in zip(envs, steps, strict=True)]
                assert told[0] == told[1], (text, masks)
