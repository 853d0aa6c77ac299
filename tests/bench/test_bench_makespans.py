"""Makespans beside a planner's: what is printed where they agree, where a plan is too long, and where there is none."""

from __future__ import annotations

import shlex
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import makespans
import pytest
import typer
from test_bench_cli import remac

import remac_env
from remac_env.events.makespan import Makespan, makespan
from remac_env.pddl import Played, Step, state_plan

TASK = {"tasks": "OpenMicrowavePnP", "seeds": "1:2", "starts": "mixed", "robots": 1, "layout": "one_wall_large"}


def our_steps(task: str = "OpenMicrowavePnP", robots: int = 1, **options: Any) -> tuple[Any, list[Step]]:
    kitchen = {"robots": robots, "backend": "symbolic", "clock": "events", "layout": "one_wall_large"}
    env = remac_env.parallel_env(task, **kitchen, **options)
    _, infos = env.reset(seed=1)
    return env, makespans._played(env, infos, makespan(env.start, env.goal))


@pytest.mark.parametrize("task", remac_env.tasks())
def test_our_shortest_plan_is_one_of_the_exported_problem(task: str) -> None:
    env, steps = our_steps(task)
    stated = state_plan(env.start.scene, env.start.world, env.goal, steps)
    assert stated.problem == "" and len(stated.text.splitlines()) >= len(steps)


def test_what_is_no_plan_of_the_problem_is_named() -> None:
    env, steps = our_steps()
    told = (env.start.scene, env.start.world, env.goal)
    early = [Step(0.0, step.robot, step.skill, step.target, step.seconds) for step in steps]
    assert "no action of the domain does that then" in state_plan(*told, early).problem
    assert "no action of the domain" in state_plan(*told, steps[1:]).problem
    assert state_plan(*told, steps[:-1]).problem.startswith("not true in the end: ")


@pytest.mark.long
def test_what_the_domain_cannot_say_of_two_robots_is_named() -> None:
    env, steps = our_steps(robots=2)
    problem = state_plan(env.start.scene, env.start.world, env.goal, steps).problem
    assert problem.startswith("navigate to microwave at 15 s: ")  # in the moment in which the other one leaves it


def planner(tmp_path: Path, text: str) -> str:
    """A command line that prints a plan, whatever it is asked."""
    file = tmp_path / "planner.py"
    file.write_text(f"print({text!r})\n", "utf-8")
    return shlex.join([sys.executable, str(file)]) + " {domain} {problem}"


@pytest.mark.parametrize("found", [True, False])
def test_episode_and_table_say_how_they_stand(found: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    env, steps = our_steps(starts="mixed")
    text = state_plan(env.start.scene, env.start.world, env.goal, steps).text if found else "no solution"
    validate = shlex.join([sys.executable, "-c", "import sys; sys.exit(1)"])
    makespans.main(**TASK, by=planner(tmp_path, text), validate=validate, states=2000)  # type: ignore[arg-type]
    row = next(line for line in capsys.readouterr().out.splitlines() if "of the same problem" in line)
    assert ("the same  " if found else "no plan in its time") in row and "not valid" in row


@pytest.mark.parametrize("plan", [b"", None, b"\xff"], ids=["empty", "none", "no text"])
def test_a_plan_that_cannot_be_read_is_refused_before_anything_is_written(plan: bytes | None, tmp_path: Path) -> None:
    path, out = tmp_path / "plan", tmp_path / "out"
    if plan is not None:
        path.write_bytes(plan)
    command = ("pddl", "--task", "HeatOnStove", "--seed", "1", "--out", str(out), "--plan", str(path))
    result = remac(*command)
    if plan == b"":
        assert result.exit_code == 0, result.output
    else:
        assert (result.exit_code, result.output.count("\n")) == (2, 1) and "valid: " in result.output
        assert not out.exists()


def test_each_difference_is_told_apart() -> None:
    best = Makespan(plan=(), seconds=40.0, lower=40.0, proof="search", expanded=1)
    compare = makespans._compare
    assert compare(best, Played(True, 40.02, ())) == ("the same", None)
    assert compare(best, Played(True, 46.0, ())) == ("longer", 6.0)
    assert compare(best, Played(True, 34.0, ())) == ("shorter", -6.0)
    assert compare(best, Played(False, 34.0, ())) == ("its plan does not reach the goal", None)
    assert compare(replace(best, proof="bounds"), Played(True, 34.0, ())) == ("ours is not known", None)


@pytest.mark.parametrize("by", ["kairos {nothing}", "no-such-planner {domain}"])
def test_a_command_line_that_does_not_run_is_refused(by: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(typer.Exit):
        makespans.main(**TASK, by=by, validate="", states=2000)  # type: ignore[arg-type]
    assert "does not run" in (told := capsys.readouterr().err) and "valid: a command line, with {domain}" in told
