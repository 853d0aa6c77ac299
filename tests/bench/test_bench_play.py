"""A person plays: what they send is checked, played and told as planners hear it, and recorded like any agent's."""

from __future__ import annotations

import io
import time
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import read, wait_for
from live_helpers import client, serving
from pages_helpers import EVIL, alien
from remac_bench.cli import app
from remac_bench.errors import UsageError
from remac_bench.judging.endings import ending
from remac_bench.live.episode import person_job, refuse_played
from remac_bench.live.person import Table, read_rows
from remac_bench.live.play_app import Play
from remac_bench.proof.verify import verify
from typer.testing import CliRunner

import remac_env
from remac_env.errors import RenderingError
from remac_env.oracle import certify

TASK = "HeatOnStove"


def shortest(robots: int, seed: int = 0) -> dict[str, list[str]]:
    """The oracle's plan."""
    env = remac_env.parallel_env(TASK, robots=robots, backend="symbolic")
    env.reset(seed=seed)
    found = certify(env.start.scene, env.world, env.goal).plan
    assert found is not None
    return {robot: list(row) for robot, row in found.as_text().items()}


class Seat:
    """A browser without a screen."""

    def __init__(self, server: Any) -> None:
        self.http = client(server)
        self.own = {"Origin": f"http://127.0.0.1:{server.port}"}

    def state(self, phase: str) -> dict[str, Any]:
        def reached() -> bool:
            time.sleep(0.02)
            seen = self.http.get("/state").json()
            assert seen["phase"] in (phase, "beginning", "asked", "playing", "recording"), seen
            return bool(seen["phase"] == phase)

        wait_for(reached)
        return dict(self.http.get("/state").json())

    def send(self, rows: object) -> str:
        return str(self.http.post("/orders", json={"rows": rows}, headers=self.own).json()["problem"])


def game(folder: Path, *, robots: int = 2, **kitchen: Any) -> Play:
    job = person_job(TASK, seed=0, robots=robots, kitchen={"backend": "symbolic", **kitchen})
    return Play(job, folder, video=False)


def test_a_plan_and_single_steps_reach_the_goal_and_are_recorded(tmp_path: Path) -> None:
    plan, play = shortest(2), game(tmp_path)
    with serving(play.app) as server:
        play.start()
        seat = Seat(server)
        seen = seat.state("asked")
        assert seen["robots"] == ["robot_0", "robot_1"] and seen["goal"] and "wait" in seen["commands"]["robot_0"]
        first = {robot: row[:1] for robot, row in plan.items()}
        rest = {robot: row[1:] for robot, row in plan.items()}
        assert seat.send(first) == ""
        wait_for(lambda: time.sleep(0.02) or len(seat.http.get("/state").json()["rounds"]) == 1)
        told = {robot: text for robot, text, _ in seat.state("asked")["rounds"][0]}
        assert told["robot_0"] == f"{plan['robot_0'][0]}: success"
        assert seat.send(rest) == ""
        end = seat.state("ended")
        assert (end["result"], len(end["rounds"])) == ("success", max(map(len, plan.values())))
        assert alien(seat.http.get(f"/{end['page']}").text) == []
        assert seat.http.get("/leaderboard.html").status_code == 200
        assert "episode is over" in seat.send(first)
    (record,) = read(tmp_path)
    assert (record.agent, record.method, record.scored, record.success) == ("human (robots=2)", "human", True, True)
    assert record.options["agent"] == {"planner": "human"} and record.final_plan == plan
    assert "planner" not in record.truth_readers and verify(tmp_path).findings == ()


def test_the_rest_of_a_plan_comes_back_after_a_failure(tmp_path: Path) -> None:
    plan, play = shortest(1)["robot_0"], game(tmp_path, robots=1, feedback="reason")
    with serving(play.app) as server:
        play.start()
        seat = Seat(server)
        seat.state("asked")
        wrong = [plan[0], "turn on stove knob", *plan[1:]]
        known = seat.http.get("/state").json()["commands"]["robot_0"]
        wrong[1] = next(text for text in known if text.startswith("place "))  # with an empty hand
        assert seat.send({"robot_0": wrong}) == ""
        wait_for(lambda: time.sleep(0.02) or len(seat.http.get("/state").json()["rounds"]) == 2)
        seen = seat.state("asked")
        ((_, text, failed),) = seen["rounds"][1]
        assert failed and text.startswith(f"{wrong[1]}: failure (")
        assert seen["left"] == {"robot_0": plan[1:]}
        assert seat.send(seen["left"]) == ""
        assert seat.state("ended")["result"] == "success"
    (record,) = read(tmp_path)
    assert record.agent == "human" and record.rounds == len(plan) + 1 and verify(tmp_path).findings == ()


@pytest.mark.long
@pytest.mark.parametrize("robots", [1, 2])
def test_a_person_plays_by_the_event_clock(robots: int, tmp_path: Path) -> None:
    plan, play = shortest(robots), game(tmp_path, robots=robots, clock="events")
    with serving(play.app) as server:
        play.start()
        seat = Seat(server)
        seat.state("asked")
        assert seat.send(plan) == ""
        end = seat.state("ended")
    assert end["result"] == "success" and verify(tmp_path).findings == ()
    told = [text for row in end["rounds"] for _, text, _ in row]
    assert all(f"{command}: success" in told for row in plan.values() for command in row if command != "wait")
    assert not any(text.startswith("continue") for text in told)
    assert any(text.endswith(": still at it") for text in told) == (robots == 2)
    (record,) = read(tmp_path)
    assert record.clock == "events" and record.agent == ("human (robots=2)" if robots == 2 else "human")


@pytest.mark.long
def test_a_person_is_told_no_more_than_a_planner(tmp_path: Path) -> None:
    kitchen = {"backend": "symbolic", "grade": 3, "knowledge": "seen"}
    job = person_job("Generated", seed=3, robots=1, kitchen=kitchen)
    play = Play(job, tmp_path, video=False)
    env = remac_env.parallel_env("Generated", robots=1, **kitchen)
    _, infos = env.reset(seed=3)
    with serving(play.app) as server:
        play.start()
        seen = Seat(server).state("asked")
    play.leave()
    info = infos["robot_0"]
    assert (seen["scene"], seen["goal"]) == (info["text"], info["goal"])
    assert seen["commands"] == {"robot_0": list(info["commands"])}
    assert (seen["holding"], seen["rounds"], seen["left"]) == ({"robot_0": ""}, [], {})


def test_why_there_is_no_picture_is_said_for_as_long_as_there_is_none(tmp_path: Path) -> None:
    class Annex:
        def render_work(self, *, whole: bool) -> None:
            raise RenderingError("an annex cannot be drawn")

    play = game(tmp_path, robots=1, render_mode="rgb_array")
    infos = {"robot_0": {"commands": {"wait": 0}, "goal": "cook", "text": "a kitchen", "end": None}}
    play._tell(Annex(), infos, {})
    play.table.show(problem="", left={})  # as when the person is asked
    with serving(play.app) as server:
        seat = Seat(server)
        seen, page = seat.http.get("/state").json(), seat.http.get("/").text
    assert (seen["blind"], seen["pictures"]) == ("No picture: an annex cannot be drawn", 0) and 'id="blind"' in page


def test_an_empty_order_ends_the_episode(tmp_path: Path) -> None:
    play = game(tmp_path)
    with serving(play.app) as server:
        play.start()
        seat = Seat(server)
        seat.state("asked")
        assert seat.send({}) == ""
        assert seat.state("ended")["result"] == "failed: stopped too early"
    assert [ending(record) for record in read(tmp_path)] == ["failed: stopped too early"]


def test_who_leaves_leaves_no_record(tmp_path: Path) -> None:
    play = game(tmp_path)
    with serving(play.app) as server:
        play.start()
        seat = Seat(server)
        seat.state("asked")
        assert seat.send({"robot_0": ["navigate to pan"]}) == ""
        wait_for(lambda: time.sleep(0.02) or len(seat.http.get("/state").json()["rounds"]) == 1)
        seat.state("asked")
    play.leave()
    assert play.record is None and read(tmp_path) == [] and "not recorded" in play.table.seen.problem
    refuse_played(person_job(TASK, seed=0, robots=2, kitchen={"backend": "symbolic"}), tmp_path)


COMMANDS = {"robot_0": ("wait", "pick up pan"), "robot_1": ("wait",)}


@pytest.mark.parametrize(
    "rows",
    [
        None,
        [],
        "wait",
        {"robot_9": ["wait"]},
        {"robot_0": "wait"},
        {"robot_0": ["wait"] * 201},
        {"robot_0": [EVIL]},
        {"robot_0": [["wait"]]},
        {"robot_0": [None]},
        {"robot_1": ["pick up pan"]},  # the other robot's command
        {EVIL: ["wait"]},
        {"robot_0": ["wait"], "robot_1": ["wait", "wait"]},  # nothing comes of it
    ],
    ids=lambda rows: str(rows)[:20],
)
def test_orders_that_are_none_are_refused_before_anything_changes(rows: object) -> None:
    with pytest.raises(UsageError) as refused:
        read_rows(rows, COMMANDS)
    assert "\x1b" not in str(refused.value) and len(str(refused.value)) < 400
    fine = {"robot_0": ["wait", "Pick up  pan"], "robot_1": ["wait"]}
    assert read_rows(fine, COMMANDS) == fine and read_rows({}, COMMANDS) == {}


def test_what_a_person_sends_is_as_hostile_as_what_a_model_says(tmp_path: Path) -> None:
    play = game(tmp_path)
    with serving(play.app) as server:
        play.start()
        seat = Seat(server)
        before = seat.state("asked")
        problem = seat.send({"robot_0": [EVIL]})
        assert "is not a command" in problem and "\x1b" not in problem and "\u202e" not in problem
        for body in (b"{", b"[" * 60_000, b"\xff", b"null", b'"x"', b"1e999"):
            headers = {**seat.own, "Content-Type": "application/json"}
            assert seat.http.post("/orders", content=body, headers=headers).status_code == 400
        for number in ("9" * 5_000, "-1", "0", "x", "1.5"):
            assert seat.http.get(f"/picture/{number}").status_code == 404
        foreign = {"Origin": "http://evil.example"}
        assert seat.http.post("/orders", json={"rows": {"robot_0": ["wait"]}}, headers=foreign).status_code == 403
        assert client(server, known=False).get("/state").status_code == 403
        assert seat.http.get("/state", params={"after": before["version"]}).status_code == 204
        assert alien(seat.http.get("/").text) == []


def test_an_order_is_taken_once() -> None:
    table = Table()
    with pytest.raises(UsageError, match="still being carried out"):
        table.order({})
    table.show(phase="asked", commands=COMMANDS)
    table.order({"robot_0": ["pick up pan"]})
    with pytest.raises(UsageError, match="still being carried out"):
        table.order({"robot_0": ["pick up pan"]})


def test_the_first_try_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = shortest(1)["robot_0"]
    typed = ["opn stove", "undo", *plan, ""]
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{line}\n" for line in typed)))
    flags = ["play", "--task", TASK, "--backend", "symbolic", "--terminal", "--no-video", "--out", str(tmp_path)]
    result = CliRunner().invoke(app, flags, input="".join(f"{line}\n" for line in typed))
    assert result.exit_code == 0, result.output
    assert f"1. robot_0: {plan[0]}: success" in result.stdout and f"{len(plan)}. robot_0: " in result.stdout
    assert f"success in {len(plan)} rounds, recorded in" in result.stdout
    assert "\x1b[" not in result.stdout  # nothing repaints over the prompt
    (record,) = read(tmp_path)
    assert (record.agent, record.success) == ("human", True)
    again = CliRunner().invoke(app, flags)
    assert again.exit_code == 2 and "the first try counts" in again.stderr
