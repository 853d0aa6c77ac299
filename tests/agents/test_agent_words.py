"""No task, object or fixture is named in the planners: what they know of a kitchen, the kitchen told them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

import remac_agents
import remac_env
from remac_agents.prompting.prompt import names
from remac_env.registry import tasks

SOURCES = sorted(Path(str(remac_agents.__file__)).parent.rglob("*.py"))
PROMPTS = sorted(Path(str(remac_agents.__file__)).parent.rglob("*.md"))
NOUNS = [
    noun["name"]
    for noun in tomllib.loads(Path(str(remac_env.__file__)).with_name("nouns.toml").read_text("utf-8"))[
        "noun"
    ]
]


def words_named(text: str) -> set[str]:
    return {
        word
        for word in [*NOUNS, *tasks()]
        if re.search(rf"(?<![a-z]){re.escape(word)}s?(?![a-z])", text, re.I)
    }


@pytest.mark.parametrize("path", [*SOURCES, *PROMPTS], ids=lambda path: path.name)
def test_no_noun_of_the_kitchens(path: Path) -> None:
    assert words_named(path.read_text("utf-8")) == set()


def test_the_search_finds_nouns() -> None:
    assert words_named("bring the Bowls_0 to OpenCabinetPnP") >= {"bowl", "OpenCabinetPnP"}
    assert len(SOURCES) > 20
    assert len(PROMPTS) == len(names())
    assert len(NOUNS) > 10


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.name)
def test_files_stay_small_and_import_only_what_is_public(path: Path) -> None:
    text = path.read_text("utf-8")
    assert len(text.splitlines()) < 300
    assert not re.search(
        r"remac_env\.(backends|kitchen|robots|rendering|parallel)|import mujoco|robots\[0\]", text
    )
