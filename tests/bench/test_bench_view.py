"""`remac view`: pages while a run goes on, for who has the address that the terminal shows, and for nobody else."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from bench_helpers import record, start
from live_helpers import Server, client, serving
from pages_helpers import alien, hostile, parse, spoken
from remac_bench.cli import app
from remac_bench.live.tail import Tail
from remac_bench.live.viewing import View
from remac_bench.pages.episode_page import page_name
from remac_bench.records import VideoEntry
from remac_bench.store import Store
from typer.testing import CliRunner


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    Store(tmp_path).append([record(), record(job="lost", seed=1, success=False, end="lost")])
    return tmp_path


@pytest.fixture
def server(folder: Path) -> Iterator[Server]:
    with serving(View(folder).app) as made:
        yield made


def test_nobody_gets_in_without_the_token(server: Server) -> None:
    stranger = client(server, known=False)
    for path in ("/", "/progress", "/episodes/j0-0.html", "/?token=", "/?token=wrong"):
        answer = stranger.get(path)
        assert (answer.status_code, "token" in answer.text) == (403, True), path
    stranger.cookies.set(f"remac-{server.port}", "wrong")
    assert stranger.get("/").status_code == 403
    known = client(server)
    assert known.get("/").status_code == 200
    (cookie,) = known.cookies.jar
    assert cookie.has_nonstandard_attr("HttpOnly") and cookie.get_nonstandard_attr("SameSite") == "Strict"


@pytest.mark.parametrize(
    ("method", "headers", "status"),
    [
        ("GET", {"Host": "evil.example"}, 421),
        ("GET", {"Host": "127.0.0.1"}, 421),
        ("GET", {"Origin": "http://evil.example"}, 403),
        ("GET", {"Origin": "null"}, 403),
        ("POST", {}, 403),
        ("POST", {"Origin": "http://evil.example", "Content-Type": "application/json"}, 403),
        ("POST", {"Origin": "own", "Content-Type": "text/plain"}, 415),
        ("POST", {"Origin": "own", "Content-Type": "application/json", "Content-Length": "70000"}, 413),
        ("POST", {"Origin": "own", "Content-Type": "application/json"}, 405),  # past the guard: nothing is changed here
        ("DELETE", {"Origin": "own"}, 405),
    ],
    ids=str,
)
def test_what_other_sites_can_have_a_browser_send_is_refused(
    server: Server, method: str, headers: dict[str, str], status: int
) -> None:
    own = f"http://127.0.0.1:{server.port}"
    sent = {name: own if text == "own" else text for name, text in headers.items()}
    body: dict[str, Any] = {} if method == "GET" else {"content": b"x" * int(sent.pop("Content-Length", "2"))}
    assert client(server).request(method, "/", headers=sent, **body).status_code == status


def test_it_listens_on_loopback_alone(server: Server) -> None:
    assert server._socket.getsockname()[0] == "127.0.0.1"
    with pytest.raises(Exception, match="cannot be had"):
        Server(None, port=server.port)
    refused = CliRunner().invoke(app, ["view", "nowhere"])
    assert refused.exit_code == 2 and "there is no folder" in refused.stderr


def test_pages_come_from_the_records_as_they_are_now(server: Server, folder: Path) -> None:
    browser = client(server)
    before = browser.get("/progress").json()
    assert (before["episodes"], before["solved"]) == (2, 1)
    assert list(before["last"].values()) == ["HeatOnStove, CC, seed 1", "failed: goal out of reach", "lost-0.html"]
    Store(folder).append([record(job="later", seed=7)])
    now = browser.get("/progress").json()
    assert (now["episodes"], now["solved"]) == (3, 2) and now["stamp"] != before["stamp"]
    html = browser.get("/").text
    assert "3 scored episodes of 3 played" in html and alien(html) == []
    links = [each.attributes["href"] for each in parse(html).all("a") if "href" in each.attributes]
    assert "episodes/later-0.html" in links and "tables/ranking.svg" not in links
    for link in links:
        if not link.startswith("#"):
            assert browser.get(f"/{link}").status_code == 200, link
    assert 'href="lost-0.html"' in browser.get("/episodes/later-0.html").text
    assert sorted(path.name for path in folder.iterdir()) == ["records.jsonl"]  # nothing is written


def test_a_folder_without_records_waits_for_them(tmp_path: Path) -> None:
    with serving(View(tmp_path).app) as server:
        browser = client(server)
        assert "No episode yet" in browser.get("/").text and browser.get("/progress").json()["last"] is None
        Store(tmp_path).append([record()])
        assert "1 scored episodes of 1 played" in browser.get("/").text


def test_files_of_the_folder_are_served_and_no_others(folder: Path) -> None:
    (folder / "videos").mkdir()
    (folder / "videos" / "a.webm").write_bytes(b"0123456789")
    (folder / "videos" / "secret.txt").write_text("secret")
    Store(folder).append([spoken(folder, video=VideoEntry(path="videos/a.webm"))])
    with serving(View(folder).app) as server:
        browser = client(server)
        part = browser.get("/videos/a.webm", headers={"Range": "bytes=2-4"})
        assert (part.status_code, part.content) == (206, b"234")
        assert browser.get("/pictures/a1b2c3.png").headers["content-type"] == "image/png"
        for path in (
            "/records.jsonl", "/videos/secret.txt", "/videos/..%2frecords.jsonl", "/videos/%2e%2e/records.jsonl",
            "/pictures/..%2f..%2fetc%2fpasswd", "/episodes/..%2f..%2frecords.jsonl", "/tables/records.jsonl",
        ):  # fmt: skip
            assert browser.get(path).status_code == 404, path


def test_hostile_records_are_text_here_too(tmp_path: Path) -> None:
    evil = hostile()
    Store(tmp_path).append([evil])
    with serving(View(tmp_path).app) as server:
        browser = client(server)
        for path in ("/", f"/episodes/{page_name(evil)}"):
            assert alien(browser.get(path).text) == [], path
        told = browser.get("/progress").json()["last"]
        assert "\u241b[31m" in told["title"] and "\x1b" not in told["title"]


def test_a_line_that_is_being_written_is_left_for_later(tmp_path: Path) -> None:
    tail, path = Tail(tmp_path), tmp_path / "records.jsonl"
    assert tail.records() == []
    first, second = (record(job=job).line() for job in ("a", "b"))
    path.write_text(f"{first}\n{second[:40]}")
    assert [each.job for each in tail.records()] == ["a"]
    with path.open("a") as file:
        file.write(f"{second[40:]}\n{record(job='a', seed=5).line()}\n")
    assert [(each.job, each.seed) for each in tail.records()] == [("a", 5), ("b", 0)]
    path.write_text(f"{second}\n")  # begun anew
    assert [each.job for each in tail.records()] == ["b"]
    with path.open("a") as file:
        file.write("no record\n")
    with pytest.raises(Exception, match="line 2"):
        tail.records()


@pytest.mark.long
def test_the_command_serves_until_it_is_interrupted(folder: Path) -> None:
    process = start("view", str(folder), env={"PYTHONPATH": os.pathsep.join(sys.path)})
    assert process.stdout is not None
    address = process.stdout.readline().strip()
    assert httpx.get(address, trust_env=False, timeout=30).status_code == 200
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
