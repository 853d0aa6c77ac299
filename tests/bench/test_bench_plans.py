"""Every type of fault has a planted bad plan, and the commands and experiments tell them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from remac_bench.cli import app
from remac_bench.experiments.tables import as_json, published
from remac_bench.experiments.trials import reflection, suboptimal, wording
from remac_bench.plans.ask import Cell, judged, kitchen, optimum, teach
from remac_bench.plans.faults import BY_REASON, FAULTS
from remac_bench.plans.judge import judge
from typer.testing import CliRunner

from remac_agents.plan import Commands, read_plan
from remac_agents.roles import PlanRequest, ReflectRequest
from remac_agents.wiring.catalogue import make_role
from remac_env.oracle import solve
from remac_env.rules.outcomes import REASONS
from remac_env.state import Place

OVEN = [  # a shortest plan of OpenMicrowavePnP
    "navigate to microwave",
    "open microwave door",
    "navigate to vegetable",
    "pick up vegetable",
    "navigate to microwave",
    "place to microwave",
]
PAN = [
    "navigate to pan",
    "pick up pan",
    "navigate to stove",
    "place to stove",
    "navigate to vegetable",
    "pick up vegetable",
    "navigate to stove",
    "place to pan",
    "turn on stove",
]
BAD: list[tuple[str, str, object, int | None]] = [
    ("parse", "OpenMicrowavePnP", "I would rather not", None),
    ("unknown_thing", "OpenMicrowavePnP", [*OVEN[:2], "pick up unicorn"], 2),
    ("not_at_station", "OpenMicrowavePnP", OVEN[1:], 0),
    ("hand_full", "OpenMicrowavePnP", [*OVEN[2:5], "open microwave door", OVEN[5]], 3),
    ("hand_empty", "OpenMicrowavePnP", [*OVEN[:2], "place to microwave"], 2),
    ("door_closed", "OpenMicrowavePnP", OVEN[2:], 3),
    ("wrong_order", "OpenMicrowavePnP", [*OVEN[2:], "open microwave door"], 3),
    ("blocked", "WashPnPHeat", ["navigate to microwave", "open microwave door", "turn on microwave"], 2),
    ("advised_against", "HeatOnStove", ["navigate to vegetable", "pick up vegetable", *PAN[2:4]], 3),
    ("loaded", "HeatOnStove", [*PAN[:8], "pick up pan"], 8),
    ("missing_step", "OpenMicrowavePnP", OVEN[:5], None),
    ("missing_step", "OpenMicrowavePnP", [], None),
    ("redundant", "OpenMicrowavePnP", [OVEN[0], *OVEN], 0),
    ("redundant", "OpenMicrowavePnP", [*OVEN[:2], "open microwave door", *OVEN[2:]], 2),
    ("redundant", "OpenMicrowavePnP", [*OVEN, "close microwave door"], 6),
]


@pytest.mark.parametrize(("kind", "task", "plan", "index"), BAD)
def test_a_planted_fault_is_named(kind: str, task: str, plan: object, index: int | None) -> None:
    found = judged(Cell(task=task), lambda request: plan)
    assert found.error is not None
    assert (found.error.type, found.error.index) == (kind, index), found.error
    assert found.valid == (kind == "redundant")
    assert not found.optimal
    assert found.error.sentence


def test_a_dropped_thing_is_out_of_reach_and_the_goal_with_it() -> None:
    env = kitchen(Cell(task="OpenMicrowavePnP"))
    env.reset(seed=0)
    fallen = env.world.with_object("vegetable", place=Place("floor"))
    commands = Commands(["pick up vegetable", "navigate to vegetable", "navigate to sink"])
    for row, kind in (["pick up vegetable"], "unreachable"), (["navigate to sink"], "goal_not_reached"):
        plan = read_plan(row, commands, ("robot_0",), "robot_0")
        found = judge(env.start.scene, fallen, env.goal, plan, 6)  # type: ignore[arg-type]
        assert found.error is not None and found.error.type == kind


def test_two_robots_that_claim_one_station() -> None:
    both = {"robot_0": ["navigate to microwave"], "robot_1": ["navigate to microwave"]}
    found = judged(Cell(task="OpenMicrowavePnP", robots=2), lambda request: both)
    assert found.error is not None and found.error.type == "occupied"


def test_shortest_plans_are_optimal_with_or_without_a_closing_done() -> None:
    for task, plan in (("OpenMicrowavePnP", OVEN), ("HeatOnStove", PAN)):
        for row in (plan, [*plan, "done"]):
            found = judged(Cell(task=task), lambda request, row=row: row)
            assert found.optimal and found.error is None and found.rounds == found.optimum


@pytest.mark.parametrize(
    ("starts", "robots"), [("paper", 1), ("mixed", 1), ("paper", 2), pytest.param("mixed", 2, marks=pytest.mark.long)]
)
def test_the_search_is_optimal_and_its_length_is_the_certificate(robots: int, starts: str) -> None:
    for seed in range(3 - robots):
        cell = Cell(task="DefrostInBowl", robots=robots, starts=starts, seed=seed)
        env = kitchen(cell)
        env.reset(seed=seed)
        best = solve(env.start.scene, env.world, env.goal)
        assert best is not None and best.length == optimum(cell)
        assert judged(cell, make_role("planner", "oracle")).optimal


def test_the_list_is_closed() -> None:
    assert set(BY_REASON) <= set(REASONS)
    assert set(BY_REASON.values()) <= set(FAULTS)
    assert {kind for kind, *_ in BAD} | {"unreachable", "goal_not_reached", "occupied", "detour"} == set(FAULTS)


def test_a_plan_that_leaves_nothing_out_and_is_too_long_is_a_detour() -> None:
    # Both hands through one door: the second robot waits for nothing, yet one robot does it all.
    found = judged(Cell(task="OpenMicrowavePnP", robots=2), lambda request: {"robot_0": OVEN})
    assert found.valid and not found.optimal
    assert found.error is not None and found.error.type == "detour"


def test_reflection_asks_where_the_earlier_plan_was_not_optimal() -> None:
    planners = {name: make_role("planner", name) for name in ("literal", "noop")}
    trials = list(reflection(planners, ["HeatOnStove"], count=2, robots=[1], starts=["paper"]))
    assert [(t.planner, t.judgement.optimal) for t in trials] == [("literal", True), ("noop", False)] * 2
    for cell in suboptimal("OpenCabinetPnP", count=4, robots=1, starts="mixed"):
        first = teach(cell)
        assert not judged(cell, lambda request, first=first: dict(first.plan)).optimal


def test_wording_counts_with_and_without_reflections() -> None:
    planners = {"literal": make_role("planner", "literal")}
    trials = list(wording(planners, ["OpenCabinetPnP"], count=1, robots=[1], starts=["paper"]))
    assert [t.judgement.valid for t in trials] == [True, True, False, True, False, True]
    cells = as_json("wording", trials)["cells"]
    assert len(cells) == 6 and all(cell["n"] == 1 for cell in cells)


class Learner:
    """Plans as it is told, and keeps what it was asked; as a reflector it has a lesson of its own."""

    def __init__(self, plan: list[str]) -> None:
        self._plan, self.asked = plan, []

    def plan(self, request: PlanRequest) -> list[str]:
        self.asked.append(request)
        return OVEN if request.reflections else self._plan

    def reflect(self, request: ReflectRequest) -> list[str]:
        return [f"mine: not {request.failed[0].predicate}"]


@pytest.mark.parametrize("experiment", [reflection, wording])
def test_reflections_of_its_own_come_from_its_own_first_iteration(experiment: Any) -> None:
    naive, right = Learner(OVEN[2:]), Learner(OVEN)
    planners = {"naive": naive, "right": right}
    given: dict[str, Any] = {"count": 1, "robots": [1], "starts": ["paper"], "reflectors": planners}
    trials = [t for t in experiment(planners, ["OpenMicrowavePnP"], **given) if t.told]
    own = [t for t in trials if t.planner == "naive"]
    assert own and all(t.own and t.lessons == ("mine: not accessible",) and t.judgement.optimal for t in own)
    told = [request for request in naive.asked if request.reflections]
    assert len(told) == len(own)
    for request in told:
        assert request.reflections == ("mine: not accessible",)
        assert request.previous is not None and request.previous.changed and request.previous.success
        assert request.previous_plan == {"robot_0": tuple(OVEN[2:])}
    others = [t for t in trials if t.planner == "right"]  # its first plan is optimal: nothing to reflect on
    assert not any(t.lessons for t in others) and bool(others) is (experiment is wording)
    ruled = [t for t in experiment(planners, ["OpenMicrowavePnP"], **{**given, "reflectors": None}) if t.told]
    assert not any(t.own or t.lessons == ("mine: not accessible",) for t in ruled)
    columns = [cell["column"] for cell in as_json(experiment.__name__, trials)["cells"]]
    assert all(column[1] == "own reflections" for column in columns)


def test_an_answer_that_is_no_plan_is_sent_back_when_plans_alone_are_asked_for() -> None:
    asked: list[PlanRequest] = []

    def planner(request: PlanRequest) -> Any:
        asked.append(request)
        return OVEN if len(asked) == 3 else f"I would rather not ({len(asked)})"

    assert judged(Cell(task="OpenMicrowavePnP"), planner).optimal
    assert [repair.answer for repair in asked[2].repairs] == ["I would rather not (1)", "I would rather not (2)"]
    assert judged(Cell(task="OpenMicrowavePnP"), lambda request: "no").error.type == "parse"  # type: ignore[union-attr]


def test_the_papers_table_is_whole() -> None:
    for part in published().values():
        assert part["source"]
        assert all(len(row) == len(part["columns"]) for row in part["rows"].values())
    grok = [row[5] for row in published()["reflection"]["rows"].values()]
    assert sum(grok) / 4 == pytest.approx(0.825)  # the table's own average


def test_the_commands(tmp_path: Path) -> None:
    shown = CliRunner().invoke(app, ["plan", "--task", "HeatOnStove", "--planner", "literal"])
    answer = json.loads(shown.stdout)
    assert answer["error"]["type"] == "advised_against" and answer["optimum"] == 9
    file = tmp_path / "v.json"
    arguments = ["experiment", "validity", "--planner", "noop", "--n", "1", "--json", str(file)]
    assert CliRunner().invoke(app, arguments).exit_code == 0
    assert json.loads(file.read_text())["faults"] == {"noop": {"missing_step": 4}}
    told = ["plan", "--task", "HeatOnStove", "--planner", "literal", "--reflections", "--reflections-by", "own"]
    assert json.loads(CliRunner().invoke(app, told).stdout)["optimal"]
    for command in (told, ["experiment", "wording", "--reflections", "own"]):
        bad = CliRunner().invoke(app, [*command[:-1], "mine"])
        assert bad.exit_code == 2 and "own, rule" in bad.output
    wrong = CliRunner().invoke(app, ["experiment", "nope"])
    assert wrong.exit_code == 2 and "reflection" in wrong.output
