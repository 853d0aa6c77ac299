"""Plans in the many forms in which models write them; and what must not be taken for a plan."""

from __future__ import annotations

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from remac_agents.plan import MAX_CHARACTERS, MAX_STEPS, Commands, Plan, PlanError, parse_text, read_plan
from remac_env.rules.subtasks import Subtask

TEXTS = ("wait", "done", "navigate aside", "navigate to red box", "pick up cup", "open red box door", "turn on lamp")
COMMANDS = Commands(TEXTS)
ROBOTS = ("robot_0", "robot_1")
CUP, LAMP, OPEN = Subtask("pick up", "cup"), Subtask("turn on", "lamp"), Subtask("open door", "red box")
ONE = Plan.of({"robot_0": [CUP, LAMP]})
TWO = Plan.of({"robot_0": [CUP, LAMP], "robot_1": [OPEN]})


def read(text: str) -> Plan | PlanError:
    return parse_text(text, COMMANDS, ROBOTS, "robot_0")


@pytest.mark.parametrize(
    "text",
    [
        "Plan: [pick up cup, turn on lamp]",
        "plan: ['pick up cup', 'turn on lamp']",
        "**Plan:** [pick up cup, turn on lamp].",
        "The plan is [pick up cup, turn on lamp], as the goal says.",
        "Plan:\n[pick up cup,\n turn on lamp]",
        "agent0: [pick up cup, turn on lamp]",
        "Agent_0: pick up cup, turn on lamp",
        "robot_0: [pick up cup, turn on lamp]",
        "Robot 0's plan:\n1. pick up cup\n2. turn on lamp",
        "### Robot 0\n- **pick up cup**\n- `turn on lamp`",
        "1. pick up cup\n2. turn on lamp",
        "1) Pick up cup.\n\n2) Turn on lamp.",
        "Step 1: pick up cup\nStep 2: turn on lamp",
        "\u2022 pick up cup\n\u2022 turn on\u00a0lamp",
        "* pick up cup\n* turn on lamp",
        "(1) pick up cup\n(2) turn on lamp",
        "1. pick up cup\nNow the light.\n2. turn on lamp",
        '["pick up cup", "turn on lamp"]',
        '{"robot_0": ["pick up cup", "turn on lamp"]}',
        '{"agent0": ["pick up cup", "turn on lamp"]}',
        '{"plan": ["pick up cup", "turn on lamp"]}',
        '{"reason": "it is dark", "plan": {"robot_0": ["pick up cup", "turn on lamp"]}}',
        "```json\n{\n  \"plan\": [\n    \"pick up cup\",\n    \"turn on lamp\"\n  ]\n}\n```",
        "```\npick up cup\nturn on lamp\n```",
        "Sure! The cup comes first.\n\n```json\n[\"pick up cup\", \"turn on lamp\"]\n```\n\nGood luck, and stay safe.",
        "<think>turn on lamp first? [turn on lamp]</think>\nPlan: [pick up cup, turn on lamp]",
        "I turn on lamp later.\n1. turn on lamp</think>[pick up cup, turn on lamp]",
        "Considerations:\n- the room is dark\n- the cup may be full\n\nPlan:\n- pick up cup\n- turn on lamp",
        "Wait, I should look first.\n\nHere is my plan: [pick up cup, turn on lamp]",
        "Plan: [pick up cup, turn on lamp]\nAs I said:\n1. pick up cup\n2. turn on lamp",
        "Plan: [pick up cup, turn on lamp]\n\nDone.",
        "My steps follow:\npick up cup\nturn on lamp",
        "{robot_0: [pick up cup, turn on lamp]}",
        "See [1] and (2). Plan: [pick up cup, turn on lamp]".replace("Plan", "\nPlan"),
    ],
)
def test_all_forms_say_the_same_plan(text: str) -> None:
    assert read(text) == ONE


@pytest.mark.parametrize(
    "text",
    [
        "robot_0: [pick up cup, turn on lamp]\nrobot_1: [open red box door]",
        "agent0: [pick up cup, turn on lamp], agent1: [open red box door]",
        "Plan:\n**robot_0**: [pick up cup, turn on lamp]\n**robot_1**: [open red box door]",
        "robot_0:\n1. pick up cup\n2. turn on lamp\n\nrobot_1:\n1. open red box door",
        "robot_0:\n```\npick up cup\nturn on lamp\n```\nrobot_1:\n```\nopen red box door\n```",
        "{agent0: [pick up cup, turn on lamp], agent1: [open red box door]}",
        "{'robot_0': ['pick up cup', 'turn on lamp'], 'robot_1': ['open red box door']}",
        'Answer: {"plan": {"robot 0": ["pick up cup", "turn on lamp"], "Robot_1": ["open red box door"]}}',
        "## Plan for robot 0\n- pick up cup\n- turn on lamp\n## Plan for robot 1\n- open red box door\n\nThat is all.",
    ],
)
def test_rows_of_two(text: str) -> None:
    assert read(text) == TWO


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("1. pick up cup\n2. fly to the moon\n3. turn on lamp", "fly to the moon"),
        ("pick up cup\nfly to the moon\nturn on lamp", "fly to the moon"),
        ("Plan: [pick up cups, turn on lamp]", "nearest: 'pick up cup'"),
        ("Plan: fly to the moon", "fly to the moon"),
        ("robot_0: the cup", "the cup"),
        ("I would pick up the cup and turn on the lamp.", "is not a command"),
        ("Plan: [p\u0456ck up cup]", "u0456"),
        ("Plan: [pic\u212a up cup]", "u212a"),
        ("pick\u200b up cup", "u200b"),
        ("Plan: [\x1b[31mpick up cup]", "bracket"),
        ("\x1b[31mpick up cup\x1b[0m", "is not a command"),
        ("helper: [pick up cup]", "robot_0, robot_1"),
        ("r\u043ebot_1: [pick up cup]", "u043e"),
        ("Plan: [pick up cup; import os]", "import os"),
        ("Plan: [pick up cup(), turn on lamp]", "pick up cup()"),
        ("<b>pick up cup</b>", "is not a command"),
        ("[pick up cup]\n\n[turn on lamp]", "different plans"),
        ("Plan: [pick up cup]\nFinal plan: [turn on lamp]", "different plans"),
        ("1. pick up cup\n2. turn on lamp\n\nOr else:\n1. turn on lamp", "different plans"),
        ('{"robot_0": ["pick up cup"], "robot_0": ["turn on lamp"]}', "different plans"),
        ('{"plan": ["pick up cup"], "robot_0": ["turn on lamp"]}', "different plans"),
        ("robot_0: [pick up cup]\nrobot_0: [turn on lamp]", "different plans"),
        ("pick up cup [turn on lamp]", "right before a list"),
        ("robot_2: [pick up cup]", "robot_0, robot_1"),
        ('{"robot_9": ["pick up cup"]}', "robot_0, robot_1"),
        ("r\u043ebot_0: [pick up cup]\nrobot_1: [turn on lamp]", "u043e"),
        ("robot_1: [turn on l\u0430mp]", "u0430"),
        ('{"robot_0": "pick up cup"}', "not a list"),
        ('{"robot_0": ["pick up cup"]', "JSON"),
        ('{"robot_0": [["pick up cup"]]}', "not a command"),
        ("<think>Plan: [pick up cup]", "thoughts"),
        ("<think>Plan: [pick up cup]</think>", "no command"),
        ("[" * 50_000, "JSON"),
        ("[]" * 5_000, "lists"),
        ("x" * (MAX_CHARACTERS + 1), str(MAX_CHARACTERS)),
        ("\n".join(["pick up cup"] * 10_000), str(MAX_STEPS)),
    ],
)
def test_nothing_is_understood_as_more_than_it_says(text: str, told: str) -> None:
    error = read(text)
    assert isinstance(error, PlanError), error
    assert told in error.problem
    assert len(error.problem) < 500
    assert error.problem.isascii()


def test_an_empty_plan_may_be_stated() -> None:
    assert read("Plan: []") == Plan.of({"robot_0": []})
    both = read("robot_0: [pick up cup]\nrobot_1: []")
    assert isinstance(both, Plan) and both.row("robot_1") == () and both.length == 1
    assert isinstance(read("robot_0:"), PlanError)


def test_a_word_that_is_also_a_command_counts_where_nothing_else_does() -> None:
    assert read("done") == read("Done.") == Plan.of({"robot_0": [Subtask("done")]})
    assert read("Wait, let me think.\n\n[pick up cup, turn on lamp]") == ONE


def test_mappings_may_hold_the_plan_and_call_robots_otherwise() -> None:
    said = {"plan": {"agent1": ["open red box door"], "robot 0": ["pick up cup", "turn on lamp"]}}
    plan = read_plan(said, COMMANDS, ROBOTS, "robot_0")
    assert isinstance(plan, Plan) and plan.rows == TWO.rows
    endless = read_plan(iter(lambda: "wait", None), COMMANDS, ROBOTS, "robot_0")
    assert isinstance(endless, PlanError) and str(MAX_STEPS) in endless.problem


def test_commands_of_a_kitchen_with_other_letters_are_its_own() -> None:
    commands = Commands(["pick up caf\u00e9"])
    assert isinstance(parse_text("[pick up caf\u00e9]", commands, ("a",), "a"), Plan)
    assert isinstance(parse_text("[pick up cafe]", commands, ("a",), "a"), PlanError)


@given(st.text(max_size=300) | st.text(alphabet="[]{}:,\"'\n-1. #*`<>/thinkpcu robt_0", max_size=300))
def test_no_text_is_an_exception(text: str) -> None:
    plan = read(text)
    if isinstance(plan, Plan):
        assert all(COMMANDS.allows(step) for row in plan.rows.values() for step in row)


UNITS = ["[", "{", "[]", "a: ", "- ", "1. ", "<think>", "```\n", "\n", " ", "[a,", '"', "#*", "assistant "]
BEFORE = ["<|channel|>a", "", "[", "Thinking...\n", "assistant", "analysis", "<", "<|channel|>final", "Plan:", "{a"]
QUICK = ("[", "<|channel|>final")


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize(
    "before", [before if before in QUICK else pytest.param(before, marks=pytest.mark.long) for before in BEFORE]
)
def test_reading_takes_no_more_than_a_few_steps_a_letter(before: str, unit: str) -> None:
    """A text twice as long may take twice as long, not four times: whole texts of models are up to MAX_CHARACTERS."""
    start = time.process_time()
    read(before + unit * ((MAX_CHARACTERS - 20) // len(unit)) + "x}")
    assert time.process_time() - start < 5.0, "a hang: the text is read in far less than a second otherwise"
