"""The pages in a real Chromium: filters, sorting, the video, deep links, phones, the keyboard, no outside request."""

from __future__ import annotations

import json
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from bench_helpers import wait_for
from pages_helpers import hostile, mixed, real_run, spoken
from remac_bench.pages import write_pages
from remac_bench.pages.episode_page import page_name
from remac_bench.report import read_records
from remac_bench.store import Store

pytestmark = pytest.mark.long

SCHEMES = ("light", "dark")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = real_run(tmp_path_factory.mktemp("run"), video="last")
    Store(folder).append([spoken(folder)])
    write_pages(folder)
    return folder


@pytest.fixture(scope="module")
def evil(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("evil")
    Store(folder).append([hostile()])
    write_pages(folder)
    return folder


def visit(driver: Any, path: Path, fragment: str = "", *, width: int = 1240, scheme: str = "light") -> None:
    """Open a page anew, with nothing left in the logs; `about:blank` between, or a fragment would not reload it."""
    driver.get("about:blank")
    metrics = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    features = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", features)
    driver.get_log("browser")
    driver.get_log("performance")
    driver.get(path.resolve().as_uri() + fragment)


def complaints(driver: Any) -> list[str]:
    """Errors on the console, those of the content policy among them; a picture that is lost is none of ours."""
    return [entry["message"] for entry in driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]


def requests(driver: Any) -> set[str]:
    """Addresses that the page asked for."""
    told = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    return {m["params"]["request"]["url"] for m in told if m["method"] == "Network.requestWillBeSent"}


def outside(driver: Any, folder: Path) -> set[str]:
    """Those that do not lie in the run's folder; a player's own icons are `data:`, which asks nobody."""
    return {url for url in requests(driver) if not url.startswith((folder.resolve().as_uri(), "about:", "data:"))}


def episode(folder: Path, method: str = "REMAC") -> Path:
    record = next(r for r in read_records(folder) if r.method == method and r.scored and r.video)
    return folder / "episodes" / page_name(record)


def too_wide(driver: Any) -> int:
    """Pixels by which the page can be scrolled sideways."""
    return int(driver.execute_script("const d = document.documentElement; return d.scrollWidth - d.clientWidth"))


def column(driver: Any, key: str) -> list[str]:
    """What a column of the results shows."""
    return driver.execute_script(
        """const head = document.querySelector(`table[data-sheet^=results] th[data-key=${arguments[0]}]`);
        const rows = [...head.closest("table").tBodies[0].rows].filter((row) => row.offsetParent);
        return rows.map((row) => row.cells[head.cellIndex].textContent.trim());""",
        key,
    )


def choose(driver: Any, **filters: str) -> None:
    """Write into filters as a person does, and wait until the page has followed."""
    for name, text in filters.items():
        field = driver.find_element("css selector", f"input[data-filter={name}]")
        field.clear()
        field.send_keys(text)
    stands = """const now = new URLSearchParams(location.hash.slice(1));
      return Object.entries(arguments[0]).every(([name, text]) => (now.get(name) ?? "") === text);"""
    wait_for(lambda: driver.execute_script(stands, filters))


def cells(driver: Any, kind: str) -> dict[str, dict[str, str]]:
    """Agent (and task) -> column -> what the tables of a kind show; with the numbers behind it."""
    return driver.execute_script(
        """const found = {};
        for (const table of document.querySelectorAll(`table[data-sheet^=${arguments[0]}]`)) {
          for (const row of [...table.tBodies[0].rows].filter((row) => row.offsetParent)) {
            const told = found[`${row.dataset.agent} ${row.dataset.task ?? ""}`.trim()] = {};
            for (const head of table.tHead.rows[0].cells) {
              const cell = row.cells[head.cellIndex];
              if (head.hidden || head.classList.contains("extra")) continue;
              const end = (name) => Number(cell.dataset[name] ?? "NaN").toFixed(9);
              told[head.dataset.key] = [cell.querySelector(".cell").textContent, end("value"), end("low")].join(" ");
            }
          }
        }
        return found;""",
        kind,
    )


def test_a_filter_leaves_only_its_rows(driver: Any, run: Path) -> None:
    visit(driver, run / "leaderboard.html")
    assert {"CC", "REMAC"} <= set(column(driver, "agent"))
    choose(driver, method="REMAC")
    assert set(column(driver, "agent")) == {"REMAC"}
    shown = "return [...document.querySelectorAll('#episodes tbody tr')].filter((row) => row.offsetParent).length"
    assert driver.execute_script(shown) == 2
    assert driver.current_url.endswith("#method=REMAC")
    driver.find_element("css selector", "button[type=reset]").click()
    driver.execute_async_script("setTimeout(arguments[0], 50)")
    assert "CC" in column(driver, "agent")
    assert "method" not in driver.current_url and complaints(driver) == []


def test_filters_stand_in_the_address_and_are_searched_by_a_part(driver: Any, run: Path) -> None:
    visit(driver, run / "leaderboard.html", "#task=heaton&result=success")
    assert set(column(driver, "task")) == {"HeatOnStove"}
    assert driver.execute_script("return document.querySelector('[data-filter=task]').value") == "heaton"
    choose(driver, task="", method="CC, nobody")
    assert set(column(driver, "agent")) == {"CC", "CC (checker=some:model)"}
    choose(driver, method="c, remac")
    assert {"CC", "REMAC"} <= set(column(driver, "agent"))


FILTERED = [
    {"style": "coastal"},
    {"layout": "one_wall_small", "task": "Heat"},
    {"robots": "2"},
    {"method": "CC", "style": "rustic"},
]


@pytest.mark.parametrize("wanted", FILTERED, ids=str)
def test_what_is_counted_again_is_what_a_report_of_these_records_says(
    driver: Any, many: Path, tmp_path: Path, wanted: dict[str, str]
) -> None:
    kept = [r for r in read_records(many) if all(text in str(getattr(r, name)) for name, text in wanted.items())]
    assert 0 < len(kept) < len(read_records(many))
    Store(tmp_path).append(kept)
    write_pages(tmp_path)
    seen = []
    for folder, filters in ((tmp_path, {}), (many, wanted)):
        visit(driver, folder / "leaderboard.html")
        choose(driver, **filters)
        seen.append({kind: cells(driver, kind) for kind in ("matrix", "ranking", "results")})
    alone, filtered = seen
    # A report of one agent ranks nobody.
    assert alone["ranking"] == (filtered["ranking"] if len(alone["matrix"]) > 1 else {})
    for name, row in alone["matrix"].items():
        assert list(row.values()) == list(filtered["matrix"][name].values()), name
    for name, row in alone["results"].items():
        assert {key: filtered["results"][name][key] for key in row} == row, name
    assert complaints(driver) == []


def test_clearing_the_filters_brings_back_what_the_report_said(driver: Any, many: Path) -> None:
    visit(driver, many / "leaderboard.html")
    kinds = ("matrix", "ranking", "results")
    before = {kind: cells(driver, kind) for kind in kinds}
    choose(driver, result="failed")
    changed = {kind: cells(driver, kind) for kind in kinds}
    assert all(changed[kind] != before[kind] for kind in kinds)
    assert "share of episodes" in driver.find_element("css selector", ".recounted:not([hidden])").text
    driver.find_element("css selector", "button[type=reset]").click()
    driver.execute_async_script("setTimeout(arguments[0], 50)")
    assert {kind: cells(driver, kind) for kind in kinds} == before


def test_bars_and_chart_follow_the_filters(driver: Any, many: Path) -> None:
    look = """const full = [...document.querySelectorAll(".bars .line:not([hidden]) .full")];
      const dots = [...document.querySelectorAll(".scatter .entry:not([hidden]) circle")];
      return [full.map((each) => each.getAttribute("width")), dots.map((each) => each.getAttribute("cy"))];"""
    visit(driver, many / "leaderboard.html")
    before = driver.execute_script(look)
    choose(driver, style="coastal")
    after = driver.execute_script(look)
    assert before[0] != after[0] and before[1] != after[1]


def test_two_agents_side_by_side(driver: Any, many: Path) -> None:
    visit(driver, many / "leaderboard.html", "#first=CC&second=BASE")
    told = driver.find_element("css selector", "#compare .told").text
    records = read_records(many)
    won = {name: {(r.task, r.seed) for r in records if r.agent == name and r.success} for name in ("CC", "BASE")}
    both, alone = len(won["CC"] & won["BASE"]), len(won["CC"] - won["BASE"])
    assert f"{both} were solved by both, {alone} by the first alone" in told
    lines = driver.find_elements("css selector", "#compare tbody tr")
    assert len(lines) == sum(r.agent == "CC" for r in records)
    driver.find_element("css selector", "[data-differing]").click()
    differ = driver.find_elements("css selector", "#compare tbody tr")
    assert len(differ) == len(won["CC"] ^ won["BASE"])
    differ[0].find_element("css selector", "a").click()
    assert "/episodes/" in driver.current_url


TOO_WIDE = """return [...document.querySelectorAll("main > section > .scroll")].filter((each) =>
  each.querySelector("table") && each.scrollWidth > each.clientWidth + 1).map((each) => each.ariaLabel)"""


def test_main_tables_fit_a_phone(driver: Any, run: Path, many: Path) -> None:
    for folder in (run, many):
        visit(driver, folder / "leaderboard.html", width=375)
        assert driver.execute_script(TOO_WIDE) == []


def test_sorting_by_mouse_and_by_keyboard(driver: Any, run: Path) -> None:
    from selenium.webdriver.common.keys import Keys

    visit(driver, run / "leaderboard.html")
    head = driver.find_element("css selector", "table[data-sheet^=results] th[data-key=seconds]")
    button = head.find_element("css selector", "button")
    button.click()
    seconds = [float(text) for text in column(driver, "seconds") if text not in ("-", "\u2013")]
    assert head.get_attribute("aria-sort") == "descending" and seconds == sorted(seconds, reverse=True)
    assert len(set(seconds)) > 2
    button.send_keys(Keys.ENTER)
    seconds = [float(text) for text in column(driver, "seconds") if text not in ("-", "\u2013")]
    assert head.get_attribute("aria-sort") == "ascending" and seconds == sorted(seconds)
    focus = "const s = getComputedStyle(document.activeElement); return [s.outlineStyle, parseFloat(s.outlineWidth)]"
    style, width = driver.execute_script(focus)
    assert style == "solid" and width > 1


def test_copying_as_markdown_and_csv(driver: Any, run: Path) -> None:
    visit(driver, run / "leaderboard.html")
    driver.execute_script("window.copied = []; navigator.clipboard.writeText = async (text) => { copied.push(text); };")
    for button in driver.find_elements("css selector", "#ranking [data-copy]"):
        button.click()
    markdown, csv = driver.execute_script("return copied")[:2]
    assert markdown.startswith("| Method |") and "| REMAC |" in markdown
    assert csv.splitlines()[0].startswith("Method,Rank") and "TSR,TSR low,TSR high" in csv
    widths = {line.count(",") for line in csv.splitlines() if '"' not in line}
    assert len(widths) == 1


def test_an_episode_opens_and_its_video_goes_with_the_plan(driver: Any, run: Path) -> None:
    visit(driver, run / "leaderboard.html")
    link = driver.find_element("css selector", f"#episodes a[href$='{episode(run).name}']")
    link.click()
    assert driver.current_url.endswith(episode(run).name)
    state = driver.execute_async_script(
        """const [done] = arguments, video = document.querySelector("video"), lines = [];
        const x = () => Number(document.querySelector(".playhead").getAttribute("x1"));
        const go = async () => { await video.play(); lines.push(x());
          video.addEventListener("ended", () => { lines.push(x()); done({lines, time: video.currentTime}); }); };
        if (video.readyState > 1) go(); else video.addEventListener("loadeddata", go, {once: true});"""
    )
    assert state["time"] > 0 and state["lines"][1] > state["lines"][0] + 500
    assert outside(driver, run) == set() and complaints(driver) == []


def test_a_bar_seeks_the_video(driver: Any, run: Path) -> None:
    visit(driver, episode(run))
    record = next(r for r in read_records(run) if page_name(r) == episode(run).name)
    assert record.video is not None and len(record.video.rounds) == record.rounds
    time = driver.execute_async_script(
        """const [done] = arguments, video = document.querySelector("video");
        const click = new MouseEvent("click", {bubbles: true, cancelable: true});
        const go = () => { video.addEventListener("seeked", () => done(video.currentTime), {once: true});
          document.querySelector(".bar[data-round='2']").dispatchEvent(click); };
        if (video.readyState > 1) go(); else video.addEventListener("loadeddata", go, {once: true});"""
    )
    assert time == pytest.approx(record.video.rounds[2], abs=0.02)
    assert driver.current_url.endswith("#round-3")
    assert driver.find_element("css selector", ".round.now").get_attribute("id") == "round-3"


def test_a_deep_link_shows_its_round(driver: Any, run: Path) -> None:
    visit(driver, episode(run), "#round-3")
    driver.execute_async_script("requestAnimationFrame(() => setTimeout(arguments[0], 200))")
    assert driver.execute_script("return document.querySelector('.round:target').id") == "round-3"
    top = driver.execute_script("return document.getElementById('round-3').getBoundingClientRect().top")
    assert 0 <= top < 900
    assert driver.find_elements("css selector", ".bar.now[data-round='2']")


def test_pages_work_from_a_web_server_too(driver: Any, run: Path) -> None:
    handler = partial(SimpleHTTPRequestHandler, directory=str(run))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        driver.get("about:blank")
        driver.get_log("browser")
        driver.get(f"http://127.0.0.1:{server.server_port}/episodes/{episode(run).name}")
        assert driver.execute_async_script(
            """const video = document.querySelector("video"), [done] = arguments;
            if (video.readyState) done(true);
            video.onloadedmetadata = () => done(true); video.onerror = () => done(false);"""
        )
        assert [text for text in complaints(driver) if "favicon" not in text] == []
        driver.get("about:blank")
        server.shutdown()


@pytest.mark.parametrize("scheme", SCHEMES)
def test_phones_scroll_down_only(driver: Any, run: Path, evil: Path, scheme: str) -> None:
    for path in [page for folder in (run, evil) for page in sorted(folder.rglob("*.html"))]:
        visit(driver, path, width=375, scheme=scheme)
        driver.execute_script("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
        assert too_wide(driver) == 0, path.name
    driver.execute_script("document.querySelector('main').insertAdjacentHTML('beforeend', '<hr width=900>')")
    assert too_wide(driver) > 0


CUT = """
const seen = [...document.querySelectorAll("td .cell, .who, th .sort, .scatter .name, p, figcaption, h2, li")];
return seen.filter((each) => each.offsetParent && (each.scrollWidth > each.clientWidth + 1
  || /[^.]\u2026$/.test(each.textContent) && !each.matches(".name"))).map((each) => each.textContent);
"""
ON_EACH_OTHER = """
const box = (cell) => (cell.querySelector(".cell") ?? cell).getBoundingClientRect();
const over = (a, b) => a.top < b.bottom - 1 && b.top < a.bottom - 1 && a.left < b.right - 1 && b.left < a.right - 1;
const rows = [...document.querySelectorAll("tr")].map((row) => [...row.cells].filter((cell) => cell.offsetParent));
return rows.flatMap((row) => row.slice(1).filter((cell, index) => over(box(cell), box(row[index]))))
  .map((cell) => cell.textContent.trim());
"""


@pytest.mark.parametrize("width", [375, 1240])
def test_long_names_are_whole_and_widen_no_page(driver: Any, tmp_path: Path, width: int) -> None:
    """Names of agents hold paths and options: two that differ in their last letters alone must not look alike."""
    option, path = "noisy,false_alarm=0.125,miss=0.25", "a_folder/" * 11 + "my_planner.py:plan"
    names = {"CC": f"CC (checker={option}, planner={path})", "REMAC": f"REMAC (planner={path}2)", "BASE": "b" * 300}
    held = {"CC": option, "BASE": "c" * 90}
    records = [r.model_copy(update={"agent": names[r.agent], "checker": held.get(r.agent, "-")}) for r in mixed()]
    Store(tmp_path).append(records)
    write_pages(tmp_path)
    visit(driver, tmp_path / "leaderboard.html", width=width)
    driver.execute_script("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
    assert too_wide(driver) == 0 and (width > 375 or driver.execute_script(TOO_WIDE) == [])
    assert driver.execute_script(CUT) == [] and driver.execute_script(ON_EACH_OTHER) == []
    dots = {text.get_attribute("textContent") for text in driver.find_elements("css selector", ".scatter .name")}
    assert dots == {"CC [1]", "REMAC [2]", "bbbbbbbbbbbbbbb\u2026 [3]"}
    note = driver.find_element("css selector", "figcaption").get_attribute("textContent")
    assert all(name in note for name in names.values())
    driver.execute_script("document.querySelector('.cell').style = 'width: 3rem; white-space: nowrap'")
    assert driver.execute_script(CUT) != []


def test_filters_do_not_fill_a_phones_first_screen(driver: Any, run: Path) -> None:
    shown = "return [...document.querySelectorAll('[data-filter]')].filter((field) => field.offsetParent).length"
    visit(driver, run / "leaderboard.html", width=375)
    assert driver.execute_script(shown) == 0
    driver.find_element("css selector", ".fold").click()
    assert driver.execute_script(shown) > 5
    visit(driver, run / "leaderboard.html", "#task=heat", width=375)
    assert driver.execute_script(shown) > 5  # one is in use
    visit(driver, run / "leaderboard.html", width=1240)
    assert driver.execute_script(shown) > 5 and not driver.find_element("css selector", ".fold").is_displayed()


def test_the_scheme_is_the_readers(driver: Any, run: Path) -> None:
    seen = []
    for scheme in SCHEMES:
        visit(driver, run / "leaderboard.html", scheme=scheme)
        seen.append(driver.execute_script("return getComputedStyle(document.body).backgroundColor"))
    light, dark = (sum(int(part) for part in text[4:-1].split(",")) for text in seen)
    assert light > 600 and dark < 150


def test_hostile_text_does_nothing(driver: Any, evil: Path) -> None:
    assert len(list(evil.rglob("*.html"))) == 2
    for path in evil.rglob("*.html"):
        visit(driver, path)
        assert driver.title != "owned" and not driver.find_elements("css selector", "img[src=x]")
        assert complaints(driver) == [] and outside(driver, evil) == set()


def test_the_policy_stops_what_would_get_in(driver: Any, run: Path, tmp_path: Path) -> None:
    spoilt = tmp_path / "spoilt.html"
    html = (run / "leaderboard.html").read_text("utf-8")
    bad = '<script>document.title = "owned"</script><img src="http://127.0.0.1:9/x.png">'
    spoilt.write_text(html.replace("</main>", f"{bad}</main>"), "utf-8")
    visit(driver, spoilt)
    assert driver.title != "owned"
    assert len([text for text in complaints(driver) if "Content Security Policy" in text]) >= 2
