"""Reading of plans: strict, and errors are values."""

from __future__ import annotations

import pytest

from remac_agents.plan import MAX_STEPS, Commands, Plan, PlanError, read_plan
from remac_env.rules.subtasks import WAIT, Subtask

COMMANDS = Commands(
    [
        "wait",
        "done",
        "navigate aside",
        "navigate to red box",
        "pick up cup",
        "open red box door",
        "turn on lamp",
    ]
)
ROBOTS = ("robot_0", "robot_1")
CUP = Subtask("pick up", "cup")


def read(reply: object) -> Plan | PlanError:
    return read_plan(reply, COMMANDS, ROBOTS, "robot_1")


def test_every_command_becomes_its_subtask() -> None:
    assert COMMANDS["open red box door"] == Subtask("open door", "red box")
    assert COMMANDS["navigate aside"] == Subtask("navigate aside")
    assert COMMANDS.parse(' "Pick  Up_cup." ') == CUP
    assert COMMANDS.parse("pick up lamp") is None
    assert COMMANDS.parse("\ufeffpick up cup") == COMMANDS.parse(" \ufeff Pick up cup") == CUP
    assert COMMANDS.parse("pick\ufeff up cup") is None
    for row in ({"\ufeffrobot_1": ["pick up cup"]}, {"\ufeffplan": ["\ufeffpick up cup"]}):
        assert read(row) == read(["pick up cup"])
    assert "two rows" in read({"\ufeffrobot_1": [], "robot_1": ["pick up cup"]}).problem  # type: ignore[union-attr]
    assert len(COMMANDS) == 7


@pytest.mark.parametrize(
    "reply",
    [
        {"robot_1": ["pick up cup", "turn on lamp"]},
        ["pick up cup", "turn on lamp"],
        [CUP, "turn on lamp"],
        "1. pick up cup\n2. turn on lamp",
        "- pick up cup; turn on lamp.",
        "Robot 1: pick up cup, turn on lamp",
        '{"robot_1": ["pick up cup", "turn on lamp", "wait"]}',
        '["pick up cup", "turn on lamp"]',
    ],
)
def test_forms_of_one_plan(reply: object) -> None:
    assert read(reply) == Plan.of({"robot_1": [CUP, Subtask("turn on", "lamp")]})


def test_rows_of_two_robots() -> None:
    plan = read("robot_0: pick up cup\nturn on lamp\nrobot_1:\nnavigate aside")
    assert isinstance(plan, Plan)
    assert plan.length == 2
    assert plan.round(1) == {"robot_0": Subtask("turn on", "lamp"), "robot_1": WAIT}


@pytest.mark.parametrize(
    ("reply", "told"),
    [
        (["pick up moon"], "pick up moon"),
        ({"robot_7": ["pick up cup"]}, "robot_0, robot_1"),
        ({"robot_0": "pick up cup"}, "not a list"),
        (7, "int"),
        (None, "NoneType"),
        ("", "no command"),
        ("{not json", "JSON"),
        ("[" * 100_000, "JSON"),
        (["pick up cup"] * (MAX_STEPS + 1), str(MAX_STEPS)),
        ([["pick up cup"]], "not a command"),
        ([Subtask("pick up", "moon")], "moon"),
        (Plan.of({"robot_0": [Subtask("pick up", "moon")]}), "moon"),
    ],
)
def test_what_is_no_plan_is_an_error_that_says_why(reply: object, told: str) -> None:
    error = read(reply)
    assert isinstance(error, PlanError)
    assert told in error.problem


def test_steps_put_in_front_keep_later_rounds_side_by_side() -> None:
    lamp, aside = Subtask("turn on", "lamp"), Subtask("navigate aside")
    plan = Plan.of({"a": [lamp], "b": [aside, CUP]})
    assert plan.with_row("a", [CUP, CUP, lamp]).rows["b"] == (WAIT, WAIT, aside, CUP)
    assert plan.with_row("b", [CUP]) == Plan.of({"a": [lamp], "b": [WAIT, CUP]})
    assert Plan.of({"a": [lamp, CUP]}).with_row("a", [CUP]) == Plan.of({"a": [CUP]})


@pytest.mark.parametrize("reply", [b"wait", bytearray(b"wait"), memoryview(b"wait"), {"robot_0": b"wait"}])
def test_bytes_are_no_list_of_numbers(reply: object) -> None:
    found = read_plan(reply, Commands(["wait"]), ("robot_0",), "robot_0")
    assert isinstance(found, PlanError) and "not" in found.problem and "command;" not in found.problem
