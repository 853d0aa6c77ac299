"""Anyone's planner: by file, module, function, address and answers; docs/planners.md is run as it stands."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from agent_kitchens import play, suite_kitchen
from remac_bench.playing import agents as bench_agents

import remac_agents
from remac_agents.planners.http import HttpPlanner
from remac_agents.roles import PlanRequest, StopEpisode
from remac_agents.roles.request_json import as_json, png
from remac_agents.wiring.catalogue import make_role
from remac_env.errors import OptionError, RemacError, UnknownNameError
from remac_env.rules.scene import public_scene

PAGE = Path(__file__).parents[3] / "docs" / "planners.md"
TASK = "OpenMicrowavePnP"


def block(kind: str, index: int = 0) -> str:
    return re.findall(rf"```{kind}\n(.*?)```", PAGE.read_text("utf-8"), flags=re.DOTALL)[index]


def request(**changes: Any) -> PlanRequest:
    env = suite_kitchen(TASK)
    _, infos = env.reset(seed=1)
    told = next(iter(infos.values()))
    facts: dict[str, Any] = {
        "goal": told["goal"], "scene": told["text"], "facts": public_scene(told["scene"]), "robots": ("robot_0",),
        "lead": "robot_0", "commands": tuple(told["commands"]), "episode": {"task": TASK},
    }  # fmt: skip
    return PlanRequest(**facts | changes)


# -- Python ------------------------------------------------------------------------------------------


def test_the_python_example_is_short_and_works(tmp_path: Path) -> None:
    file = tmp_path / "my_planner.py"
    file.write_text(block("python"))
    assert len(block("python").splitlines()) < 15
    for given in (f"{file}:plan", bench_agents.role(f"{file}:plan"), make_role("planner", f"{file}:plan")):
        report = play(suite_kitchen(TASK, robots=1), remac_agents.make("BASE", planner=given))
        assert report.success and report.initial_plan_length == 6


def test_classes_objects_and_options_of_a_file(tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text(
        "from __future__ import annotations\nfrom dataclasses import dataclass\n\n@dataclass\nclass Mine:\n"
        "    steps: int = 1\n    def plan(self, request):\n        return ['navigate aside'] * self.steps\n\n"
        "ready = Mine(3)\n"
    )
    lengths = []
    for given in (f"{file}:Mine", bench_agents.role(f"{file}:Mine,steps=2"), f"{file}:ready"):
        planner = make_role("planner", given)
        lengths.append(len(planner.plan(request())))
    assert lengths == [1, 2, 3]
    assert make_role("planner", f"{file}:ready") is make_role("planner", f"{file}:ready")
    file.write_text("def plan(request):\n    return []\n\nchanged = True\n")
    assert make_role("planner", f"{file}:plan").plan(request()) == []


def test_plain_functions_stand_for_roles_with_one_verb() -> None:
    def check(conditions: Any, view: Any) -> Any:
        return make_role("checker", "none").check(conditions, view)

    def wise(asked: PlanRequest) -> list[str]:
        seen.append(asked.world)
        return ["navigate aside"]

    seen: list[Any] = []
    wise.needs_truth = True  # type: ignore[attr-defined]
    report = play(suite_kitchen(TASK, robots=1), remac_agents.make("CC", planner=wise, checker=check))
    assert report.initial_plan_length == 1
    assert report.truth_readers == ("planner",) and seen[0] is not None
    with pytest.raises(OptionError, match="before, after"):
        make_role("conditions", check)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("nobody", "path/file.py:Name, provider:model, http://HOST:PORT/PATH, answers:FILE.json"),
        ("no/such/file.py:Name", "no/such/file.py"),
        ("remac_agents.planners.noop:Nobody", "NoopPlanner"),
        ("answers:no_such.json", "no_such.json"),
        ("http:///plan", "http://HOST:PORT/PATH"),
        ({"name": "http://127.0.0.1:1/", "seconds": 0}, "seconds 0"),
        ({"name": "http://127.0.0.1:1/", "tea": 1}, "tea"),
        ({"name": "math:sqrt", "x": 1}, "no options"),
        (HttpPlanner, "is a class"),
    ],
)
def test_what_cannot_be_resolved_says_what_is_valid(given: object, told: str) -> None:
    with pytest.raises(RemacError, match=re.escape(told)):
        make_role("planner", given)


def test_a_file_that_is_no_python_and_one_that_fails(tmp_path: Path) -> None:
    broken = tmp_path / "broken.py"
    broken.write_text("def plan(:")
    with pytest.raises(UnknownNameError, match="broken.py"):
        make_role("planner", f"{broken}:plan")
    broken.write_text("1 / 0")
    with pytest.raises(ZeroDivisionError):
        make_role("planner", f"{broken}:plan")
    with pytest.raises(UnknownNameError, match="truth"):
        make_role("checker", "http://127.0.0.1:1/")


# -- HTTP --------------------------------------------------------------------------------------------


class Server(BaseHTTPRequestHandler):
    """Answers by its path."""

    asked: list[Any] = []

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers["content-length"])))
        type(self).asked.append(body)
        status, answer = {
            "/plan": (200, json.dumps({body["lead"]: ["navigate aside"]})),
            "/text": (200, "<think>hm</think>Plan: [navigate aside]"),
            "/string": (200, json.dumps("robot_0: [navigate aside]")),
            "/nested": (200, json.dumps({"plan": ["navigate aside"]})),
            "/twice": (200, '{"robot_0": ["wait"], "robot_0": ["navigate aside"]}'),
            "/long": (200, "x" * 2_000_000),
            "/bytes": (200, "\udcff"),
            "/deep": (200, "[" * 100_000),
            "/empty": (200, ""),
            "/broken": (500, "no"),
            "/away": (302, ""),
            "/slow": (200, "drip"),
        }[self.path]
        self.send_response(status)
        if status == 302:
            self.send_header("location", "/plan")
        self.end_headers()
        for _ in range(100 if answer == "drip" else 1):
            try:
                self.wfile.write(answer.encode("utf-8", errors="surrogateescape"))
                self.wfile.flush()
            except OSError:
                return
            if answer == "drip":
                time.sleep(0.05)

    def log_message(self, *arguments: Any) -> None:
        """Says nothing."""


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), Server)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_address[1]}"
    server.shutdown()
    server.server_close()


@pytest.mark.parametrize("path", ["/plan", "/text", "/string", "/nested"])
def test_an_address_is_sent_the_request_and_its_answer_read(address: str, path: str) -> None:
    Server.asked.clear()
    report = play(suite_kitchen(TASK, robots=1), remac_agents.make("RE", planner=address + path))
    assert report.initial_plan == {"robot_0": ("navigate aside",)} and not report.errors
    (asked,) = Server.asked
    assert asked["goal"] and "navigate aside" in asked["commands"] and asked["robots"] == ["robot_0"]
    assert asked["iteration"] == 0 and asked["episode"] == {"task": TASK} and asked["holding"] == {"robot_0": None}
    assert "world" not in asked and "facts" not in asked


@pytest.mark.parametrize(
    ("path", "told"),
    [
        ("/twice", "two different plans"),
        ("/long", "more than 1000000 bytes"),
        ("/bytes", "command"),
        ("/deep", "JSON"),
        ("/empty", "no command"),
        ("/broken", "status 500"),
        ("/away", "status 302"),
        ("/slow", "within 0.4 s"),
    ],
)
def test_faults_of_an_address_are_errors_of_the_agent(address: str, path: str, told: str) -> None:
    planner = {"name": address + path, "seconds": 0.4 if path == "/slow" else 10.0}
    start = time.monotonic()
    report = play(suite_kitchen(TASK, robots=1), remac_agents.make("BASE", planner=planner))
    assert time.monotonic() - start < 5.0
    assert not report.success and len(report.errors) == 3
    assert told in report.errors[0]


def test_nobody_listens() -> None:
    """No planner is to blame for not having been started."""
    with pytest.raises(StopEpisode, match="nobody is at http://127.0.0.1:9/plan: ConnectError") as found:
        HttpPlanner("http://user:secret@127.0.0.1:9/plan", seconds=2.0).plan(request())
    assert found.value.infrastructure and "secret" not in str(found.value)
    report = play(suite_kitchen(TASK, robots=1), remac_agents.make("BASE", planner="http://127.0.0.1:9/plan"))
    assert report.infrastructure and "127.0.0.1:9" in report.infrastructure


@pytest.mark.parametrize("url", ["http://h:port/x", "http://h:99999/", "http://[::1/x", "http:///x"])
def test_addresses_that_are_none(url: str) -> None:
    with pytest.raises(OptionError, match="valid: http://HOST:PORT/PATH"):
        HttpPlanner(url)


def test_the_http_example_works() -> None:
    space: dict[str, Any] = {}
    code = block("python", 1).replace("8000", "0")
    made, serves = "HTTPServer((", ".serve_forever()"
    assert made in code and serves in code, "the example does not serve"
    code = code.replace(f"\n{made}", f"\nserver = {made}").replace(serves, "")
    exec(compile(code, "server.py", "exec"), space)  # noqa: S102
    server = space["server"]
    server.RequestHandlerClass.log_message = lambda *arguments: None
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        planner = f"http://127.0.0.1:{server.server_address[1]}/plan"
        report = play(suite_kitchen(TASK, robots=1), remac_agents.make("CC", planner=bench_agents.role(planner)))
    finally:
        server.shutdown()
        server.server_close()
    assert report.initial_plan_length == 2


def test_pictures_travel_as_png() -> None:
    import cv2

    picture = np.arange(5 * 7 * 3, dtype=np.uint8).reshape(5, 7, 3)
    read = cv2.imdecode(np.frombuffer(png(picture), np.uint8), cv2.IMREAD_COLOR)
    assert (read[..., ::-1] == picture).all()
    assert json.dumps(as_json(request(images={"robot_0": {"front": picture}})))


# -- answers -----------------------------------------------------------------------------------------


def test_the_answers_example_works(tmp_path: Path) -> None:
    file = tmp_path / "answers.json"
    file.write_text(block("json"))
    env, agent = suite_kitchen("HeatOnStove", robots=1), remac_agents.make("RE", planner=f"answers:{file}")
    firsts = [play(env, agent, seed=seed).initial_plan["robot_0"][0] for seed in (0, 7, 7)]
    assert firsts == ["navigate to vegetable", "navigate to pan", "navigate to stove"]
    missing = play(suite_kitchen(TASK), remac_agents.make("BASE", planner=f"answers:{file}"))
    assert f"{TASK}/3/0" in missing.errors[0]
    stepwise = play(env, remac_agents.make("CAPE", planner=f"answers:{file}", checker="none"), seed=7)
    assert stepwise.final_plan["robot_0"] == ("navigate to pan", "pick up pan")


@pytest.mark.parametrize("text", ["[1, 2]", "{", "[" * 100_000])
def test_answers_that_are_no_object(tmp_path: Path, text: str) -> None:
    file = tmp_path / "answers.json"
    file.write_text(text)
    with pytest.raises(OptionError, match="answers.json"):
        make_role("planner", f"answers:{file}")


@pytest.mark.long  # pages are carried out by tests/test_documents_run.py
def test_the_command_line_takes_the_same_texts(tmp_path: Path) -> None:
    (tmp_path / "my_planner.py").write_text(block("python"))
    command = next(line for line in PAGE.read_text().splitlines() if "my_planner.py:plan" in line).split()
    done = subprocess.run(
        [sys.executable, "-m", "remac_bench", *command[1:], "--seeds", "0:2", "--jobs", "1"],
        cwd=tmp_path, capture_output=True, text=True, timeout=120,
        env={"PYTHONPATH": f"{PAGE.parents[1]}:{PAGE.parents[1] / 'benchmarks'}", "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    records = [json.loads(line) for line in (tmp_path / "runs/mine/records.jsonl").read_text().splitlines()]
    assert [record["success"] for record in records] == [True, True]
