"""Suites of generated tasks, their tables, and the command that makes tasks."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from remac_bench.cli import app
from remac_bench.experiments.headroom import AGENTS, half_of, jobs_of, share, tables
from remac_bench.generating import make_rows, summary
from remac_bench.playing import suites
from remac_bench.playing.runner import run_jobs
from remac_bench.playing.settings import Settings
from remac_bench.store import Store
from typer.testing import CliRunner

from remac_agents import make as make_agent
from remac_env.errors import UnknownNameError
from remac_env.generator import templates


@pytest.mark.parametrize(("name", "jobs"), [("graded", 300), ("graded-heldout", 100), ("quirks", 90), ("teams", 30)])
def test_suites_have_their_problems_once_for_each_method(name: str, jobs: int) -> None:
    suite = suites.load(name)
    made = [job for job in suite.jobs(checked=False) if not suite.is_floor(job.agent)]
    assert len(made) == jobs * 4
    assert {job.task for job in made} == {"Generated"}
    assert all(job.options.backend == "symbolic" and job.options.grade for job in made)
    if name == "graded-heldout":
        assert {job.options.template for job in made} == {"held out"}
    if name == "teams":
        assert all(job.options.robots == 2 for job in suite.jobs())  # floors too, and every kitchen can be made


def test_agents_that_ask_no_model_are_played_and_counted(tmp_path: Path) -> None:
    jobs = [job for name in ("witness", "random", "RE") for job in jobs_of(name, [0], grades=(1,))]
    jobs = [job for job in jobs if job.options.quirks and job.options.knowledge == "seen"]
    run_jobs(jobs, tmp_path, Settings(workers=0))
    records = list(Store(tmp_path).read())
    witness = [record for record in records if "witness" in str(record.options["agent"])]
    assert share(witness, grade=1, quirks=2).told == "100%" and share(witness, grade=1, quirks=2).problems == 1
    assert half_of(witness, 2) == "1" and half_of(witness, 0) == "none"
    success, curve = tables(records)
    assert success.row_count == 3 and curve.row_count == 2
    assert {record.goal for record in records} == {records[0].goal}  # one task for one seed, whoever plays it


def test_the_agents_can_be_made() -> None:
    for method, keywords in AGENTS.values():
        make_agent(method, **keywords)


def test_tasks_are_made_by_command_in_lines_of_json() -> None:
    args = ["tasks", "generate", "--grades", "1,2", "--seeds", "0:2", "--json", "--quirks", "1"]
    result = CliRunner().invoke(app, args)
    rows = [json.loads(line) for line in result.stdout.splitlines() if line.startswith("{")]
    assert [(row["grade"], row["seed"]) for row in rows] == [(1, 0), (1, 1), (2, 0), (2, 1)]
    assert all(row["lower"] <= row["upper"] and row["template"] in templates.load() for row in rows)


def test_what_cannot_be_made_is_said_in_the_summary() -> None:
    made = make_rows([1], [0], {"template": "lights out", "quirks": 3})
    assert not made.rows and any("lights out" in line for line in summary(made))
    with pytest.raises(UnknownNameError):
        make_rows([7], [0], {})
