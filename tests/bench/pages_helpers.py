"""What the tests of pages share: a folder with real episodes, hostile records, and a reader of HTML."""

from __future__ import annotations

import base64
import hashlib
import re
from dataclasses import dataclass, field
from functools import cached_property
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from bench_helpers import jobs, record
from remac_bench.playing.worker import Work, play_job
from remac_bench.records import CheckEntry, ErrorEntry, ExchangeEntry, OutcomeEntry, Record, UsageEntry, VideoEntry
from remac_bench.store import Store

EVIL = (
    '</bdi></script><script>document.title="owned"</script><img src=x onerror=alert(1)>'
    "\"'\x1b[31m\u202eabc\x00\u2028{{7*7}}"
)
"""Markup, quotes, terminal and bidi controls, a null byte, and a template's own marks."""

VOID = {"meta", "input", "img", "link", "br", "hr"}


def real_run(folder: Path, *, video: str = "none") -> Path:
    """Two methods on two tasks, symbolic."""
    store = Store(folder)
    for job in jobs(methods="CC,REMAC", tasks="OpenCabinetPnP,HeatOnStove", seeds=range(1)):
        store.append(play_job(Work(job=job, folder=str(folder), video=video, optimum=True)))  # type: ignore[arg-type]
    return folder


def hostile(**changes: Any) -> Record:
    """A record whose every text was written by somebody who means ill."""
    world = {"robots": {EVIL: {"holding": EVIL}}, "objects": [EVIL], EVIL: None}
    facts: dict[str, Any] = {
        "job": "../../" + EVIL,
        "agent": EVIL,
        "method": EVIL,
        "task": EVIL,
        "style": EVIL,
        "layout": EVIL,
        "starts": EVIL,
        "goal": EVIL,
        "end": EVIL,
        "success": False,
        "rounds": 1,
        "outcomes": [{EVIL: OutcomeEntry(subtask=EVIL, status=EVIL, reason=EVIL, detail=EVIL, seconds=3.0)}],
        "worlds": [world, {**world, "robots": {EVIL: {"holding": None}}}],
        "pre_checks": [
            CheckEntry(round=0, robot=EVIL, subtask=EVIL, condition=EVIL, verdict=True, truth=False, reason=EVIL),
            CheckEntry(round=0, robot=EVIL, subtask=EVIL, condition=EVIL, verdict=None, unmatched=True),
        ],
        "initial_plan": {EVIL: [EVIL]},
        "final_plan": {EVIL: [EVIL]},
        "reflections": [EVIL, EVIL * 100],
        "planner_errors": [EVIL],
        "truth_readers": [EVIL],
        "exchanges": [
            ExchangeEntry(
                round=0, role=EVIL, label=EVIL, messages=[(EVIL, EVIL)], reply=EVIL, error=EVIL, pictures=[EVIL]
            )
        ],
        "video": VideoEntry(path="https://example.org/x.webm"),
        "error": ErrorEntry(kind="agent", type=EVIL, message=EVIL, where=[EVIL]),
        "options": {"kitchen": {EVIL: EVIL}},
        "suite": EVIL,
        "suite_version": 1,
    }
    return record(**{**facts, **changes})


def spoken(folder: Path, **changes: Any) -> Record:
    """A record with an exchange that showed a picture, of which the file is written."""
    digest = "a1b2c3"
    (folder / "pictures").mkdir(exist_ok=True)
    cv2.imwrite(str(folder / "pictures" / f"{digest}.png"), np.full((32, 32, 3), 90, np.uint8))
    facts: dict[str, Any] = {
        "job": "spoken",
        "agent": "CC (checker=some:model)",
        "rounds": 1,
        "outcomes": [{"robot_0": OutcomeEntry(subtask="pick up pan", status="success", seconds=8.0)}],
        "exchanges": [
            ExchangeEntry(round=0, role="checker", messages=[("user", "Is it so?")], reply="Yes.", tokens=9,
                          money=0.25, pictures=[digest, "f00"])
        ],
        "usage": UsageEntry(calls=1, prompt_tokens=7, completion_tokens=2, money=0.25),
    }
    return record(**{**facts, **changes})


def mixed() -> list[Record]:
    """Records of three agents, two tasks, three styles and two layouts, won and lost by a rule that mixes them."""
    agents = {"CC": 1, "BASE": 1, "REMAC": 2}
    kitchen = {"kitchen": {"max_rounds": 10}}
    found = []
    for task in ("HeatOnStove", "OpenCabinetPnP"):
        for seed in range(18):
            for rank, (agent, robots) in enumerate(agents.items()):
                won = (seed * 7 + rank * 5 + len(task)) % (3 + 2 * rank) != 0 if agent != "BASE" else seed % 6 == 0
                length = 4 + (seed + rank) % 5
                found.append(
                    record(
                        job=f"{agent}{task}{seed}", agent=agent, method=agent, robots=robots, task=task, seed=seed,
                        style=("coastal", "rustic", "modern_1")[seed % 3],
                        layout=("one_wall_small", "l_shaped_large")[seed // 3 % 2], success=won,
                        end="success" if won else ("lost", "done", "truncated")[seed % 3], rounds=length + 1,
                        sim_seconds=8.1 * length, final_plan_length=length, initial_plan_length=length - 1,
                        subtasks_done=length if won else seed % length, problem=f"p{seed // 2}", options=kitchen,
                        error=ErrorEntry(kind="agent", type="KeyError", message="x") if not won and seed == 5 else None,
                    )  # fmt: skip
                )
    return found


@dataclass
class Element:
    """A start tag with the text up to its end tag."""

    tag: str
    attributes: dict[str, str]
    pieces: list[str] = field(default_factory=list)
    inside: list[Element] = field(default_factory=list)

    @cached_property
    def text(self) -> str:
        """All text inside; to be read once the page is."""
        return "".join(self.pieces)

    def all(self, tag: str, **attributes: str) -> list[Element]:
        """The elements with this tag and these attributes (`class_` for class: one of its words) inside, in order."""
        found = []
        for each in self.inside:
            if each.tag == tag and all(_has(each, name.rstrip("_"), value) for name, value in attributes.items()):
                found.append(each)
            found += each.all(tag, **attributes)
        return found

    def walk(self) -> list[Element]:
        """Every element inside."""
        return [part for each in self.inside for part in (each, *each.walk())]


def _has(element: Element, name: str, value: str) -> bool:
    told = element.attributes.get(name, "")
    return value in told.split() if name == "class" else told == value


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.root = Element("", {})
        self.open = [self.root]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        made = Element(tag, {name: value or "" for name, value in attrs})
        self.open[-1].inside.append(made)
        if tag not in VOID:
            self.open.append(made)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open[-1].inside.append(Element(tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        if self.open[-1].tag == tag:
            self.open.pop()

    def handle_data(self, data: str) -> None:
        for each in self.open:
            each.pieces.append(data)


def parse(html: str) -> Element:
    """The tree of a page."""
    reader = _Reader()
    reader.feed(html)
    reader.close()
    return reader.root


def alien(html: str) -> list[str]:
    """What a page of ours never has: foreign scripts, handlers, styles, addresses, characters that are not seen."""
    page = parse(html)
    policy = next(each.attributes["content"] for each in page.all("meta") if "http-equiv" in each.attributes)
    found = [
        f"{each.tag} that the policy does not know"
        for each in (*page.all("script"), *page.all("style"))
        if base64.b64encode(hashlib.sha256(each.text.encode()).digest()).decode() not in policy
    ]
    for each in page.walk():
        for name, value in each.attributes.items():
            if name.startswith("on") or name == "style":
                found.append(f"{name} of {each.tag}")
            if name in ("href", "src") and not re.fullmatch(r"(\.\./|[a-z]+/)?[A-Za-z0-9_./-]*(#[a-z0-9-]+)?", value):
                found.append(f"{name} {value!r}")
        if each.tag in ("iframe", "object", "embed", "link", "base"):
            found.append(each.tag)
    seen = {f"U+{ord(c):04X}" for c in html if not c.isprintable() and c not in "\n\t"}
    return found + sorted(seen)
