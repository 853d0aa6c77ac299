"""An endpoint that fails one time in four, a runner that is killed again and again: the table is that of the calm."""

from __future__ import annotations

import hashlib
import json
import random
import signal
import socket
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from bench_helpers import jobs as listed
from bench_helpers import read, start, timeless, wait_for
from remac_bench.playing.agents import Access
from remac_bench.playing.shared import Shared
from remac_bench.playing.worker import Work, play_job
from remac_bench.report import read_rows

sys.path.append(str(Path(__file__).parents[1] / "llm"))
from chaos_server import Act, Asked, ChaosServer, hangs, refuses, says, sends  # noqa: E402

NAIVE = "navigate to vegetable, pick up vegetable, navigate to microwave, place to microwave"
RIGHT = f"navigate to microwave, open microwave door, {NAIVE}"
FAULTS: tuple[Act, ...] = (
    refuses(500),
    refuses(503),
    refuses(429, "slow down", "retry-after: 0"),
    sends(b"<html>bad gateway</html>", status=502, kind="text/html"),
    sends(b'{"id": "x", "choi', length=400),
    lambda connection, _: connection.shutdown(socket.SHUT_RDWR),
)


def answer(connection: socket.socket, asked: Asked) -> None:
    """A plan that hangs on the question alone: the right one for half of the questions."""
    told = json.dumps(asked.body["messages"], sort_keys=True)
    right = hashlib.sha256(told.encode()).digest()[0] % 2
    says(f"Plan: [{RIGHT if right else NAIVE}]")(connection, asked)


class Faulty:
    """Answers, or fails one time in four."""

    def __init__(self) -> None:
        self.draw, self.answers, self.faults = random.Random(5), 0, 0

    def __call__(self, connection: socket.socket, asked: Asked) -> None:
        if self.draw.random() < 0.25:
            self.faults += 1
            self.draw.choice(FAULTS)(connection, asked)
        else:
            self.answers += 1
            answer(connection, asked)


def command(server: ChaosServer, out: Path, seeds: str) -> tuple[str, ...]:
    """Two methods with a language model as planner."""
    return (
        *("bench", "run", "--tasks", "OpenMicrowavePnP", "--methods", "BASE,CC", "--seeds", seeds),
        *("--backend", "symbolic", "--planner", "custom:m", "--base-url", server.url, "--jobs", "4"),
        *("--cassette", str(out / "cassette.jsonl"), "--out", str(out)),
    )


def lines(folder: Path) -> int:
    """How many lines the records have by now."""
    path = folder / "records.jsonl"
    return path.read_bytes().count(b"\n") if path.exists() else 0


def comparable(folder: Path) -> list[dict]:
    """The scored records without what hangs on time, on the endpoint's address and on how often was asked."""
    kept = timeless([record for record in read(folder) if record.scored])
    for record in kept:
        del record["usage"], record["options"], record["exchanges"]
    return kept


@pytest.mark.parametrize(
    ("seeds", "kills"), [("0:4", 1), pytest.param("0:100", 20, marks=pytest.mark.long)], ids=["short", "long"]
)
def test_the_table_is_that_of_the_calm_run(tmp_path: Path, seeds: str, kills: int) -> None:
    calm, stormy, faulty = tmp_path / "calm", tmp_path / "stormy", Faulty()
    with ChaosServer([answer]) as server:
        assert start(*command(server, calm, seeds)).wait(timeout=300) == 0
    jobs = 2 * int(seeds.partition(":")[2])
    with ChaosServer([faulty]) as server:
        arguments = command(server, stormy, seeds)
        for number in range(1, kills + 1):
            runner = start(*arguments)
            enough = number * jobs // (kills + 1)
            wait_for(lambda r=runner, n=enough: lines(stormy) >= n or r.poll() is not None)  # type: ignore[misc]
            assert runner.poll() is None, runner.communicate()
            runner.send_signal(signal.SIGKILL)
            runner.communicate()
        for _ in range(20):  # jobs that the endpoint kept from ending are run again
            runner = start(*arguments)
            _, told = runner.communicate(timeout=300)
            assert runner.returncode in (0, 1), told
            if runner.returncode == 0:
                break
            assert "infrastructure error, not scored" in told
    assert runner.returncode == 0
    assert faulty.faults > 0
    assert faulty.answers <= jobs + kills * 4  # what was answered is on the cassette; only what was under way is lost
    assert read_rows(stormy) == read_rows(calm)
    assert comparable(stormy) == comparable(calm)
    assert {record.usage.calls for record in read(calm)} == {1}
    assert all(record.exchanges[0].reply for record in read(stormy) if record.scored)


@pytest.mark.long
def test_a_model_in_every_role_but_the_checker_is_an_entry_of_a_suite_and_is_replayed(tmp_path: Path) -> None:
    cassette = str(tmp_path / "cassette.jsonl")
    with ChaosServer([answer]) as server:
        model = ("--model", "custom:m", "--base-url", server.url, "--checker", "truth", "--max-calls", "40")
        model += ("--cassette", cassette)
        arguments = ("bench", "run", "--suite", "smoke", "--no-preflight", *model)
        first = start(*arguments, "--out", str(tmp_path / "asked"))
        _, told = first.communicate(timeout=120)
        assert first.returncode == 0, told
        asked = len(server.asked)
    assert asked > 16
    again = start(*arguments, "--replay", "--out", str(tmp_path / "replayed"))
    _, told = again.communicate(timeout=120)
    assert again.returncode == 0, told
    assert read_rows(tmp_path / "replayed") == read_rows(tmp_path / "asked")
    assert comparable(tmp_path / "replayed") == comparable(tmp_path / "asked")
    records = read(tmp_path / "asked")
    assert {record.agent.partition(" ")[2] for record in records} >= {"(checker=truth, max_calls=40, model=custom:m)"}
    assert sum(record.usage.calls for record in records) == asked
    records = [record for record in records if "model=" in record.agent]  # the suite's floors are there too
    assert all(record.exchanges for record in records)
    assert all(record.options["access"]["cassette"] == "cassette.jsonl" for record in records)

    empty = start(*arguments[:-1], str(tmp_path / "empty.jsonl"), "--replay", "--out", str(tmp_path / "none"))
    _, told = empty.communicate(timeout=120)
    assert empty.returncode == 2
    assert "No such file" in told


def test_ctrl_c_does_not_wait_for_answers(tmp_path: Path) -> None:
    with ChaosServer([hangs(120)]) as server:
        runner = start(*command(server, tmp_path, "0:8"), "--no-preflight")  # which waits for its own answer
        wait_for(lambda: len(server.asked) >= 4 or runner.poll() is not None)
        runner.send_signal(signal.SIGINT)
        _, told = runner.communicate(timeout=60)
    assert runner.returncode == 130, told
    assert "stopped: 0 of 16 jobs are recorded; the same command resumes" in told
    assert "Traceback" not in told


def test_a_cassette_that_cannot_be_opened_is_not_the_agents_fault(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (job,) = listed(seeds=range(1))
    access = Access(base_url="http://127.0.0.1:9/v1", cassette=str(tmp_path / "folder"))
    job = replace(job, agent={"planner": "custom:m"}, access=access)
    (record,) = play_job(Work(job=job, folder=str(tmp_path)), Shared())
    assert record.infrastructure_error
    assert record.error is not None and str(tmp_path) not in record.error.message
