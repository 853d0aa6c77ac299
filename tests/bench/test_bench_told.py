"""What playing again cannot prove has at least to be what a run could have written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from remac_bench.errors import RecordFileError
from remac_bench.playing.jobs import Job
from remac_bench.playing.worker import Work, play_job
from remac_bench.proof.rounds import check_rounds
from remac_bench.proof.told import check_lines, check_told
from remac_bench.proof.verify import strange_versions, verify
from remac_bench.records import Record
from remac_bench.store import FILE, Store

from remac_env.options import Options


@pytest.fixture(scope="module")
def honest() -> list[Record]:
    """A job of two iterations, of which it was asked what is shortest."""
    job = Job(method="RE", task="OpenCabinetPnP", seed=3, options=Options(backend="symbolic"), iterations=1)
    return play_job(Work(job=job, folder="", video="none", optimum=True))


def changed(records: list[Record], path: str, value: Any) -> list[Record]:
    """The records with one field of the last otherwise; `path`: names with dots between them."""
    values = records[-1].model_dump(by_alias=True)
    *parents, name = path.split(".")
    place = values
    for parent in parents:
        place = place[parent]
    place[name] = value
    return [*records[:-1], Record.model_validate(values)]


def test_an_honest_run_tells_nothing_odd(honest: list[Record], tmp_path: Path) -> None:
    Store(tmp_path).append(honest)
    assert not list(check_told(honest)) and not list(check_lines(tmp_path)) and strange_versions(honest) == ()


@pytest.mark.parametrize(
    ("path", "value", "told"),
    [
        ("wall_seconds", -1.0, "wall_seconds: -1.0 s"),
        ("wall_seconds", 1e308, "wall_seconds"),
        ("usage.seconds", -0.5, "usage.seconds: -0.5 s"),
        ("usage.requests", 7, "usage.requests: recorded 7, again 0"),
        ("usage.requests", -1, "usage.requests: -1"),
        ("started", "yesterday", "'yesterday' is no time"),
        ("started", "2026-11-30T10:00:00", "is no time"),
        ("started", "2999-11-30T10:00:00+00:00", "is no time"),
        ("machine", "\x1b[31mred", "machine"),
        ("schema", 0, "schema: 0; valid: 1 to 1"),
        ("video", {"path": "../../etc/passwd"}, "video.path"),
        ("video", {"path": "videos/a.webm", "rounds": [-1.0]}, "video.rounds: -1.0 s"),
        ("video", {"path": "videos/a.webm", "rounds": [0.0] * 99}, "video.rounds: 99 of"),
        ("options.job_seconds", float("nan"), "job_seconds nan is not valid"),
        ("options.iterations", 10**9, "iterations 1000000000 is not valid; valid: whole numbers 0..1000"),
        ("options.iterations", True, "iterations True is not valid"),
        ("options.access", {"isolated": "yes"}, "access.isolated 'yes' is not valid"),
        ("options.kitchen.starts", "mixed", "starts: recorded paper, again mixed"),
        ("options.agent.max_money", float("nan"), "its options make no job"),
        ("iteration", 5, "its job has iterations 0 to 1"),
        ("agent", "RE (planner=oracle)", "agent: recorded"),
    ],
)
def test_what_no_run_writes_is_found(honest: list[Record], path: str, value: Any, told: str) -> None:
    found = [line for _, line in check_told(changed(honest, path, value))]
    assert any(told in line for line in found), found


def test_versions_that_are_left_out_are_strange(honest: list[Record]) -> None:
    (row,) = changed(honest[-1:], "versions", {"remac": honest[-1].versions["remac"]})
    assert any(told.startswith("code unknown (here ") for told in strange_versions([row]))


@pytest.mark.parametrize(
    ("forge", "told"),
    [
        (lambda line: line.replace('"success":', '"success":true,"success":', 1), "'success' stands there twice"),
        (lambda line: line.replace('"wall_seconds":', '"wall_seconds":NaN,"more":', 1), "NaN is no number"),
        (lambda line: line.replace('"job":', '"tsr":1.0,"job":', 1), "no record has 'tsr'"),
    ],
)
def test_lines_that_two_readers_read_differently_are_found(
    honest: list[Record], tmp_path: Path, forge: Callable[[str], str], told: str
) -> None:
    (tmp_path / FILE).write_text("".join(forge(record.line()) + "\n" for record in honest))
    assert any(told in line for _, line in check_lines(tmp_path))


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_numbers_that_are_none_are_no_records(honest: list[Record], tmp_path: Path, number: str) -> None:
    line = honest[-1].line().replace('"sim_seconds":', f'"sim_seconds":{number},"more":', 1)
    (tmp_path / FILE).write_text(line + "\n")
    with pytest.raises(RecordFileError, match="line 1: no record"):
        Store(tmp_path).read()


def test_bytes_behind_the_last_line_are_found(honest: list[Record], tmp_path: Path) -> None:
    Store(tmp_path).append(honest)
    with (tmp_path / FILE).open("ab") as file:
        file.write(b'{"job": "x')
    assert verify(tmp_path).findings


def test_what_is_shortest_is_told_of_all_jobs_or_of_none(honest: list[Record], tmp_path: Path) -> None:
    """Leaving out where one was far from it would raise the mean of the others."""
    job = Job(method="BASE", task="OpenCabinetPnP", seed=3, options=Options(backend="symbolic"))
    Store(tmp_path).append([*honest, *play_job(Work(job=job, folder="", video="none"))])
    assert any("optimum_rounds: recorded None" in finding.told for finding in verify(tmp_path).findings)


def test_an_episode_that_never_began_has_nothing_to_tell(honest: list[Record]) -> None:
    error = {"kind": "agent", "type": "JobTimeoutError", "message": "", "where": []}
    nothing = changed(changed(honest, "digest", None), "error", error)
    assert any(", rounds: recorded" in told for told in check_rounds(nothing))
    assert any("success" in told for told in check_rounds(nothing))
    assert any("never began" in told for told in check_rounds(changed(honest, "digest", None)))


def test_iterations_that_are_left_out_are_found(honest: list[Record]) -> None:
    """Where who chose the subtasks cannot be asked again: what they took counts, too."""
    assert not list(check_rounds(honest))
    assert any("iterations: recorded [1]" in told for told in check_rounds(honest[1:]))


def test_pictures_for_nobody_are_no_reason_for_another_setting(honest: list[Record], tmp_path: Path) -> None:
    forged = [row.model_copy(update={"options": row.options | {"viewers": ["checker"]}}) for row in honest]
    Store(tmp_path).append(forged)
    assert any("viewers: recorded ['checker'], again []" in finding.told for finding in verify(tmp_path).findings)
