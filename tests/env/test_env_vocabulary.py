"""Tokens never move; commands are read forgivingly but exactly."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import remac_env
from remac_env.errors import UnknownNameError
from remac_env.rules.skills import SKILLS
from remac_env.vocabulary import built_in
from remac_env.words import normalise

FROZEN = json.loads((Path(__file__).resolve().parents[1] / "data" / "vocabulary_1.json").read_text("utf-8"))


def test_tokens_are_those_of_version_1() -> None:
    """Records and policies speak in these numbers: what is new comes behind them, and raises the version."""
    words = built_in()
    assert [words.decode(token) for token in range(211)] == FROZEN["commands"]
    assert words.version == FROZEN["version"] if len(words) == 211 else words.version > FROZEN["version"]


def test_the_first_tokens() -> None:
    assert [built_in().decode(token) for token in (0, 1, 2)] == ["wait", "done", "navigate aside"]


def test_there_and_back() -> None:
    words = built_in()
    for token, text in enumerate(FROZEN["commands"]):
        assert words.encode(text) == token
        assert words.parse(text) == words.subtask(token)
        assert words.subtask(token).text == text
    assert {words.subtask(token).skill for token in range(len(words))} == set(SKILLS)


@pytest.mark.parametrize(
    "text",
    [
        "pick up vegetable",
        "Pick up vegetable.",
        "  pick_up   VEGETABLE ",
        "`pick up vegetable`",
        '"pick up\tvegetable"',
    ],
)
def test_forgiving(text: str) -> None:
    assert normalise(text) == "pick up vegetable"
    assert built_in().encode(text) == FROZEN["commands"].index("pick up vegetable")


@pytest.mark.parametrize(
    "text",
    ["", " ", "pick up", "pick up the vegetable", "pick up vegetable and wait", "pickup vegetable", "navigate to",
     "open sink door", "turn on sink", "place to vegetable", "pick up stove", "__import__('os')", "wait; done", "\x00",
     "navigate to aside", "pick up vegetable\n\nwait"],
)  # fmt: skip
def test_but_exact(text: str) -> None:
    assert built_in().parse(text) is None
    with pytest.raises(UnknownNameError) as error:
        built_in().encode(text)
    assert repr(text) in str(error.value)


def test_a_slip_of_the_pen_gets_the_nearest_commands() -> None:
    with pytest.raises(UnknownNameError, match="did you mean .*'open cabinet door'"):
        built_in().encode("open cabinett door")


@pytest.mark.parametrize("token", [-1, len(built_in()), 10**9])
def test_no_such_token(token: int) -> None:
    with pytest.raises(UnknownNameError, match=rf"valid: 0\.\.{len(built_in()) - 1}"):
        built_in().decode(token)


@pytest.mark.parametrize("task", remac_env.tasks())
def test_the_mask_marks_what_is_in_the_kitchen(task: str) -> None:
    env = remac_env.parallel_env(task, backend="symbolic", starts="mixed")
    for seed in range(5):
        observations, infos = env.reset(seed=seed)
        scene = env.start.scene
        for name, seen in observations.items():
            mask = seen["action_mask"]
            assert mask.dtype == np.int8 and mask.shape == (len(built_in()),)
            told = {env.vocabulary.decode(int(token)): int(token) for token in np.flatnonzero(mask)}
            assert told == infos[name]["commands"]
            nouns = {env.vocabulary.subtask(token).target for token in told.values()} - {""}
            assert nouns == {*scene.fixtures, *scene.objects}
