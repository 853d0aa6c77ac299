"""Re-execution: what was recorded comes out again, and what was tampered with is found."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import jobs, read
from remac_bench.playing.runner import Settings, run_jobs
from remac_bench.playing.worlds import as_values, from_values
from remac_bench.proof.again import read_job
from remac_bench.proof.verify import verify
from test_bench_cli import remac

import remac_env

Tamper = Callable[[dict[str, Any]], None]


@pytest.fixture(scope="module", params=["literal", "bench_planners:Slow"])
def honest(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Records of an offline agent, and of one whose planner is not our own."""
    folder = tmp_path_factory.mktemp("honest")
    listed = jobs("CC,REMAC", seeds=range(2), planner=request.param)
    run_jobs(listed, folder, Settings(workers=0))
    return folder


def tampered(folder: Path, change: Tamper, copy: Path) -> Path:
    """A copy of the records with the last one changed."""
    lines = (folder / "records.jsonl").read_text().splitlines()
    record = json.loads(lines[-1])
    change(record)
    (copy / "records.jsonl").write_text("\n".join([*lines[:-1], json.dumps(record)]) + "\n")
    return copy


def test_worlds_stand_in_the_records_at_the_start_and_after_each_round(honest: Path) -> None:
    for record in read(honest):
        assert len(record.worlds) == record.rounds + 1
        env = remac_env.parallel_env(record.task, robots=record.robots, backend="symbolic")
        env.reset(seed=record.seed)
        assert from_values(record.worlds[0]) == env.world
        assert [as_values(from_values(values)) for values in record.worlds] == record.worlds
        assert set(record.worlds[0]) == {"robots", "objects", "fixtures"}


def test_a_job_is_read_back_from_its_record(honest: Path) -> None:
    assert all(read_job(record).key == record.job for record in read(honest))


def test_honest_records_come_out_again(honest: Path) -> None:
    verdict = verify(honest)
    assert (verdict.findings, verdict.jobs, verdict.records) == ((), 4, 8)
    assert verdict.replayed == (0 if "literal" in read(honest)[0].options["agent"].get("planner", "literal") else 4)
    assert verify(honest, sample=2).jobs == 2
    result = remac("bench", "verify", str(honest), "--sample", "1")
    assert result.exit_code == 0, result.output
    assert "all as recorded" in " ".join(result.stdout.split())


def test_records_from_before_outcomes_told_their_times_come_out_again(honest: Path, tmp_path: Path) -> None:
    def forget(record: dict[str, Any]) -> None:
        for outcome in (outcome for turn in record["outcomes"] for outcome in turn.values()):
            del outcome["began"], outcome["ended"]
        record["versions"]["code"] = "0" * 12  # that of today tells them

    assert verify(tampered(honest, forget, tmp_path)).findings == ()


def _flip(record: dict[str, Any]) -> None:
    record["success"] = not record["success"]


def _outcome(record: dict[str, Any]) -> None:
    record["outcomes"][2]["robot_0"]["status"] = "failure"


def _began(record: dict[str, Any]) -> None:
    record["outcomes"][2]["robot_0"]["began"] += 1.0


def _world(record: dict[str, Any]) -> None:
    record["worlds"][-1]["robots"]["robot_0"]["holding"] = "moon"


def _digest(record: dict[str, Any]) -> None:
    record["digest"] = "0" * 12


def _seed(record: dict[str, Any]) -> None:
    record["seed"] = 77


def _rounds(record: dict[str, Any]) -> None:
    record["outcomes"].append(record["outcomes"][-1])


def _options(record: dict[str, Any]) -> None:
    record["options"]["kitchen"]["max_rounds"] = 99


@pytest.mark.parametrize("change", [_flip, _outcome, _began, _world, _digest, _seed, _rounds, _options])
def test_tampered_records_are_found(honest: Path, tmp_path: Path, change: Tamper, replays: None) -> None:
    verdict = verify(tampered(honest, change, tmp_path))
    assert {finding.job for finding in verdict.findings} == {read(honest)[-1].job}
    result = remac("bench", "verify", str(tmp_path))
    assert result.exit_code == 1
    assert "1 contradicted" in " ".join(result.stdout.split())


def test_a_plan_that_an_offline_agent_never_made_is_found(tmp_path: Path) -> None:
    run_jobs(jobs("CC", seeds=range(1)), tmp_path, Settings(workers=0))

    def change(record: dict[str, Any]) -> None:
        record["initial_plan_length"] = 1

    (finding,) = verify(tampered(tmp_path, change, tmp_path)).findings
    assert finding.told == "iteration 0, initial_plan_length: recorded 1, again 5"
