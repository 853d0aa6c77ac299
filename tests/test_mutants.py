"""Tests can fail: each line of code that is broken here makes a named test fall.

Every mutant is a process of its own, which breaks one thing before anything else has read it and then runs the test.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

SKILLS_ROW = """
from dataclasses import replace
from remac_env.rules import skills
row = skills.SKILLS["{skill}"]
skills.SKILLS["{skill}"] = replace(row, requires=lambda *names: tuple(
    needed for needed in row.requires(*names) if needed.condition.predicate != "{predicate}"))
"""
"""The skill table without one of its requirements."""

NOTES = """
from remac_agents.running import bookkeeper
class Notes(set):
    {change}
made = bookkeeper.Bookkeeper.__init__
def make(self, *args, **kwargs):
    made(self, *args, **kwargs)
    self._noted = Notes()
bookkeeper.Bookkeeper.__init__ = make
"""

MUTANTS: dict[str, tuple[str, str]] = {
    "perception noise is off": (
        "from remac_env.backends.physics.team import Team\nTeam._disturb = lambda self, now: None",
        "tests/backends/test_perception.py::test_each_round_looks_anew_and_each_episode_alike",
    ),
    "a sentence is dropped": (
        "from remac_env.rules import predicates, skills\ndel predicates.PREDICATES['graspable']",
        "tests/symbolic/test_symbolic_skills.py::test_every_row_gives_reasons_of_the_closed_list_and_sentences",
    ),
    "a sentence that no skill needs is dropped": (
        "from remac_env.rules import predicates\ndel predicates.PREDICATES['directly_on']",
        "tests/symbolic/test_symbolic_skills.py::test_what_can_be_asked_of_a_kitchen_can_still_be_asked",
    ),
    "a requirement is dropped": (
        SKILLS_ROW.format(skill="season", predicate="accessible"),
        "tests/symbolic/test_symbolic_skills.py::test_a_door_that_is_not_open_keeps_things_in_and_out",
    ),
    "a torque limit is raised": (
        "from remac_env.robots.panda import measures as panda\npanda.ARM_FORCE = (87.0,) * 4 + (40.0,) * 3",
        "tests/backends/test_forces.py::test_the_makers_limits_hold",
    ),
    "things stand at the side of a cavity": (
        "from remac_env.kitchen import starts\nstarts.HAND_ROOM = 0.0",
        "tests/env/test_env_starts.py::test_a_hand_gets_at_what_stands_in_a_cavity",
    ),
    "a slip takes no time": (
        "from remac_env.backends.symbolic import SymbolicBackend\ntimed = SymbolicBackend._timed\n"
        "SymbolicBackend._timed = lambda self, told, subtask: (\n"
        "    told if told.reason == 'slipped' else timed(self, told, subtask))",
        "tests/env/test_env_episode.py::test_what_is_tried_takes_its_time_and_what_is_refused_takes_none",
    ),
    "a slip takes no time in physics": (
        "from dataclasses import replace\nfrom remac_env.backends.physics import timeline\n"
        "judged = timeline.Timeline._judged\n"
        "def timeless(*args):\n    found = judged(*args)\n"
        "    return replace(found, seconds=0.0) if found.reason == 'slipped' else found\n"
        "timeline.Timeline._judged = timeless",
        "tests/backends/test_falls.py::test_a_skill_that_only_says_that_it_took_something_slipped_and_took_its_time",
    ),
    "checks are noted again and again": (
        NOTES.format(change="__contains__ = lambda self, key: False"),
        "tests/agents/methods/test_agent_methods.py::test_a_question_is_noted_once_a_moment_and_again_in_the_next_round",
    ),
    "checks are noted in one round only": (
        NOTES.format(change="clear = lambda self: None"),
        "tests/agents/methods/test_agent_methods.py::test_a_question_is_noted_once_a_moment_and_again_in_the_next_round",
    ),
}
"""What is broken: the code that breaks it, and the test that falls."""

QUICK = ("perception noise is off", "a sentence is dropped")
"""Those that the fast tests hold as well; each takes a process of some seconds. That a raised torque limit is seen is a
fast test of tests/backends/test_forces.py."""


def run_test(test: str, mutant: str = "") -> tuple[int, str]:
    """Run one test in a process where the mutant's code came first: pytest's exit code and what it printed."""
    code = f"{mutant}\nimport pytest, sys\nsys.exit(pytest.main(['-x', '-p', 'no:cacheprovider', '-n', '0', {test!r}]))"
    path = os.pathsep.join((str(ROOT), str(ROOT / "benchmarks")))
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True
    )
    return done.returncode, done.stdout + done.stderr


@pytest.mark.parametrize("name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.long) for n in MUTANTS])
def test_a_mutant_makes_its_test_fall(name: str) -> None:
    mutant, test = MUTANTS[name]
    code, told = run_test(test, mutant)
    assert code == pytest.ExitCode.TESTS_FAILED, told
    assert f"FAILED {test}" in told and "1 failed" in told, told


@pytest.mark.long
def test_without_a_mutant_the_test_stands() -> None:
    """So that it is the mutants, not the way in which they are run, that make tests fall."""
    code, told = run_test(MUTANTS["a sentence is dropped"][1])
    assert code == pytest.ExitCode.OK, told
