"""Planted failures get the label of what was planted."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from bench_helpers import record
from planted_failures import KINDS, failures, planted, planted_in_physics
from remac_bench.blame import replay
from remac_bench.blame.labels import Blame, blame, blame_all
from remac_bench.blame.replay import play_again, rescue
from remac_bench.blame.sheet import blame_sheets, read_blames, write_blames
from remac_bench.cli import app
from remac_bench.errors import RecordFileError
from remac_bench.judging import board
from remac_bench.records import ErrorEntry, OutcomeEntry, Record
from remac_bench.store import Store
from typer.testing import CliRunner

from remac_env.oracle import Certificate

RIGHT = 0.95
"""The share of planted failures that has to be labelled right."""


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("seeds", "enough"), [(1, 5), pytest.param(8, 40, marks=pytest.mark.long)])
def test_planted_failures_are_labelled_right(kind: str, seeds: int, enough: int) -> None:
    records = planted(kind, range(seeds))
    labels = Counter(blame(failed, rescuing=False).label for failed in records)
    assert len(records) >= enough
    assert labels[kind] >= RIGHT * len(records), labels


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_planted_failures_in_physics_are_labelled_right(kind: str) -> None:
    found = planted_in_physics(kind, range(2))
    assert len(found) >= 2
    assert {blame(failed, rescuing=False).label for failed in found} == {kind}


def first_failure(**options: object) -> Record:
    (failed,) = failures("BASE", range(1), tasks=("OpenCabinetPnP",), **options)  # type: ignore[arg-type]
    return failed


def test_the_round_that_shows_it() -> None:
    """Literally: go, take, go to the cabinet, and place into it: the fourth round meets a closed door."""
    failed = first_failure()
    found = blame(failed)
    assert (found.label, found.round, found.robot, found.subtask) == ("planner", 3, "robot_0", "place to cabinet")
    assert "door_closed" in found.what
    assert found.rescued is True
    assert rescue(failed, 0)
    few = {**failed.options, "kitchen": {**failed.options["kitchen"], "max_rounds": 8}}
    assert not rescue(failed.model_copy(update={"options": few}), 4)


def test_a_failed_skill_is_shown_where_it_failed() -> None:
    failed = failures("BASE", range(5), kitchen={"failure_rate": 0.2}, planner="oracle")
    assert len(failed) >= 5
    for episode in failed:
        found = blame(episode, rescuing=False)
        at = episode.outcomes[found.round][found.robot]
        assert (found.label, at.status, at.reason) == ("skill", "failure", "slipped")


def test_blame_that_hangs_on_an_optimum_nobody_knows_is_unclear(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the search gives up, neither the rounds nor the planner are to blame."""
    failed = first_failure(planner="noop")
    assert blame(failed, rescuing=False).label == "planner"
    unknown = Certificate(plan=None, lower=3, proof="bounds")
    monkeypatch.setattr(replay, "certify", lambda *given, **options: unknown)
    found = blame(failed, rescuing=False)
    assert found.label == "unclear" and "gave up" in found.what


def test_records_that_were_tampered_with_cannot_be_blamed() -> None:
    """Whoever changes what is recorded is found out: played again, the episode goes another way."""
    failed = first_failure()
    rounds = [dict(turn) for turn in failed.outcomes]
    rounds[1] = {"robot_0": OutcomeEntry(subtask="pick up vegetable", status="failure", reason="slipped")}
    assert blame(failed.model_copy(update={"outcomes": rounds})).label == "unclear"
    assert blame(failed.model_copy(update={"digest": "0" * 12})).label == "unclear"
    rounds[1] = {"robot_0": OutcomeEntry(subtask="pick up elephant", status="success")}
    assert blame(failed.model_copy(update={"outcomes": rounds})).label == "unclear"
    plan = {"robot_0": ["pick up elephant", "fly"], "robot_7": ["wait"]}
    assert blame(failed.model_copy(update={"initial_plan": plan, "final_plan": plan})).label == "planner"
    assert not play_again(failed.model_copy(update={"seed": 1})).faithful
    assert play_again(failed).faithful


def test_crashes_and_tokens_that_name_nothing() -> None:
    crashed = record(success=False, error=ErrorEntry(kind="agent", type="KeyError", message="no"))
    assert (blame(crashed).label, blame(crashed).what) == ("crash", "KeyError: no")
    failed = first_failure()
    lost = {"robot_0": OutcomeEntry(subtask="token 99999", status="failure", reason="invalid")}
    done = {"robot_0": OutcomeEntry(subtask="done", status="success")}
    strange = failed.model_copy(update={"outcomes": [lost, done], "initial_plan": {}, "final_plan": {}})
    found = blame(strange, rescuing=False)
    assert (found.label, found.round, found.what) == ("planner", 0, "names nothing in this kitchen")


def test_an_empty_plan_is_the_planners() -> None:
    failed = first_failure(planner="noop")
    found = blame(failed)
    assert found.label == "planner"
    assert found.rescued is True


def test_labels_are_kept_beside_the_records(tmp_path: Path) -> None:
    records = failures("BASE", range(2), tasks=("HeatOnStove",))
    blames = list(blame_all([*records, *records, record(job="won")]))
    assert len(blames) == 2
    assert read_blames(tmp_path) == []
    write_blames(tmp_path, blames)
    assert read_blames(tmp_path) == blames
    assert [s.key for s in board(records, blames=blames).sheets][-1] == "blame"
    (sheet,) = blame_sheets(blames, folder="x")
    assert {key: sheet.rows[0][key].text for key in ("failed", "planner", "skill")} == {
        "failed": "2",
        "planner": "2",
        "skill": "0",
    }
    (tmp_path / "blame.jsonl").write_text("{}\n", "utf-8")
    with pytest.raises(RecordFileError, match="remac bench blame"):
        read_blames(tmp_path)


def test_the_command(tmp_path: Path) -> None:
    Store(tmp_path).append(failures("BASE", range(2), tasks=("HeatOnStove",)))
    result = CliRunner().invoke(app, ["bench", "blame", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert "Why episodes failed" in result.stdout
    assert "2 failed episodes" in result.stderr
    assert {label.label for label in read_blames(tmp_path)} == {"planner"}
    assert "Why episodes failed" in CliRunner().invoke(app, ["bench", "report", str(tmp_path)]).stdout
    markdown = CliRunner().invoke(app, ["bench", "blame", str(tmp_path), "--markdown", "--no-rescue"]).stdout
    assert "| BASE | HeatOnStove | 2 |" in markdown
    assert all(isinstance(label, Blame) and label.rescued is None for label in read_blames(tmp_path))
