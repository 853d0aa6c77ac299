"""Addresses of the leaderboard that somebody else wrote, in a real Chromium: text stays text, the useless is said."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from pages_helpers import EVIL

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def page(many: Path) -> str:
    return (many / "leaderboard.html").resolve().as_uri()


def visit(driver: Any, page: str, fragment: str) -> str:
    """Open the page with a fragment; what it says of it. Fails where something ran, broke or was asked for."""
    driver.get("about:blank")
    driver.get_log("browser")
    driver.get(f"{page}#{fragment}")
    complaints = [entry["message"] for entry in driver.get_log("browser")]
    assert complaints == [] and driver.title != "owned"
    assert not driver.find_elements("css selector", "img, iframe, main script")
    assert driver.execute_script("return Object.keys(Object.prototype).length === 0 && ({}).polluted === undefined")
    return driver.find_element("css selector", ".filters .strange").text


def shown(driver: Any) -> int:
    """Rows of the list of episodes that are there."""
    return driver.execute_script(
        "return [...document.querySelectorAll('#episodes tbody tr')].filter((row) => row.offsetParent).length"
    )


HOSTILE = {
    "script": ("task=<script>document.title='owned'</script>", "No task here is called", 0),
    "quotes": ("method=" + quote("\"'`CC\"'"), "No method here is called", 0),
    "markup": ("style=" + quote(EVIL), "No style here is called", 0),
    "picture": ("style=<img src=x onerror=alert(1)>", "No style here is called “<img src=x onerror=alert(1)>”.", 0),
    "direction": ("layout=%E2%80%AEpad", "⟨U+202E⟩pad", 0),
    "null": ("layout=%00", "⟨U+0000⟩", 0),
    "prototype": ("__proto__=x&constructor=y&__proto__[polluted]=1", "Nothing here is filtered by “__proto__”.", 108),
    "prototype's value": ("task=__proto__", "No task here is called “__proto__”.", 0),
    "a method of objects": ("method=toString,CC", "No method here is called “tostring”.", 36),
    "malformed percent": ("task=%E0%A4%A&robots=%", "No task here is called", 0),
    "no text": ("task=&=&&=x", "Nothing here is filtered by “”.", 108),
    "unknown": ("task=Nobody", "No task here is called “nobody”.", 0),
    "unknown filter": ("tsk=HeatOnStove", "Nothing here is filtered by “tsk”.", 108),
    "unknown agent": ("first=Nobody&second=CC", "No agent here is called “Nobody”.", 108),
    "regular expression": ("task=" + quote("(a+)+$.*"), "No task here is called “(a+)+$.*”.", 0),
    "address": ("task=javascript:alert(1)", "No task here is called “javascript:alert(1)”.", 0),
    "huge": ("task=" + 300_000 * "a", "which is 300000 letters long", 108),
    "huge list": ("method=CC" + 100_000 * ",CC", "which is 300002 letters long", 108),
    "many": ("&".join(f"k{n}=v" for n in range(2_000)), "And 1992 more.", 108),
}


@pytest.mark.parametrize(("fragment", "said", "left"), HOSTILE.values(), ids=HOSTILE)
def test_hostile_addresses_are_text_and_what_is_unknown_is_said(
    driver: Any, page: str, fragment: str, said: str, left: int
) -> None:
    assert said in visit(driver, page, fragment)
    assert shown(driver) == left
    wide = "const d = document.documentElement; return d.scrollWidth - d.clientWidth"
    assert driver.execute_script(wide) == 0


def test_nothing_is_said_of_what_is_known(driver: Any, page: str) -> None:
    assert visit(driver, page, "task=heat&method=CC&first=CC&second=BASE") == ""
    assert visit(driver, page, "episodes") == ""
    # The last of two counts.
    assert visit(driver, page, "method=CC&method=BASE") == ""
    assert driver.execute_script("return document.querySelector('[data-filter=method]').value") == "BASE"


def test_a_page_comes_back_from_any_address(driver: Any, page: str) -> None:
    assert visit(driver, page, "tsk=x&task=Nobody&first=BASE") != ""
    driver.find_element("css selector", "button[type=reset]").click()
    driver.execute_async_script("setTimeout(arguments[0], 100)")
    assert shown(driver) == 108 and driver.current_url.endswith("#first=BASE")
    assert driver.find_element("css selector", ".filters .strange").text == ""


def test_the_agents_that_are_compared_follow_the_address(driver: Any, page: str) -> None:
    visit(driver, page, "first=CC&second=BASE")
    driver.execute_script("location.hash = '#first=REMAC&second=CC'")
    driver.execute_async_script("setTimeout(arguments[0], 100)")
    chosen = "return [...document.querySelectorAll('[data-side]')].map((each) => each.value)"
    assert driver.execute_script(chosen) == ["REMAC", "CC"]
