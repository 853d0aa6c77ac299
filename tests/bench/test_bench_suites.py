"""Suites: what stands in the files that come with the benchmark, and what is wrong with others."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import TASKS, read
from remac_bench.errors import UsageError
from remac_bench.playing import suites
from remac_bench.playing.runner import Settings, run_jobs
from test_bench_cli import remac

FLOORS = ("reader", "memorised", "random")

TEXT = """
name = "mine"
version = 1
methods = ["BASE", "CC"]
[budget]
retries = 1
max_calls = 7
[[jobs]]
tasks = ["HeatOnStove"]
seeds = "0:2"
kitchen = { backend = "symbolic" }
"""


def written(folder: Path, text: str = TEXT) -> str:
    """The path of a suite file."""
    path = folder / "mine.toml"
    path.write_text(text)
    return str(path)


def test_every_suite_that_comes_along_can_be_read_and_keeps_clear_of_the_kept_seeds() -> None:
    assert set(suites.names()) >= {"smoke", "paper", "baselines", "phases", "full", "mixed", "heldout"}
    for name in suites.names():
        suite = suites.load(name)
        assert suite.name == name
        assert suite.about
        assert all(seed < 900_000 for block in suite.blocks for seed in block.seeds)


def test_the_paper_suite_is_four_tasks_ten_starts_four_methods_twice() -> None:
    jobs = suites.load("paper").jobs(backend="symbolic")
    assert {job.task for job in jobs} == set(TASKS)
    assert {job.options.perception_noise for job in jobs} == {0.0, 0.02}
    floors = [job for job in jobs if job.agent.get("planner") in FLOORS]
    assert len(jobs) - len(floors) == 4 * 10 * 4 * 2
    assert {job.method for job in floors} == {"BASE"} and len(floors) == 4 * 10 * 2 * len(FLOORS)


def test_the_paper_suite_with_learned_skills_differs_in_them_alone() -> None:
    learned = {(job.task, job.seed, job.method): job for job in suites.load("paper-learned").jobs()}
    paper = {(job.task, job.seed, job.method): job for job in suites.load("paper").jobs()}
    assert set(learned) == set(paper)
    # The paper's split: doors and switches are learned, and controllers drive, pick up and place.
    skills = ",".join(f"{skill}=learned" for skill in ("open door", "close door", "turn on", "turn off"))
    for key, job in learned.items():
        assert job.options == replace(paper[key].options, skills=skills, perception_noise=0.0), key


def test_floors_are_played_in_every_suite_whoever_enters() -> None:
    for name in suites.names():
        assert suites.load(name).floors == FLOORS
    alone = suites.load("smoke").jobs([{"planner": "oracle"}])
    assert {job.agent["planner"] for job in alone} == {"oracle", *FLOORS}
    assert all(job.suite is not None and job.suite.given == {} for job in alone)
    entered = [job for job in suites.load("smoke").jobs([{"planner": "reader"}]) if job.method == "BASE"]
    assert len({job.key for job in entered}) == len(entered)


def test_the_full_suite_plays_every_cell_with_every_method_on_the_same_starts() -> None:
    from remac_env.tasks import get

    jobs = suites.load("full").jobs()
    cells = {(t, style, layout) for t in TASKS for style in get(t).styles for layout in get(t).layouts}
    starts = {(*cell, seed) for cell in cells for seed in (0, 1)}
    for method in ("BASE", "CC", "RE", "REMAC"):
        mine = [job for job in jobs if job.method == method and not job.agent]
        played = [(j.task, j.options.style, j.options.layout, j.seed) for j in mine]
        assert len(played) == len(starts)
        assert set(played) == starts


def test_the_held_out_suite_plays_what_the_table_leaves_out() -> None:
    from remac_env.kitchen import layout, style
    from remac_env.tasks import get

    jobs = suites.load("heldout").jobs()
    for task in TASKS:
        spec = get(task)
        played = {(j.options.style, j.options.layout) for j in jobs if j.task == task}
        looks, plans = {look for look, _ in played}, {plan for _, plan in played}
        assert plans == set(layout.names()) - set(spec.layouts) and plans
        assert looks == (set(style.names()) - set(spec.styles) or set(style.names()))
        assert len(played) == len(looks) * len(plans)


def test_held_out_starts_are_in_no_other_suite() -> None:
    held = {seed for block in suites.load("heldout").blocks for seed in block.seeds}
    others = [name for name in suites.names() if name != "heldout"]
    used = {seed for name in others for block in suites.load(name).blocks for seed in block.seeds}
    assert held and not held & used


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (('name = "mine"', ""), "mine.toml: name is missing; valid: name, version"),
        (("version = 1", 'version = "1"'), "mine.toml: version: '1' is not valid; valid: a whole number"),
        (('"CC"', '"CD"'), "jobs[0].methods: 'CD' does not exist; valid: BASE"),
        (("HeatOnStove", "BoilOnMoon"), "jobs[0].tasks: 'BoilOnMoon' does not exist; valid: OpenCabinetPnP"),
        (('"0:2"', '"x"'), "jobs[0].seeds: seeds 'x' are not valid"),
        (('"0:2"', '"900000"'), "jobs[0].seeds: seeds from 900000 on are kept"),
        (("symbolic", "real"), "jobs[0].kitchen: unknown backend 'real'; valid: physics, symbolic"),
        (("{ backend", "{ style = 'x', backend"), "jobs[0].kitchen.style: no such key; valid: backend"),
        (("retries = 1", "tries = 1"), "budget.tries: no such key; valid: max_calls"),
        (("seeds =", "seed ="), "jobs[0].seed: no such key; valid: tasks, seeds"),
        (('"0:2"', '"0:2"\ncells = "some"'), "jobs[0].cells: 'some' does not exist; valid: seed, all"),
        (("[[jobs]]", "[[jobs"), "cannot be read"),
    ],
)
def test_mistakes_name_file_key_and_valid_values(tmp_path: Path, change: tuple[str, str], told: str) -> None:
    with pytest.raises(UsageError) as caught:
        suites.load(written(tmp_path, TEXT.replace(*change)))
    assert told in str(caught.value)


def test_records_name_their_suite_and_a_changed_one_is_refused(tmp_path: Path) -> None:
    file, out = written(tmp_path), str(tmp_path / "out")
    assert remac("bench", "run", "--suite", file, "--out", out, "--jobs", "0").exit_code == 0
    before = (tmp_path / "out" / "records.jsonl").read_bytes()
    entries = read(tmp_path / "out")
    digest = suites.load(file).digest
    assert {(e.suite, e.suite_version, e.suite_digest) for e in entries} == {("mine", 1, digest)}
    assert {e.agent for e in entries} == {"BASE", "CC"}  # what the suite gives stands in no label
    assert remac("bench", "run", "--suite", file, "--out", out, "--jobs", "0").exit_code == 0

    for text in (TEXT.replace("0:2", "0:3"), TEXT.replace("retries = 1", "retries = 2")):
        changed = remac("bench", "run", "--suite", written(tmp_path, text), "--out", out, "--jobs", "0")
        assert changed.exit_code == 2
        assert "holds records of suite mine version 1" in changed.stderr
        assert "a suite is frozen" in changed.stderr
    plain = remac("bench", "run", "--tasks", "HeatOnStove", "--backend", "symbolic", "--out", out, "--jobs", "0")
    assert "not of no suite" in plain.stderr
    assert (tmp_path / "out" / "records.jsonl").read_bytes() == before
    words = "about = 'other words'\n"
    told = remac("bench", "run", "--suite", written(tmp_path, words + TEXT), "--out", out, "--jobs", "0")
    assert told.exit_code == 0, told.stderr


def test_a_folder_of_no_suite_takes_none(tmp_path: Path) -> None:
    run_jobs(suites.load("smoke").jobs()[:1], tmp_path, Settings(workers=0))
    (tmp_path / "suite.json").unlink()
    with pytest.raises(UsageError, match="holds records of no suite, not of suite smoke"):
        run_jobs(suites.load("smoke").jobs(), tmp_path, Settings(workers=0))


def test_an_entry_of_a_model_has_what_the_suite_lets_it_spend(tmp_path: Path) -> None:
    suite = suites.load(written(tmp_path, TEXT.replace("[budget]", '[roles]\nplanner = "noop"\n[budget]')))
    assert suite.given({}) == {"planner": "noop", "retries": 1}
    assert suite.given({"model": "openai:o3"}) == {"retries": 1, "max_calls": 7}
    assert suite.given({"planner": "openai:o3"}) == {"planner": "noop", "retries": 1, "max_calls": 7}


def test_the_backend_alone_can_be_another_one(tmp_path: Path) -> None:
    suite: Any = suites.load("mixed")
    keys = {job.key for job in suite.jobs()}
    assert not keys & {job.key for job in suite.jobs(backend="symbolic")}
    out = tmp_path / "out"
    result = remac("bench", "run", "--suite", "smoke", "--backend", "symbolic", "--out", str(out), "--jobs", "0")
    assert result.exit_code == 0, result.stderr
    assert json.loads((out / "suite.json").read_text())["suite"] == "smoke"


@pytest.mark.parametrize(
    ("budget", "job", "where"),
    [
        ("max_money = nan", "", "budget.max_money"), ("max_money = inf", "", "budget.max_money"),
        ("max_money = -1", "", "budget.max_money"), ("max_calls = true", "", "budget.max_calls"),
        ("retries = 1.5", "", "budget.retries"), ("max_rounds = -1", "", "budget.max_rounds"),
        ("", "iterations = -1", "jobs[0].iterations"), ("", "iterations = nan", "jobs[0].iterations"),
        ("", "robots = 0", "jobs[0].robots"), ("", "robots = true", "jobs[0].robots"),
        ("", "kitchen = { perception_noise = nan }", "jobs[0].kitchen.perception_noise"),
        ("", "kitchen = { failure_rate = inf }", "jobs[0].kitchen.failure_rate"),
        ("", "kitchen = { max_rounds = 0 }", "jobs[0].kitchen: max_rounds"),
    ],
)  # fmt: skip
def test_numbers_that_are_none_are_refused_with_their_place(budget: str, job: str, where: str, tmp_path: Path) -> None:
    head = 'name = "mine"\nversion = 1\nmethods = ["CC"]\n[budget]\n'
    path = written(tmp_path, f'{head}{budget}\n[[jobs]]\ntasks = ["HeatOnStove"]\nseeds = "0:2"\n{job}\n')
    with pytest.raises(UsageError, match="valid: ") as caught:
        suites.load(path)
    assert f"mine.toml: {where}" in str(caught.value)
