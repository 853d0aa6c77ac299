"""Endpoints with every manner under `remac bench run`: no job is lost or blamed for what our own requests were."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import read
from chaos_server import DONE, USAGE, Act, ChaosServer, chunk, hangs, refuses, says, streams
from endpoints import BOUNDS, CONTEXT, FULL, REFUSALS, Picky
from remac_bench.cli import app
from remac_bench.records import Record, UsageEntry
from typer.testing import CliRunner

RIGHT = "navigate to microwave, open microwave door, navigate to vegetable, pick up vegetable, navigate to microwave, "
PLAN = f"Plan: [{RIGHT}place to microwave]"
WRONG = "Plan: [navigate to vegetable]"


@pytest.fixture
def server() -> Iterator[ChaosServer]:
    with ChaosServer([says(PLAN)]) as server:
        yield server


def play(server: ChaosServer, folder: Path, options: str = "", *more: str, seeds: str = "0:1") -> list[Record]:
    flags = ("--tasks", "OpenMicrowavePnP", "--methods", "BASE", "--seeds", seeds, "--backend", "symbolic")
    reach = ("--out", str(folder), "--base-url", server.url, "--no-preflight", "--jobs", "0")
    result = CliRunner().invoke(app, ["bench", "run", *flags, *reach, "--model", f"vllm:m{options}", *more])
    records = read(folder)
    assert result.exit_code == int(any(record.infrastructure_error for record in records)), result.output
    return records


def test_the_plan_is_right_and_another_one_is_not(server: ChaosServer, tmp_path: Path) -> None:
    (record,) = play(server, tmp_path / "right")
    assert record.success and record.usage.requests == record.usage.calls == 1 and record.adaptations == []
    server.plays(says(WRONG))
    (record,) = play(server, tmp_path / "wrong")
    assert record.scored and not record.success


@pytest.mark.parametrize("words", REFUSALS)
def test_refused_fields_cost_no_job(words: str, server: ChaosServer, tmp_path: Path) -> None:
    fields = ("max_tokens", "temperature", "stream_options")
    server.plays(Picky(words, fields, answer=says(PLAN)).act)
    first, second = play(server, tmp_path, seeds="0:2")
    assert first.success and second.success
    assert (first.usage.calls, first.usage.requests) == (1, 4)
    assert (second.usage.calls, second.usage.requests) == (1, 1), "learnt once for the run"
    notes = ["max_tokens -> max_completion_tokens", "temperature left out", "stream_options left out"]
    assert sorted(first.adaptations) == sorted(second.adaptations) == sorted(notes)
    assert first.exchanges[0].requests == 4 and sorted(first.exchanges[0].adaptations) == sorted(notes)


@pytest.mark.parametrize("words", [*FULL, *BOUNDS])
def test_a_small_context_costs_no_score(words: str, server: ChaosServer, tmp_path: Path) -> None:
    kind = {"full": words} if words in FULL else {"longest": words}
    server.plays(Picky(**kind, answer=says(PLAN)).act)  # type: ignore[arg-type]
    (record,) = play(server, tmp_path)
    assert record.success and (words == "llama.cpp" or record.adaptations[0].startswith("max_tokens 8192 -> "))
    server.plays(Picky(full=words if words in FULL else "vLLM", prompt=CONTEXT + 1).act)
    (record,) = play(server, tmp_path / "no room")
    assert record.infrastructure_error and not record.scored
    assert record.error is not None and "option context" in record.error.message


ROOMLESS = [
    refuses(400, "This model's maximum context length is 10 tokens", code="context_length_exceeded"),
    refuses(413, "too large"),
    refuses(400, "I refuse"),
    refuses(422, "temperature"),
    refuses(400, "max_tokens"),
]


@pytest.mark.parametrize("act", ROOMLESS)
def test_no_refusal_is_ever_a_score(act: Act, server: ChaosServer, tmp_path: Path) -> None:
    server.plays(act)
    (record,) = play(server, tmp_path)
    assert record.infrastructure_error and not record.scored
    assert record.error is not None and "option" in record.error.message
    assert record.usage.requests == len(server.asked)


@pytest.mark.parametrize(
    "answer",
    [
        says(f"[THINK]{WRONG}[/THINK]{PLAN}"),
        says(f"analysis{WRONG}assistantfinal{PLAN}"),
        says(f"<|channel|>analysis<|message|>{WRONG}<|end|><|start|>assistant<|channel|>final<|message|>{PLAN}<|return|>"),
        says(PLAN, finish="eos"),
        says(PLAN, finish="eos_token"),
        streams(chunk(PLAN), chunk("", finish=None), DONE),
        streams(b"\xef\xbb\xbf" + chunk(PLAN), chunk("", finish="stop"), USAGE, DONE),
        says("\ufeff" + PLAN),
    ],
)
def test_answers_in_other_forms_are_read(answer: Act, server: ChaosServer, tmp_path: Path) -> None:
    server.plays(answer)
    (record,) = play(server, tmp_path)
    assert record.success, record.planner_errors


def test_silence_until_the_deadline_is_one_request_that_nobody_knows_the_price_of(
    server: ChaosServer, tmp_path: Path
) -> None:
    server.plays(hangs())
    (record,) = play(server, tmp_path, ",seconds=0.3,price_in=1,price_out=1")
    assert record.infrastructure_error and not record.scored
    assert (record.usage.calls, record.usage.requests, record.usage.unpriced) == (1, 1, 1)
    assert len(server.asked) == 1


def test_failed_requests_are_booked(server: ChaosServer, tmp_path: Path) -> None:
    server.plays(says("", usage={"prompt_tokens": 100, "completion_tokens": 50}), refuses(500), says(PLAN))
    (record,) = play(server, tmp_path, ",price_in=1000,price_out=1000")
    assert record.success
    usage = record.usage
    assert (usage.calls, usage.requests, usage.prompt_tokens, usage.completion_tokens) == (1, 3, 110, 55)
    assert usage.money == pytest.approx(0.165) and usage.unpriced == 0


def test_options_make_rows_of_their_own(server: ChaosServer, tmp_path: Path) -> None:
    records = play(server, tmp_path, ",max_tokens=1024", "--model", "vllm:m,max_tokens=2048,extra.top_k=5")
    assert [record.agent for record in records] == [
        "BASE (model=vllm:m,max_tokens=1024)",
        "BASE (model=vllm:m,extra.top_k=5,max_tokens=2048)",
    ]
    assert [asked.body["model"] for asked in server.asked] == ["m", "m"]
    assert sorted(asked.body["max_tokens"] for asked in server.asked) == [1024, 2048]


def test_records_of_before_are_read() -> None:
    old: dict[str, Any] = {"calls": 2, "prompt_tokens": 3, "completion_tokens": 4, "money": 0.5, "unpriced": 1}
    assert UsageEntry(**old).requests == 0
    assert Record.model_fields["adaptations"].get_default(call_default_factory=True) == []


def test_a_replay_gives_the_record_again(server: ChaosServer, tmp_path: Path) -> None:
    server.plays(Picky("OpenAI", ("max_tokens", "seed"), full="OpenAI", answer=says(PLAN)).act)
    tape = ("--cassette", str(tmp_path / "tape.jsonl"))
    (told,) = play(server, tmp_path / "one", ",seed=3", *tape)
    asked = len(server.asked)
    (again,) = play(server, tmp_path / "two", ",seed=3", *tape, "--replay")
    assert len(server.asked) == asked == told.usage.requests > 1
    apart = {"wall_seconds", "started", "options", "usage", "exchanges"}
    assert told.model_dump(exclude=apart) == again.model_dump(exclude=apart)
    same = {"seconds": 0.0}
    assert told.usage.model_copy(update=same) == again.usage.model_copy(update=same)
    assert [e.model_copy(update=same) for e in told.exchanges] == [e.model_copy(update=same) for e in again.exchanges]
