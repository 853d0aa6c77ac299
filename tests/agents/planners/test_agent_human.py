"""The planner at the keyboard, played from a script."""

from __future__ import annotations

import io

import pytest
from agent_kitchens import play, suite_kitchen

import remac_agents
from remac_agents.planners.human import completer

TASK = "OpenCabinetPnP"
PLAN = ("navigate to cabinet", "open cabinet door", "navigate to vegetable", "pick up vegetable",
        "navigate to cabinet", "place to cabinet")  # fmt: skip


def typed(monkeypatch: pytest.MonkeyPatch, *lines: str) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(line + "\n" for line in lines)))


def test_a_typed_plan_is_played(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    typed(monkeypatch, PLAN[0], "opn cabinet door", "?", "turn on faucet", "undo", *PLAN[1:], "")
    report = play(suite_kitchen(TASK, robots=1), remac_agents.make("BASE", planner="human"))
    assert report.success and report.initial_plan["robot_0"] == PLAN
    said = capsys.readouterr().out
    assert "nearest: 'open cabinet door'" in said and "navigate aside" in said and "robot_0 1>" in said


def test_a_terminal_breaks_no_word(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    said = []
    for columns in ("", "60"):
        typed(monkeypatch, *PLAN, "")
        monkeypatch.setenv("COLUMNS", columns)
        monkeypatch.setattr("sys.stdout.isatty", lambda narrow=bool(columns): narrow)
        assert play(suite_kitchen(TASK, robots=1), remac_agents.make("BASE", planner="human")).success
        said.append(capsys.readouterr().out.replace("robot_0 7> ", ""))
    wide, narrow = said
    assert max(map(len, wide.splitlines())) > 200 and max(map(len, narrow.splitlines()[:8])) < 60
    assert wide.split() == narrow.split()


def test_a_stream_may_begin_with_a_byte_order_mark(monkeypatch: pytest.MonkeyPatch) -> None:
    typed(monkeypatch, "\ufeff" + PLAN[0], *PLAN[1:], "")
    report = play(suite_kitchen(TASK, robots=1), remac_agents.make("BASE", planner="human"))
    assert report.success and report.initial_plan["robot_0"] == PLAN


def test_one_step_at_a_time_with_the_cause_of_a_refusal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    typed(monkeypatch, "open cabinet door", *PLAN)
    report = play(suite_kitchen(TASK, robots=1), remac_agents.make("CAPE", planner="human"))
    assert report.success and report.final_plan["robot_0"] == PLAN
    assert "not_at_station" in capsys.readouterr().out


def test_people_are_told_how_the_try_before_went(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    env, agent = suite_kitchen(TASK, robots=1), remac_agents.make("RE", planner="human")
    for plan in (PLAN[2:], PLAN):
        typed(monkeypatch, *plan, "")
        assert play(env, agent).success
    said = capsys.readouterr().out
    assert said.count("The try before:") == 1
    assert "  It reached the goal in " in said and "  1. robot_0: navigate to" in said


def test_nobody_types(monkeypatch: pytest.MonkeyPatch) -> None:
    typed(monkeypatch)
    report = play(suite_kitchen(TASK), remac_agents.make("BASE", planner="human"))
    assert not report.success and "--jobs 0" in report.errors[0]


def test_an_input_without_end_or_sense_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    typed(monkeypatch, *["\x1b[2J nonsense"] * 5000)
    report = play(suite_kitchen(TASK), remac_agents.make("BASE", planner="human"))
    assert report.initial_plan_length == 0


def test_completion() -> None:
    complete = completer(["pick up cup", "pick up pot", "turn on lamp"])
    assert [complete("Pick", index) for index in range(3)] == ["pick up cup", "pick up pot", None]
    assert complete("lamp", 0) == "turn on lamp" and complete("moon", 0) is None
