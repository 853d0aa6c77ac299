"""`remac plan` and `remac experiment` with endpoints that fail, planners that fail, and runs that are broken off."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from chaos_server import Act, Asked, ChaosServer, refuses, says
from remac_bench.experiments.book import Book
from test_bench_cli import remac

RIGHT = "navigate to microwave, open microwave door, navigate to vegetable, pick up vegetable, navigate to microwave, "
PLAN = says(f"Plan: [{RIGHT}place to microwave]")
TASK = "OpenMicrowavePnP"
TASKS = ("--tasks", TASK)


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[ChaosServer]:
    monkeypatch.setenv("CUSTOM_API_KEY", "sk-test")
    with ChaosServer([PLAN]) as running:
        yield running


def ask(server: ChaosServer, *more: str) -> Any:
    """`remac plan` of a model on this server."""
    return remac("plan", "--task", TASK, "--planner", "custom:m", "--base-url", server.url, "--no-preflight", *more)


def experiment(server: ChaosServer, *more: str, count: int = 6) -> Any:
    """`remac experiment validity` of a model on this server."""
    model = ("--planner", "custom:m", "--base-url", server.url, "--no-preflight")
    return remac("experiment", "validity", *TASKS, "--n", str(count), *model, *more)


@pytest.mark.parametrize(
    ("act", "told"),
    [(refuses(402, "pay first"), "402|pay|money|balance"),
     (refuses(401, "who are you"), "unauthorised"), (refuses(418, "teapot"), "418|teapot")],
    ids=["no money", "wrong key", "an odd status"],
)
def test_one_plan_that_nobody_could_make(act: Act, told: str, server: ChaosServer, tmp_path: Path) -> None:
    server.plays(act)
    out = tmp_path / "plans.jsonl"
    for more in ((), ("--reflections",), ("--reflections", "--reflections-by", "own"), ("--out", str(out))):
        result = ask(server, *more)
        assert result.exit_code == 1 and result.stdout == "", result.output
        (line,) = result.stderr.splitlines()
        assert line.startswith("infrastructure error, not scored: ") and "the same command asks again" in line
        assert any(word in line for word in told.split("|")), line
    server.plays(PLAN)
    found = json.loads(ask(server, "--out", str(out)).stdout)
    assert found["optimal"]
    server.plays(refuses(402))
    assert json.loads(ask(server, "--out", str(out)).stdout) == found and not server.asked, "it is kept"


def test_what_a_plan_took_is_told(server: ChaosServer, tmp_path: Path) -> None:
    usage = {"prompt_tokens": 900, "completion_tokens": 40}
    server.plays(says("I would rather not.", usage=usage), says(f"Plan: [{RIGHT}place to microwave]", usage=usage))
    out = tmp_path / "plans.jsonl"
    asked = ask(server, "--out", str(out))
    told = json.loads(asked.stdout)
    assert told["optimal"] and told["usage"] == {
        "calls": 2, "requests": 2, "repeats": 0, "sent_back": 1, "prompt_tokens": 1800, "completion_tokens": 80,
        "money": 0.0, "unpriced": 0,
    }  # fmt: skip
    said = "usage: custom:m: 2 calls, 1 answer sent back, 1,800 tokens in, 80 out, cost $0"
    assert asked.stderr.splitlines() == [said]
    again = ask(server, "--out", str(out))
    assert (again.stdout, again.stderr) == (asked.stdout, asked.stderr) and len(server.asked) == 2
    own = json.loads(ask(server, "--reflections", "--reflections-by", "own").stdout)
    assert own["first_iteration_usage"]["calls"] > 0 and own["usage"]["calls"] == 1
    offline = remac("plan", "--task", TASK)
    assert "usage" not in json.loads(offline.stdout) and offline.stderr == ""


def test_what_an_experiment_took_is_told(server: ChaosServer, tmp_path: Path) -> None:
    file = tmp_path / "x.json"
    done = experiment(server, "--json", str(file), "--planner", "noop", count=3)
    (line,) = done.stderr.splitlines()
    assert line.startswith("usage: custom:m: 3 calls, ") and line.endswith("cost $0")
    told = json.loads(file.read_text())
    assert list(told["usage"]) == ["custom:m"] and told["usage"]["custom:m"]["calls"] == 3
    by_planner = {trial["planner"]: trial.get("usage") for trial in told["trials"]}
    assert by_planner["custom:m"]["calls"] == 1 and by_planner["noop"] is None


def test_findings_of_before_usage_was_kept_can_be_read(server: ChaosServer, tmp_path: Path) -> None:
    out = tmp_path / "plans.jsonl"
    now = json.loads(ask(server, "--out", str(out)).stdout)
    settings, finding = map(json.loads, out.read_text().splitlines())
    del finding["found"]["usage"]
    out.write_text(json.dumps(settings) + "\n" + json.dumps(finding) + "\n")
    old = ask(server, "--out", str(out))
    assert json.loads(old.stdout) == {name: value for name, value in now.items() if name != "usage"} and not old.stderr


def test_a_key_that_is_missing(server: ChaosServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DEEPSEEK_API_KEY", raising=False)
    result = remac("plan", "--task", TASK, "--planner", "deepseek:deepseek-chat", "--no-preflight")
    assert result.exit_code == 1 and "DEEPSEEK_API_KEY" in result.stderr and "not scored" in result.stderr


class Breaking:
    """Answers well until it has answered `good` times, then refuses."""

    def __init__(self, good: int) -> None:
        self.good, self.answered = good, 0

    def __call__(self, connection: socket.socket, asked: Asked) -> None:
        if self.answered >= self.good:
            refuses(402, "pay first")(connection, asked)
            return
        self.answered += 1
        PLAN(connection, asked)


def test_an_experiment_keeps_what_came_and_asks_for_the_rest(server: ChaosServer, tmp_path: Path) -> None:
    file = tmp_path / "new" / "x.json"
    server.plays(Breaking(2))
    broken = experiment(server, "--json", str(file))
    assert broken.exit_code == 1 and "infrastructure error, not scored: custom:m: " in broken.stderr
    assert "and 3 more; the same command asks again" in broken.stderr
    assert len(server.asked) == 5, "after three errors in a row it is not asked any more"
    assert len(json.loads(file.read_text())["trials"]) == 2 and "2/2" in broken.stdout
    lines = file.with_suffix(".jsonl").read_text().splitlines()
    assert len(lines) == 3 and json.loads(lines[0])["settings"]["n"] == 6

    server.plays(PLAN)
    whole = experiment(server, "--json", str(file))
    assert whole.exit_code == 0 and len(server.asked) == 4, "what is there is not asked again"
    assert [trial["seed"] for trial in json.loads(file.read_text())["trials"]] == list(range(6))

    server.plays(refuses(402))
    again = experiment(server, "--json", str(file))
    assert again.exit_code == 0 and not server.asked and again.stdout == whole.stdout


def test_a_torn_line_is_asked_for_again(server: ChaosServer, tmp_path: Path) -> None:
    out = tmp_path / "x.jsonl"
    assert experiment(server, "--out", str(out), count=2).exit_code == 0
    data = out.read_bytes()
    for cut in (len(data) - 1, len(data) - 30):
        out.write_bytes(data[:cut])
        server.plays(PLAN)
        assert experiment(server, "--out", str(out), count=2).exit_code == 0
        assert len(server.asked) == (cut < len(data) - 1)


def test_other_settings_in_the_same_file_are_refused(server: ChaosServer, tmp_path: Path) -> None:
    out = tmp_path / "x.jsonl"
    assert experiment(server, "--out", str(out), count=1).exit_code == 0
    server.plays(PLAN)
    for more, named in ((("--starts", "mixed"), "starts ['paper'], not ['mixed']"), (("--robots", "2"), "robots [1]"),
                        (("--reflections", "own"), "reflections 'rule'"), (("--planner", "noop"), "noop")):  # fmt: skip
        result = experiment(server, "--out", str(out), *more, count=1)
        assert result.exit_code == 2 and named in result.stderr and "other settings" in result.stderr
    assert "n 1, not 2" in experiment(server, "--out", str(out), count=2).stderr
    other = remac("experiment", "wording", *TASKS, "--n", "1", "--planner", "noop", "--out", str(out))
    assert other.exit_code == 2 and "experiment validity" in other.stderr
    assert "planner" in ask(server, "--out", str(out)).stderr
    assert not server.asked
    foreign = tmp_path / "foreign.txt"
    foreign.write_text("my notes\n")
    assert "is not a file of findings" in experiment(server, "--out", str(foreign)).stderr
    assert foreign.read_text() == "my notes\n"


def test_reflections_of_its_own_are_kept_too(server: ChaosServer, tmp_path: Path) -> None:
    line = ("experiment", "wording", *TASKS, "--n", "1", "--reflections", "own", "--planner", "custom:m", "--base-url",
            server.url, "--no-preflight", "--json", str(tmp_path / "x.json"))  # fmt: skip
    server.plays(Breaking(5))
    assert remac(*line).exit_code == 1
    server.plays(PLAN)
    first = remac(*line)
    assert first.exit_code == 0 and 0 < len(server.asked) <= 5  # of nine: a plan told and untold, and a first try
    server.plays(refuses(402))
    assert remac(*line).stdout == first.stdout and not server.asked


def test_what_a_planner_raises_is_its_own_failure(tmp_path: Path) -> None:
    planner = tmp_path / "planner.py"
    planner.write_text("def plan(request):\n    raise RuntimeError('boom')\n")
    result = remac("plan", "--task", TASK, "--planner", f"{planner}:plan")
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert not found["valid"] and found["error"]["type"] == "parse"
    assert "RuntimeError: boom" in found["error"]["sentence"]
    for name in ("validity", "wording", "reflection"):
        for whose in ("rule", "own"):
            file = tmp_path / f"{name}-{whose}.json"
            line = ("experiment", name, *TASKS, "--n", "2", "--planner", f"{planner}:plan", "--json", str(file))
            assert remac(*line, "--reflections", whose).exit_code == 0
            trials = json.loads(file.read_text())["trials"]
            assert len(trials) >= 2 and not any(trial["valid"] for trial in trials)


def test_budgets_bound_each_plan_and_cassettes_play_them(server: ChaosServer, tmp_path: Path) -> None:
    tape = str(tmp_path / "tape.jsonl")
    assert experiment(server, "--max-calls", "1", "--cassette", tape, count=3).exit_code == 0
    assert len(server.asked) == 3, "one call a plan, not one in all"
    server.plays(refuses(402))
    replayed = experiment(server, "--cassette", tape, "--replay", "--json", str(tmp_path / "x.json"), count=3)
    assert replayed.exit_code == 0 and not server.asked
    assert all(trial["optimal"] for trial in json.loads((tmp_path / "x.json").read_text())["trials"])
    assert "--replay needs --cassette" in experiment(server, "--replay").stderr
    spent = json.loads(ask(server, "--max-calls", "0").stdout)
    assert "over_budget" in spent["error"]["sentence"], "a spent budget is the planner's failure"


def test_a_book_without_a_file_forgets_with_its_process(tmp_path: Path) -> None:
    book = Book()
    book.add({"what": "plan"}, {"valid": True})
    assert book.find({"what": "plan"}) == {"valid": True} and len(Book()) == 0 and not list(tmp_path.iterdir())
