"""What of an agent's report stands in a record: exchanges cut to size, pictures beside it, no key and no folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from bench_helpers import jobs, read
from remac_bench.entries import TEXT_MAX, cut, save_pictures
from remac_bench.playing.runner import Settings, run_jobs
from remac_bench.redaction import redact
from test_bench_cli import remac

import remac_agents
from remac_agents.report import EpisodeReport, Exchange, Usage

HERE = Settings(workers=0)
PNG = b"\x89PNG\r\n\x1a\n a picture"


@pytest.fixture
def reports(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Changes to every EpisodeReport; by seed where the key is a number."""
    changes: dict[Any, Any] = {}
    whole = remac_agents.Agent.report

    def report(self: remac_agents.Agent) -> EpisodeReport:
        told = whole(self)
        return EpisodeReport(**{**vars(told), **changes})

    monkeypatch.setattr(remac_agents.Agent, "report", report)
    return changes


def test_exchanges_usage_and_pictures_are_recorded(tmp_path: Path, reports: dict[str, Any]) -> None:
    long = "a" * TEXT_MAX + "b" * TEXT_MAX
    asked = Exchange(3, "checker", "door", (("user", long),), "<b>yes</b>", "hm", None, 12, 0.5, 1.5, ("d1",))
    reports.update(usage=Usage(1, 10, 2, 0.5, 0, 1.5), exchanges=(asked,), pictures={"d1": PNG})
    run_jobs(jobs(seeds=range(1)), tmp_path, HERE)
    (entry,) = read(tmp_path)
    assert (entry.usage.calls, entry.usage.money, entry.usage.completion_tokens) == (1, 0.5, 2)
    (exchange,) = entry.exchanges
    assert (exchange.round, exchange.role, exchange.reply, exchange.pictures) == (3, "checker", "<b>yes</b>", ["d1"])
    ((role, text),) = exchange.messages
    assert role == "user"
    assert text.startswith("aaa") and text.endswith("bbb")
    assert f"{TEXT_MAX} characters left out" in text
    assert (tmp_path / "pictures" / "d1.png").read_bytes() == PNG
    assert sorted(path.name for path in (tmp_path / "pictures").iterdir()) == ["d1.png"]


def test_short_texts_stay_whole() -> None:
    assert cut("x" * TEXT_MAX) == "x" * TEXT_MAX


def test_a_picture_that_is_there_is_not_written_again(tmp_path: Path) -> None:
    save_pictures(tmp_path, {"d": PNG})
    save_pictures(tmp_path, {"d": b"other"})
    assert (tmp_path / "pictures" / "d.png").read_bytes() == PNG


def test_an_endpoint_that_was_down_is_no_failure_and_is_run_again(tmp_path: Path, reports: dict[str, Any]) -> None:
    reports["infrastructure"] = "planner: server_error: no"
    summary = run_jobs(jobs("RE", seeds=range(1)), tmp_path, HERE)
    (problem,) = summary.infrastructure
    assert "EndpointError: planner: server_error: no" in problem
    (entry,) = read(tmp_path)
    assert (entry.scored, entry.success, entry.infrastructure_error, entry.iteration) == (False, False, True, 0)
    reports.clear()
    assert run_jobs(jobs("RE", seeds=range(1)), tmp_path, HERE).played == 1
    assert [record.scored for record in read(tmp_path)] == [False, False, True]


def test_pictures_that_cannot_be_written_are_the_disks_fault(tmp_path: Path, reports: dict[str, Any]) -> None:
    reports["pictures"] = {"d": PNG}
    (tmp_path / "pictures").write_text("in the way")
    (problem,) = run_jobs(jobs(seeds=range(1)), tmp_path, HERE).infrastructure
    assert "FileExistsError" in problem
    assert str(tmp_path) not in (tmp_path / "records.jsonl").read_text()


SECRET = "q7RtZx91LmP0sVb3"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("cannot open /srv/someone/plans/plan.json: gone", "cannot open plan.json: gone"),
        ("'/home/me/my.py' and (/etc/x/y)", "'my.py' and (y)"),
        (f"in {Path.home()}/notes/a.txt", "in a.txt"),
        (f"sent {SECRET} to http://127.0.0.1:8000/v1/chat", "sent <LAB_TOKEN> to http://127.0.0.1:8000/v1/chat"),
        ("key sk-abcdefghijklmnopqrstuv refused", "key <key> refused"),
        ("Bearer abc123def456 refused", "Bearer <key> refused"),
        ("key A1b2C3d4E5f6G7h8I9j0K1l2M3n4O5p6 refused", "key <key> refused"),
        ("robot_0 and/or robot_1, 1/2 of open microwave door", "robot_0 and/or robot_1, 1/2 of open microwave door"),
        ("a_name_of_a_function_that_is_quite_long_indeed", "a_name_of_a_function_that_is_quite_long_indeed"),
        ("-" * 40 + " line", "-" * 40 + " line"),
    ],
)
def test_no_key_and_no_folder_of_this_machine(monkeypatch: pytest.MonkeyPatch, text: str, told: str) -> None:
    monkeypatch.setenv("LAB_TOKEN", SECRET)
    assert redact(text) == told


def test_models_flags_make_one_entry_each(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []
    monkeypatch.setattr("remac_bench.commands.running.run_and_report", lambda jobs, *_, **__: seen.extend(jobs))
    monkeypatch.setattr("remac_bench.playing.job_lists.make", lambda job, *shared: None)
    models = ("--model", "openai:o3", "--model", "deepseek:deepseek-reasoner")
    result = remac("bench", "run", "--suite", "smoke", *models, "--max-money", "2", "--checker", "truth")
    assert result.exit_code == 0, result.output
    seen = [job for job in seen if "model" in job.agent]  # the suite's floors are there too
    assert {job.agent["model"] for job in seen} == {"openai:o3", "deepseek:deepseek-reasoner"}
    assert {job.agent["max_money"] for job in seen} == {2.0}
    assert {job.agent["checker"] for job in seen} == {"truth"}  # given, so that it is not the model's
    assert len({job.key for job in seen}) == len(seen) == 2 * 16
