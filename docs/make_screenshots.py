"""Makes the pictures of the pages: `python docs/make_screenshots.py [DIR] [--to FOLDER]`.

DIR is a folder that `remac bench report` has written pages into; without one four tasks are played. Needs Chromium
and its driver (Debian: `apt-get install chromium chromium-driver`) and `pip install selenium`. With --to, each page is
taken in light and dark, wide and as narrow as a phone; without, the two pictures of the docs are made anew.
"""

from __future__ import annotations

import argparse
import base64
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np

FOLDER = Path(__file__).parent / "pictures"
SIZES = {"desktop": (1240, 900), "phone": (375, 812)}
TASKS = "OpenCabinetPnP,OpenMicrowavePnP,DefrostInBowl,HeatOnStove"
TALL = {"leaderboard": (1240, 1060), "episode": (1240, 1300)}
"""Width and height of the window, CSS pixels."""


def main() -> None:
    """Take the pictures that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path)
    parser.add_argument("--to", type=Path)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as spare, browser() as driver:
        folder = given.folder or played(Path(spare))
        pages = {"leaderboard": folder / "leaderboard.html", "episode": _with_video(folder)}
        if given.to is None:
            shoot(driver, pages["leaderboard"], FOLDER / "leaderboard.png", size=TALL["leaderboard"], scheme="light")
            shoot(driver, pages["episode"], FOLDER / "episode.png", size=TALL["episode"], scheme="dark", seek=True)
            return
        given.to.mkdir(parents=True, exist_ok=True)
        for name, page in pages.items():
            for scheme in ("light", "dark"):
                for size, box in SIZES.items():
                    target = given.to / f"{name}-{size}-{scheme}.png"
                    shoot(driver, page, target, size=box, scheme=scheme, whole=True, seek=name == "episode")


def played(folder: Path) -> Path:
    """Four tasks in physics, in one kitchen, with videos and pages."""
    run = ["bench", "run", "--tasks", TASKS, "--seeds", "0:3", "--style", "coastal", "--layout", "l_shaped_large"]
    run += ["--out", str(folder), "--video", "first", "--optimum"]
    for arguments in (run, ["bench", "report", str(folder)]):
        subprocess.run([sys.executable, "-m", "remac_bench", *arguments], check=True, stdout=subprocess.DEVNULL)
    return folder


@contextmanager
def browser() -> Iterator[Any]:
    """Chromium without a window, driven by selenium."""
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    # No sandbox: it does not start as root, and the pages are our own files.
    for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", "--disable-gpu"):
        options.add_argument(flag)
    options.binary_location = shutil.which("chromium") or shutil.which("google-chrome") or ""
    driver = webdriver.Chrome(options, webdriver.ChromeService(shutil.which("chromedriver")))
    try:
        yield driver
    finally:
        driver.quit()


def shoot(
    driver: Any,
    page: Path,
    target: Path,
    *,
    size: tuple[int, int],
    scheme: str,
    whole: bool = False,
    seek: bool = False,
) -> None:
    """Save a page as PNG. `whole`: all of it, not the first screen alone. `seek`: choose the fourth bar of the plan."""
    metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size[0] < 600}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    scheme_ = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", scheme_)
    driver.get(page.resolve().as_uri())
    if seek:
        driver.set_script_timeout(20)
        driver.execute_async_script(_SEEK)
    data = driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": whole, **_clip(driver, whole)})
    picture = cv2.imdecode(np.frombuffer(base64.b64decode(data["data"]), np.uint8), cv2.IMREAD_COLOR)
    # Six of eight bits a colour: a third smaller, and nobody sees it.
    cv2.imwrite(str(target), picture & 0xFC, [cv2.IMWRITE_PNG_COMPRESSION, 9])


_SEEK = """
const done = arguments[0], video = document.querySelector("video");
if (!video) { done(); return; }
const go = () => {
  video.addEventListener("seeked", () => setTimeout(done, 2500), {once: true});
  document.querySelectorAll(".bar")[3].dispatchEvent(new MouseEvent("click", {bubbles: true, cancelable: true}));
};
if (video.readyState > 1) go(); else video.addEventListener("loadeddata", go, {once: true});
"""


def _clip(driver: Any, whole: bool) -> dict[str, Any]:
    if not whole:
        return {}
    box = driver.execute_script("return [innerWidth, Math.min(document.documentElement.scrollHeight, 4200)]")
    return {"clip": {"x": 0, "y": 0, "width": box[0], "height": box[1], "scale": 1}}


def _with_video(folder: Path) -> Path:
    """The page of the episode with most robots, then with most bars, among those with a video."""
    pages = [page for page in sorted((folder / "episodes").glob("*.html")) if "<video" in page.read_text("utf-8")]
    if not pages:
        raise SystemExit(f"no episode in {folder} has a video: run with --video first, then `remac bench report`")
    texts = {page: page.read_text("utf-8") for page in pages}
    return max(texts, key=lambda page: ("2 robots" in texts[page], texts[page].count('class="bar')))


if __name__ == "__main__":
    main()
