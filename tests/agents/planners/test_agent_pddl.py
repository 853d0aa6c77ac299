"""Programs that plan from PDDL: real processes, that are killed with all they started, and plans that are looked at."""

from __future__ import annotations

import os
import shutil
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from agent_kitchens import play, suite_kitchen

import remac_agents
from remac_agents.planners.child import CommandError, run_command
from remac_agents.planners.parallel_steps import StepError, in_rounds
from remac_agents.wiring.catalogue import is_plugin, looks_at_pictures, make_role
from remac_env.errors import OptionError, UnknownNameError
from remac_env.pddl import printed_plan, read_plan
from remac_env.rules.rounds import transition

TASK, SEED = "OpenCabinetPnP", 1
PLAN = """(drive-by-aside-to-by-cabinet robot_0)
(open-cabinet robot_0 by-cabinet)
(drive-by-cabinet-to-by-counter_right robot_0)
(pick-up robot_0 by-counter_right vegetable slot-counter_3 counter)
(drive-by-counter_right-to-by-cabinet robot_0)
(place-neatly robot_0 by-cabinet vegetable plate slot-cabinet_0 cabinet n0 n1)
"""
SHARED = """(drive-by-aside-to-by-counter_right robot_0)
(pick-up robot_0 by-counter_right vegetable slot-counter_3 counter)
(drive-by-aside-to-by-cabinet robot_1)
(open-cabinet robot_1 by-cabinet)
(drive-by-cabinet-to-by-aside robot_1)
(drive-by-counter_right-to-by-cabinet robot_0)
(place-neatly robot_0 by-cabinet vegetable plate slot-cabinet_0 cabinet n0 n1)
"""


def kitchen(robots: int = 1):  # type: ignore[no-untyped-def]
    return suite_kitchen(TASK, robots=robots, layout="one_wall_large")


def script(folder: Path, body: str) -> str:
    """A planner: a shell script that is called with domain and problem."""
    path = folder / "planner"
    path.write_text(f"#!/bin/sh\n{body}\n", "utf-8")
    path.chmod(0o755)
    return str(path)


def report_of(planner: str, *, robots: int = 1, method: str = "BASE"):  # type: ignore[no-untyped-def]
    return play(kitchen(robots), remac_agents.make(method, planner=planner), seed=SEED)


def gone(number: int) -> bool:
    """Whether a process is no more, or only its entry is left; it may take a moment."""
    for _ in range(100):
        try:
            state = Path(f"/proc/{number}/stat").read_text("utf-8").rpartition(")")[2].split()[0]
        except OSError:
            return True
        if state == "Z":
            return True
        time.sleep(0.02)
    return False


@pytest.mark.parametrize(
    "say",
    [
        "cat <<E\n; cost 9\n{plan}\nE",
        "echo searching, 3 states; cat > problem.pddl.soln <<E\n{plan}\nE",
        "cat > sas_plan <<E\n{plan}\nE\nexit 3",
        "echo '(open-cabinet robot_0 by-cabinet)'; echo better; cat <<E\n{plan}\nE\necho done",
    ],
    ids=["printed", "soln", "sas_plan", "the last"],
)
def test_a_program_plans(tmp_path: Path, say: str) -> None:
    planner = "pddl:" + script(tmp_path, f'test -s "$1" && test -s "$2" || exit 9\n{say.format(plan=PLAN)}')
    report = report_of(planner)
    assert report.success and report.final_plan_length == 6 and report.errors == ()
    assert "planner" in report.truth_readers and "planner" in report.rule_readers and report.isolated is True
    assert not is_plugin("planner", planner) and not looks_at_pictures("planner", planner)


def test_a_command_names_its_files_and_commas_are_escaped(tmp_path: Path) -> None:
    path = script(tmp_path, f'test "$1" = "a,b=c d" && test -s "$3" && cat > "$2" <<E\n{PLAN}\nE')
    assert report_of(f"pddl:{path} 'a\\,b=c d' {{plan}} {{problem}},seconds=30").success
    told = report_of(f"pddl:{path} 'a\\,b=c  d' {{plan}} {{problem}}").errors
    assert len(told) == 3 and "gave no plan (status 1)" in told[0]


def test_steps_are_done_side_by_side_where_that_makes_no_difference(tmp_path: Path) -> None:
    report = report_of("pddl:" + script(tmp_path, f"cat <<E\n{SHARED}\nE"), robots=2)
    assert report.success and report.final_plan_length == 4
    assert report.final_plan["robot_1"] == ("navigate to cabinet", "open cabinet door", "navigate aside")
    env = kitchen(2)
    env.reset(seed=SEED)
    rules, world = env.start.scene, env.world
    for joint in in_rounds(rules, world, read_plan(SHARED, rules)):
        world, outcomes = transition(rules, world, joint)
        assert all(outcome.success for outcome in outcomes.values())
    assert env.goal.holds(rules, world)
    with pytest.raises(StepError, match="pick up vegetable of robot_0 does not succeed"):
        in_rounds(rules, env.world, read_plan(SHARED, rules)[1:])


def test_react_asks_it_for_each_robot(tmp_path: Path) -> None:
    planner = "pddl:" + script(tmp_path, f"cat <<E\n{SHARED}\nE")
    env = suite_kitchen(TASK, robots=2, layout="one_wall_large", clock="events", max_seconds=30.0)
    report = play(env, remac_agents.make("REACT", planner=planner), seed=SEED, most=200)
    assert report.executed[0].robot in ("robot_0", "robot_1")


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("echo 'I know of none' >&2; exit 4", "gave no plan (status 4): I know of none"),
        ("yes '(fly)' | head -c 3000000", "printed more than 100000 bytes"),
        ("yes '(fly robot_0)' | head -c 300000 > sas_plan", "its plan has more than 100000 bytes"),
        ("echo '(fly robot_0)' > sas_plan", "plan, line 1: '(fly robot_0)' is not valid"),
        ("echo '(open-cabinet robot_0 by-cabinet)'", "open door cabinet of robot_0 does not succeed"),
        ("head -c 90000 /dev/urandom", "gave no plan (status 0)"),
        ("head -c 90000 /dev/urandom > sas_plan", "is not valid"),
        ("ln -s /etc/hostname sas_plan", "gave no plan"),
        ("kill -9 $$", "gave no plan (status -9)"),
        ("yes '(drive-by-aside-to-by-cabinet robot_0)' | head -300", "its plan has 300 steps; valid: at most 200"),
    ],
)  # fmt: skip
def test_what_is_no_plan_is_an_error_of_the_planner(tmp_path: Path, body: str, told: str) -> None:
    report = report_of(f"pddl:{script(tmp_path, body)},most_bytes=100000")
    assert not report.success and told in report.errors[0]


def test_when_its_time_is_up_it_is_killed_with_all_that_it_started(tmp_path: Path) -> None:
    numbers = tmp_path / "numbers"
    body = f"sleep 600 & echo $! > {numbers}; echo $$ >> {numbers}; trap '' TERM; sleep 600"
    report = report_of(f"pddl:{script(tmp_path, body)},seconds=0.5")
    assert "had not ended after 0.5 s" in report.errors[0]
    assert all(gone(int(number)) for number in numbers.read_text("utf-8").split())


def test_what_it_leaves_behind_is_killed_too(tmp_path: Path) -> None:
    numbers = tmp_path / "numbers"
    report = report_of("pddl:" + script(tmp_path, f"sleep 600 & echo $! >> {numbers}\ncat <<E\n{PLAN}\nE"))
    assert report.success and all(gone(int(number)) for number in numbers.read_text("utf-8").split())


def test_one_that_got_away_with_the_pipe_does_not_hold_us(tmp_path: Path) -> None:
    away = f"{sys.executable} -c 'import os,sys,time; os.setsid(); open(sys.argv[1],\"w\").write(str(os.getpid())); " \
           f"time.sleep(600)' {tmp_path / 'number'}"  # fmt: skip
    body = f"{away} & while ! test -s {tmp_path / 'number'}; do sleep 0.05; done; echo here"
    assert run_command([script(tmp_path, body)], folder=tmp_path, seconds=60, most_bytes=99).text == "here\n"
    os.kill(int((tmp_path / "number").read_text("utf-8")), 9)


def test_its_folder_is_gone_afterwards(tmp_path: Path) -> None:
    report_of("pddl:" + script(tmp_path, f"pwd > {tmp_path / 'where'}"))
    where = Path((tmp_path / "where").read_text("utf-8").strip())
    assert where.is_absolute() and not where.exists()


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("pddl:no-such-planner", "there is no program 'no-such-planner'"),
        ("pddl:", "there is no program ''"),
        ("pddl:sh 'x", "No closing quotation"),
        ("pddl:sh,level=adl", "strips, durative"),
        ("pddl:sh,seconds=0", "seconds 0"),
        ("pddl:sh,most_bytes=-1", "most_bytes -1"),
        ("pddl:sh,tea=1", "tea"),
    ],
)
def test_what_cannot_be_run_is_refused(given: str, told: str) -> None:
    with pytest.raises((OptionError, UnknownNameError), match=told.replace("(", r"\(")):
        make_role("planner", given)
    with pytest.raises(CommandError, match="does not start"):
        run_command(["/no/such"], folder=Path("/"), seconds=1, most_bytes=1)


def test_tasks_that_pddl_cannot_say_get_no_plan(tmp_path: Path) -> None:
    env = suite_kitchen("HeatAndShelve", robots=1, clock="events")
    report = play(env, remac_agents.make("BASE", planner="pddl:" + script(tmp_path, "echo")), seed=SEED)
    assert "cannot say what nobody wants to happen: burning" in report.errors[0]


RINSING = """0.000: (drive-by-aside-to-by-counter_island_left robot_0) [6.000]
6.001: (pick-up robot_0 by-counter_island_left vegetable slot-island_2 counter) [8.000]
14.002: (drive-by-counter_island_left-to-by-sink robot_0) [6.000]
20.003: (place robot_0 by-sink vegetable slot-sink_0 sink) [9.000]
29.004: (turn-on-faucet robot_0 by-sink) [7.000]
36.005: (faucet-washed vegetable slot-sink_0) [20.000]
49.006: (turn-off-faucet robot_0 by-sink) [7.000]
49.006: (drive-by-aside-to-by-microwave robot_1) [6.000]
56.007: (open-microwave robot_1 by-microwave) [9.000]
65.008: (drive-by-microwave-to-by-counter_right robot_1) [6.000]
71.009: (pick-up robot_1 by-counter_right fish slot-counter_4 counter) [8.000]
79.010: (drive-by-counter_right-to-by-microwave robot_1) [6.000]
85.011: (place robot_1 by-microwave fish slot-microwave_0 microwave) [9.000]
"""


@pytest.mark.parametrize("method", ["BASE", "CC"])
def test_what_takes_its_time_is_waited_for(tmp_path: Path, method: str) -> None:
    planner = "pddl:" + script(tmp_path, f"cat <<E\n{RINSING}\nE") + ",level=durative"
    env = suite_kitchen("RinseAndStow", robots=2, layout="one_wall_large", clock="events")
    report = play(env, remac_agents.make(method, planner=planner), seed=0, most=200)
    assert report.success and report.errors == (), report
    row = report.final_plan["robot_0"]
    assert row.index("turn off faucet") - row.index("turn on faucet") > 1, "it waits while water runs"


def test_what_is_waited_for_in_vain_is_no_plan() -> None:
    env = suite_kitchen("RinseAndStow", robots=2, layout="one_wall_large", clock="events")
    env.reset(seed=0)
    rules, world = env.start.scene, env.world
    with pytest.raises(StepError, match="waits for rinsing of the vegetable, which does not go on"):
        in_rounds(rules, world, [step for step in read_plan(RINSING, rules) if step.skill != "turn on"])
    impatient = in_rounds(rules, world, [replace(step, awaits=()) for step in read_plan(RINSING, rules)])
    patient = in_rounds(rules, world, read_plan(RINSING, rules))
    assert len(patient) > len(impatient)


def test_the_last_plan_is_found_among_what_is_printed() -> None:
    env = kitchen()
    env.reset(seed=SEED)
    rules, first = env.start.scene, PLAN.splitlines()[0]
    text = f"found\n{first}\n; better plan\n{PLAN}\n\nsearch over\n[t=0.1s, 2 KB] done (1)\n"
    assert read_plan(printed_plan(text, rules), rules) == read_plan(PLAN, rules)
    assert printed_plan("nothing here\n(fly robot_0)\n", rules) == ""


BINARIES = Path(sys.prefix) / "bin"
REAL = (
    ("pyperplan", "pyperplan -H hff -s gbf {domain} {problem},seconds=300"),
    ("kairos", "kairos --timeout 5 --format popf --threads 1 {domain} {problem},level=durative"),
)


@pytest.mark.long
@pytest.mark.parametrize(("program", "command"), REAL, ids=[program for program, _ in REAL])
@pytest.mark.parametrize("robots", [1, 2])
def test_real_planners_reach_the_goal(program: str, command: str, robots: int) -> None:
    found = shutil.which(program, path=os.pathsep.join((str(BINARIES), os.environ["PATH"])))
    if found is None:
        pytest.skip(f"no {program} here: make pddl")
    report = report_of(f"pddl:{command.replace(program, found, 1)}", robots=robots)
    assert report.success and report.errors == (), report.errors
