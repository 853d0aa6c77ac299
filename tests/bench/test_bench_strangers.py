"""Records of strangers: who reads, verifies or accepts them runs nothing that they name."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from remac_bench.errors import UsageError
from remac_bench.playing import suites
from remac_bench.playing.agents import Access
from remac_bench.playing.job_lists import make_jobs
from remac_bench.playing.runner import Settings, run_jobs
from remac_bench.proof.acceptance import accept
from remac_bench.proof.submission import pack
from remac_bench.proof.verify import verify
from test_bench_cli import remac
from test_bench_forgeries import NAIVE, ChaosServer, Lines, _rekey, _repacked, forged, says

SUITE = """
name = "tiny"
version = 1
about = "One start."
methods = ["BASE", "CC"]
[[jobs]]
tasks = ["OpenCabinetPnP"]
seeds = "3"
kitchen = { backend = "symbolic" }
"""
EVIL = """
from pathlib import Path
from remac_agents.planners.literal import LiteralPlanner as Planner
Path(__file__).with_name("ran").touch()
"""
OWN = """
version = 1
[providers.kiosk]
title = "Kiosk"
base_url = "{url}"
key = "KIOSK_KEY"
key_required = false
any_model = true
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, Path]]:
    """A run of a suite by a model of a provider of one's own, and the file of that provider."""
    files, folder = tmp_path_factory.mktemp("suites"), tmp_path_factory.mktemp("run")
    (files / "tiny.toml").write_text(SUITE)
    patch = pytest.MonkeyPatch()
    patch.setattr(suites, "_folder", lambda: files)
    patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
    with ChaosServer([says(f"Plan: [{NAIVE}]")]) as server:
        providers = files.parent / "own.toml"
        providers.write_text(OWN.format(url=server.url))
        access = Access(providers=str(providers), cassette=str(folder / "cassette.jsonl"))
        jobs = suites.load("tiny").jobs([{"planner": "kiosk:m"}], access=access)
        run_jobs(jobs, folder, Settings(workers=0, preflight=False))
        yield folder, providers
    patch.undo()


def planned_by(who: str) -> object:
    def change(lines: Lines) -> None:
        for record in lines:
            record["options"]["agent"]["planner"], record["isolated"] = who, True
            record["agent"] = record["agent"].replace("kiosk:m", who)
        _rekey(lines)

    return change


@pytest.mark.parametrize("who", ["{}/evil.py:Planner", "evil.py:Planner", "pddl:touch {}/ran", "answers:/dev/zero"])
def test_nothing_that_records_name_is_run(
    who: str, run: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, replays: None
) -> None:
    (tmp_path / "evil.py").write_text(EVIL)
    monkeypatch.chdir(tmp_path)
    change = planned_by(who.format(tmp_path))
    verdict = verify(forged(run[0], tmp_path / "copy", change))  # type: ignore[arg-type]
    assert verdict.replayed == 2, "only the subtasks can be played again"
    out = tmp_path / "packed"
    pack(run[0], out, name="Crew", kind="custom", providers=run[1])
    _repacked(out, change)  # type: ignore[arg-type]
    (reason,) = accept(out).reasons
    assert who.format(tmp_path) in reason and "cannot be asked again" in reason
    assert not (tmp_path / "ran").exists()


@pytest.mark.long
def test_the_evil_planner_does_run_where_it_is_given(tmp_path: Path) -> None:
    (tmp_path / "evil.py").write_text(EVIL)
    agent = {"planner": f"{tmp_path}/evil.py:Planner"}
    make_jobs(tasks=["OpenCabinetPnP"], methods=["BASE"], seeds=[3], kitchen={}, agent=agent)
    assert (tmp_path / "ran").exists()


def test_who_cannot_be_asked_again_is_told_before_anything_is_packed(run: tuple[Path, Path], tmp_path: Path) -> None:
    folder = forged(run[0], tmp_path / "run", planned_by("mine.py:Planner"))  # type: ignore[arg-type]
    result = remac("bench", "submit", str(folder), "--out", str(tmp_path / "out"), "--name", "Crew")
    assert result.exit_code == 2 and "planner=mine.py:Planner" in result.output and not (tmp_path / "out").exists()


def test_a_run_by_a_provider_of_ones_own_is_accepted(run: tuple[Path, Path], tmp_path: Path) -> None:
    pack(run[0], tmp_path / "out", name="Crew", kind="custom", providers=run[1])
    assert accept(tmp_path / "out").reasons == ()
    pack(run[0], tmp_path / "standard", name="Crew", providers=run[1])
    assert accept(tmp_path / "standard").reasons == (
        "kind: standard, and providers are of the entrant's own making; valid: custom",
    )


def test_providers_that_others_know_stay_as_they_are(run: tuple[Path, Path], tmp_path: Path) -> None:
    cheap = tmp_path / "cheap.toml"
    for more in ("[providers.openai]\nimages = false", "[providers.openai.models.o3]\nprice_in = 0.0\nprice_out = 0.0"):
        cheap.write_text(f"{run[1].read_text()}\n{more}\n")
        with pytest.raises(UsageError, match="changes openai, which others know"):
            pack(run[0], tmp_path / "out", name="Crew", kind="custom", providers=cheap)


@pytest.mark.parametrize("text", ["answers:/dev/zero", "policy:/dev/zero"])
def test_a_file_without_end_is_one_line(text: str, tmp_path: Path) -> None:
    words = ("--tasks", "OpenCabinetPnP", "--methods", "BASE", "--seeds", "3", "--out", str(tmp_path / "out"))
    result = remac("bench", "run", *words, "--planner", text)
    assert result.exit_code == 2 and "more than" in result.output and "Traceback" not in result.output


def test_a_cassette_that_is_no_file_is_refused(tmp_path: Path) -> None:
    words = ("--tasks", "OpenCabinetPnP", "--methods", "BASE", "--seeds", "3", "--out", str(tmp_path / "out"))
    result = remac("bench", "run", *words, "--model", "custom:m", "--base-url", "http://127.0.0.1:9/v1",
                   "--cassette", "/dev/zero")
    assert result.exit_code == 2 and "it is no file" in result.output


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--suite", "tiny", "--planner", "{}/evil.py:Planner"), "evil.py:Planner"),
        (("--suite", "tiny", "--planner", "custom:m", "--base-url", "http://127.0.0.1:9/v1"), "give --cassette"),
        (("--suite", "tiny"), ""),
    ],
)
def test_a_run_that_nobody_can_accept_is_told_before_it_is_paid_for(
    words: tuple[str, ...], told: str, run: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "evil.py").write_text(EVIL)
    (tmp_path / "tiny.toml").write_text(SUITE)
    monkeypatch.setattr("remac_bench.commands.running.run_and_report", lambda *given: None)
    result = remac("bench", "run", *(word.format(tmp_path) for word in words), "--out", str(tmp_path / "out"))
    assert result.exit_code == 0 and told in result.output and ("note:" in result.output) == bool(told)


def test_a_suite_of_ones_own_is_proven_against_its_file(
    run: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, replays: None
) -> None:
    pack(run[0], tmp_path / "out", name="Crew", kind="custom", providers=run[1])
    monkeypatch.setattr(suites, "_folder", lambda: tmp_path / "none")  # here, none comes along
    monkeypatch.setattr(suites, "_ADDED", {})
    (tmp_path / "tiny.toml").write_text(SUITE)
    (tmp_path / "other.toml").write_text(SUITE.replace('seeds = "3"', 'seeds = "3:5"'))
    words = ("bench", "accept", str(tmp_path / "out"))
    result = remac(*words)
    assert result.exit_code == 1 and "is not here" in result.output and "--suite FILE.toml" in result.output
    result = remac(*words, "--suite", str(tmp_path / "other.toml"))
    assert result.exit_code == 1 and "is not the one here" in result.output
    result = remac(*words, "--suite", str(tmp_path / "tiny.toml"))
    assert result.exit_code == 0 and "accepted: Crew" in result.output
    shown = remac("bench", "board", str(tmp_path / "out"), "--out", str(tmp_path / "b"), "--suite",
                  str(tmp_path / "tiny.toml"))  # fmt: skip
    assert shown.exit_code == 0, shown.output


def test_no_suite_of_ones_own_takes_the_name_of_one_that_comes_along(run: tuple[Path, Path], tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(SUITE)
    result = remac("bench", "verify", str(run[0]), "--suite", str(tmp_path / "mine.toml"))
    assert result.exit_code == 2 and "is taken" in result.output and not suites._ADDED
