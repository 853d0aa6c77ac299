"""check_text: plain text names objects and commands, and gives no states away."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from remac_env.testing.play import EnvMaker, expect, opened, play, random_legal

STATE_WORDS = re.compile(
    r"\b(closed|ajar|opened|open|shut|on|off|lit|running|cold|hot|holds?|holding|held|empty|full|loaded|free|occupied"
    r"|inside|into|under|behind|contains?|lies|stands?|standing|floor|dropped|at|washed|seasoned|dirty|clean"
    r"|not_\w+|door_\w+|hands_\w+|station_\w+|already_\w+)\b",
    re.IGNORECASE,
)
"""Words that tell a state. They may occur in names, in commands and in the goal sentence, and nowhere else."""


def check_text(env_fn: EnvMaker, *, seeds: Iterable[int] = (0, 1, 2), rounds: int = 8) -> None:
    """For environments with text="plain" and feedback="status": search `infos[robot]["text"]` for states.

    No word of STATE_WORDS stands outside the commands, the names of objects and the goal sentence; and the text is the
    same for all worlds of the same objects, but for whether the last subtask succeeded.

    Raises:
        ContractError: with the word, or the two texts that differ.
    """
    texts: dict[tuple[Any, ...], str] = {}
    worlds = set()
    with opened(env_fn) as env:
        for seed in seeds:
            for turn in play(env, seed, random_legal(seed, env.vocabulary), rounds=rounds):
                for name, info in turn.infos.items():
                    where = f"check_text, seed {seed}, round {turn.number}, {name}"
                    _check_names_told(info, where)
                    word = STATE_WORDS.search(_without_names(info))
                    expect(not word, f"{where}: the text tells a state: {word and word.group()!r} in\n{info['text']}")
                    status = info["outcome"].get("status")
                    names = (*info["scene"].robots, *info["scene"].fixtures, *info["scene"].objects)
                    known = texts.setdefault((name, names, info["goal"], status), info["text"])
                    expect(known == info["text"], f"{where}: two worlds, two texts:\n{known}\n---\n{info['text']}")
                    worlds.add(info["world"])
    expect(len(worlds) > 1, "check_text: the kitchen never changed, so that nothing was compared; add seeds or rounds")


def _check_names_told(info: Mapping[str, Any], where: str) -> None:
    text = info["text"]
    told = (*info["scene"].fixtures, *info["scene"].objects, *info["commands"], info["goal"])
    lacking = [name for name in told if name not in text]
    expect(not lacking, f"{where}: the text does not name {lacking}")


def _without_names(info: Mapping[str, Any]) -> str:
    """The text without the goal sentence, commands and names, the longest first, so that no command is cut in two."""
    text = info["text"]
    names = (info["goal"], *info["commands"], *info["scene"].fixtures, *info["scene"].objects)
    for name in sorted(names, key=len, reverse=True):
        text = re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", "", text)
    return text
