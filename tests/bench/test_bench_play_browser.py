"""`remac play` and `remac view` in a real Chromium: an episode with both robots, by keys and by mouse."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import read, record, start, wait_for
from live_helpers import serving
from remac_bench.live.viewing import View
from remac_bench.proof.verify import verify
from remac_bench.store import Store
from test_bench_play import TASK, shortest

pytestmark = pytest.mark.long


def text(driver: Any, selector: str) -> str:
    return str(driver.execute_script("return document.querySelector(arguments[0])?.textContent ?? ''", selector))


def rows(driver: Any) -> list[list[str]]:
    return list(
        driver.execute_script(
            "return [...document.querySelectorAll('.row ol')].map((row) => [...row.querySelectorAll('bdi')].map((each) => each.textContent))"  # noqa: E501
        )
    )


def test_a_person_plays_an_episode(driver: Any, tmp_path: Path) -> None:
    from selenium.webdriver.common.keys import Keys

    flags = ["--task", TASK, "--robots", "2", "--backend", "symbolic", "--out", str(tmp_path)]
    process = start("play", *flags, env={"PYTHONPATH": os.pathsep.join(sys.path)})
    assert process.stdout is not None
    driver.get(process.stdout.readline().strip())
    wait_for(lambda: "Your turn" in text(driver, "#status"))
    assert "token" not in driver.current_url  # it is not left in the address bar
    search, plan = driver.find_element("css selector", "#search"), shortest(2)
    robot_0, robot_1 = plan["robot_0"], plan["robot_1"]

    search.send_keys("no such command")
    assert driver.find_elements("css selector", "#commands li") == []
    search.clear()
    for command in robot_0:
        search.send_keys(command, Keys.ENTER)
    search.send_keys(robot_1[0], Keys.ENTER)
    assert rows(driver) == [[*robot_0, robot_1[0]], []]
    search.send_keys(Keys.BACKSPACE)  # what has not been sent is taken back
    search.send_keys(Keys.ALT, "2")
    for command in robot_1:
        search.send_keys(command)
        driver.find_element("css selector", "#commands button").click()
    assert rows(driver) == [robot_0, robot_1]

    driver.find_element("css selector", "#step").click()
    wait_for(lambda: "Your turn" in text(driver, "#status") and rows(driver) == [robot_0[1:], robot_1[1:]])
    assert f"{robot_0[0]}: success" in text(driver, "#rounds")
    wait_for(lambda: driver.execute_script("const p = document.querySelector('#picture'); return p.naturalWidth") > 300)
    search.send_keys(Keys.CONTROL, Keys.ENTER)
    wait_for(lambda: "success in" in text(driver, "#status"), seconds=300)  # with a picture of each round, and a video
    complaints = [entry["message"] for entry in driver.get_log("browser") if entry["level"] == "SEVERE"]
    assert complaints == []
    driver.find_element("css selector", "#status a").click()
    assert "/episodes/" in driver.current_url and "human" in text(driver, ".over")
    wait_for(lambda: driver.execute_script("return document.querySelector('video')?.readyState ?? 0") > 0)

    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    (played,) = read(tmp_path)
    assert (played.agent, played.success, played.rounds) == ("human (robots=2)", True, max(map(len, plan.values())))
    assert verify(tmp_path).findings == ()


def test_rounds_that_are_over_before_the_page_asks(driver: Any, tmp_path: Path) -> None:
    from remac_bench.live.episode import person_job
    from remac_bench.live.play_app import Play
    from selenium.webdriver.common.keys import Keys

    play = Play(person_job(TASK, seed=0, robots=1, kitchen={"backend": "symbolic"}), tmp_path, video=False)
    with serving(play.app) as server:
        play.start()
        driver.get(server.address)
        wait_for(lambda: "Your turn" in text(driver, "#status"))
        search = driver.find_element("css selector", "#search")
        for command in ("navigate to pan", "pick up vegetable", "wait", "navigate to stove"):
            search.send_keys(command, Keys.ENTER)
        search.send_keys(Keys.CONTROL, Keys.ENTER)
        wait_for(lambda: rows(driver) == [["wait", "navigate to stove"]])
        assert "A command failed" in text(driver, "#status") and "pick up vegetable: failure" in text(driver, "#rounds")
        driver.find_element("css selector", ".row li button").click()
        assert rows(driver) == [["navigate to stove"]]
        driver.find_element("css selector", "#step").click()
        wait_for(lambda: "navigate to stove: success" in text(driver, "#rounds"))
        wait_for(lambda: rows(driver) == [[]] and text(driver, "#status") == "Your turn.")
        driver.get("about:blank")
    play.leave()


def test_progress_is_shown_while_records_come(driver: Any, tmp_path: Path) -> None:
    with serving(View(tmp_path).app) as server:
        driver.get(server.address)
        assert "No episode yet" in driver.title
        Store(tmp_path).append([record()])
        wait_for(lambda: "Leaderboard" in driver.title)
        wait_for(lambda: "1 episodes recorded" in text(driver, "#live"))
        Store(tmp_path).append([record(job="later", seed=4)])
        wait_for(lambda: "2 episodes recorded" in text(driver, "#live"))
        assert "seed 4: success" in text(driver, "#live") and "1 scored episodes of 1" in text(driver, ".lead")
        driver.find_element("css selector", "#live button").click()
        wait_for(lambda: "2 scored episodes of 2" in text(driver, ".lead"))
        driver.get("about:blank")


@pytest.mark.parametrize("width", [375, 1240])
def test_the_page_of_play_fits(driver: Any, tmp_path: Path, width: int) -> None:
    from remac_bench.live.episode import person_job
    from remac_bench.live.play_app import Play

    kitchen = {"backend": "symbolic"}
    play = Play(person_job(TASK, seed=0, robots=2, kitchen=kitchen), tmp_path, video=False)
    metrics = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    with serving(play.app) as server:
        play.start()
        driver.get(server.address)
        wait_for(lambda: "Your turn" in text(driver, "#status"))
        wide = "const d = document.documentElement; return d.scrollWidth - d.clientWidth"
        assert driver.execute_script(wide) == 0
        driver.get("about:blank")
    play.leave()
