"""docs/architecture.md says which room imports which, and which way tokens and chat requests go: it is held to that."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Callable, Sequence
from functools import lru_cache
from pathlib import Path
from types import FrameType

import pytest
from chaos_server import ChaosServer, says

import remac_agents
import remac_env

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "architecture.md"
FOLDERS = {"remac_bench": ROOT / "benchmarks" / "remac_bench"}
FOLDERS |= {name: ROOT / name for name in ("remac_agents", "remac_env")}


@lru_cache(maxsize=3)
def parts(package: str) -> dict[str, set[str]]:
    """A package's files and folders, and what each imports, in functions and for types too."""
    folder, found = FOLDERS[package], dict[str, set[str]]()
    for path in sorted(folder.rglob("*.py")):
        imported = found.setdefault(path.relative_to(folder).parts[0].removesuffix(".py"), set())
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                imported |= {f"{node.module}.{alias.name}" for alias in node.names}
            elif isinstance(node, ast.Import):
                imported |= {alias.name for alias in node.names}
    return found


def section(page: str, name: str) -> list[str]:
    """The lines under one of the page's headings."""
    return page.partition(f"\n## {name}\n")[2].partition("\n## ")[0].splitlines()


def rows(page: str, package: str) -> dict[str, tuple[list[str], set[str]]]:
    """Room -> its files and folders, and the rooms that it imports, of a package's table."""
    table = [line.strip("|").split("|") for line in section(page, package) if line[:1] == "|"]
    return {
        room.strip(): (re.findall(r"`(\w+)/?`", files), set(re.findall(r"\w+", goals)))
        for room, files, goals in table[2:]
    }


def lines(page: str) -> dict[str, int]:
    """Room -> its line in the picture, from the top."""
    picture = page.partition("```text\n")[2].partition("```")[0].splitlines()
    return {room: number for number, line in enumerate(picture) for room in re.findall(r"\[(\w+)\]", line)}


def faults(page: str) -> list[str]:
    """Everything in which the page and the code differ."""
    found = []
    height = lines(page)
    for package in FOLDERS:
        table, code = rows(page, package), parts(package)
        home = {part: room for room, (files, _) in table.items() for part in files}
        lost = [part for part in code if part not in home]
        found += [f"{package}: {part!r} is in no room; say in the table where it belongs" for part in lost]
        found += [f"{package}: {part!r} of {home[part]} is not there" for part in home if part not in code]
        real: dict[str, set[str]] = {room: set() for room in table}
        for part, names in code.items():
            for name in names:
                start, _, rest = name.partition(".")
                goal = home.get(rest.partition(".")[0], home.get("__init__", ""))
                if start == package and part in home and goal != home[part]:
                    real[home[part]].add(goal)
        for room, (_, told) in table.items():
            found += [f"{package}: {room} imports {goal}, which its row does not say" for goal in real[room] - told]
            found += [f"{package}: {room} does not import {goal}, as its row says" for goal in told - real[room]]
            below = height.get(room, len(height))
            above = [goal for goal in told if height.get(goal, -1) <= below]
            found += [f"{package}: {goal} does not stand below {room} in the picture" for goal in above]
    return found


def test_the_page_says_which_room_imports_which() -> None:
    assert not faults(PAGE.read_text("utf-8"))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("| running | `running/` | memory, plan,", "| running | `running/` | plan,", "running imports memory"),
        ("| llm | `llm/` | text |", "| llm | `llm/` | roles, text |", "llm does not import roles"),
        ("| report | `report` |", "| report | |", "'report' is in no room"),
        ("| plan | `plan` |", "| plan | `plan` `plans` |", "'plans' of plan is not there"),
        ("  [text] ", "  [elsewhere] ", "text does not stand below plan"),
    ],
)
def test_a_page_that_is_not_true_is_found_out(old: str, new: str, told: str) -> None:
    page = PAGE.read_text("utf-8")
    assert old in page
    assert any(told in fault for fault in faults(page.replace(old, new)))


def way(name: str) -> list[str]:
    """The files of one of the page's numbered lists, in order."""
    steps = [line for line in section(PAGE.read_text("utf-8"), name) if line[:1].isdigit()]
    return [file for step in steps for file in re.findall(r"`(remac_\w+/[\w/]+\.py)`", step)]


def entered(play: Callable[[], object]) -> list[str]:
    """The files whose functions are called meanwhile, in the order in which they first are."""
    found: dict[str, None] = {}

    def note(frame: FrameType, event: str, _: object) -> None:
        module = str(frame.f_globals.get("__name__"))
        if event == "call" and module.startswith(("remac_env", "remac_agents")):
            found.setdefault(f"{module.replace('.', '/')}.py")

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        play()
    finally:
        sys.setprofile(before)
    return list(found)


def in_this_order(told: Sequence[str], real: Sequence[str]) -> bool:
    """Whether all that is told is there, in the order in which it is told."""
    rest = iter(real)
    return len(told) > 5 and all(file in rest for file in told)


@pytest.mark.long
def test_a_token_goes_the_way_that_the_page_tells() -> None:
    env = remac_env.parallel_env("OpenMicrowavePnP", backend="symbolic")
    agent = remac_agents.make("CC")
    obs, infos = env.reset(seed=3)
    agent.reset(obs, infos)
    obs, _, _, _, infos = env.step(agent.act(obs, infos))
    real = entered(lambda: env.step(agent.act(obs, infos)))
    assert in_this_order(way("The way of a token"), real), real
    assert not in_this_order(way("The way of a token")[::-1], real)


@pytest.mark.long
def test_a_chat_request_goes_the_way_that_the_page_tells() -> None:
    answer = says("Plan: [navigate to microwave]")
    with ChaosServer([answer]) as server:
        env = remac_env.parallel_env("OpenMicrowavePnP", backend="symbolic")
        agent = remac_agents.make("BASE", planner="custom:scripted", base_url=server.url)
        told = env.reset(seed=3)
        agent.reset(*told)
        real = entered(lambda: agent.act(*told))
    assert in_this_order(way("The way of a chat request"), real), real
