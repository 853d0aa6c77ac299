"""The learned skills that an episode uses: those of the package, and those of folders."""

from __future__ import annotations

import os
from functools import lru_cache, partial
from pathlib import Path

from remac_env.backends.physics.controllers.base import MakeController
from remac_env.backends.physics.controllers.learned.controller import Learned
from remac_env.backends.physics.controllers.learned.weights import SEVERAL, SUFFIX, Weights, read_weights
from remac_env.errors import OptionError
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.rules.skills import SKILLS
from remac_env.skill_sources import LEARNED, SCRIPTED, VALID, Sources

SHIPPED = Path(__file__).with_name("shipped")
"""The weights that come with the package."""


def file_name(skill: str) -> str:
    """What the file of a skill's weights is called in its folder."""
    return "".join(word.capitalize() for word in skill.split()) + SUFFIX


def learned_skills(text: str, robots: int, body: str = STANDARD) -> dict[str, Weights]:
    """The weights of each skill that is learned by a value of the option `skills`; all others are scripted.

    With several robots drives stay scripted, as learned ones know of no other robot.

    Raises:
        OptionError: for weights that cannot be used, a folder that is not there or has none, a skill that was named
            and has no weights, a learned drive of several robots that was named, or robots of another body.
    """
    sources, found = Sources.read(text), dict[str, Weights]()
    for skill in sources.named:
        if sources.of(skill) != SCRIPTED and robots > 1 and SKILLS[skill].moves:
            raise OptionError(f"skills: {skill!r} is learned with one robot only; valid: robots=1, or {skill}=scripted")
    for skill, row in SKILLS.items():
        source = sources.of(skill)
        if source == SCRIPTED or row.still or (row.moves and robots > 1):
            continue
        known = weights_of(_folder(source), skill, STANDARD if source == LEARNED else body)
        if known is not None and source == LEARNED and bodies.get(body).fingerprint != bodies.get().fingerprint:
            given = f"skills: {text!r} was learnt with body {STANDARD!r}, got body={body!r}"
            raise OptionError(f"{given}; valid: {SCRIPTED}, or weights of your own: remac learn")
        if known is not None:
            found[skill] = known
        elif skill in sources.named:
            raise OptionError(f"skills: {source!r} has no weights for {skill!r}; valid: {_kept(_folder(source), body)}")
    return found


def weights_of(folder: Path, skill: str, body: str = STANDARD) -> Weights | None:
    """The weights that a folder has for a skill of robots with this body: its own, or those of several skills.

    Raises:
        OptionError: for weights that cannot be used.
    """
    for name in (skill, SEVERAL):
        path = folder / file_name(name)
        if os.path.lexists(path) and skill in (known := _read(path, _changed(path), body)).about.known:
            return known
    return None


def _changed(path: Path) -> int:
    """When a file was changed last, ns; 0 for a link that leads nowhere, which is refused when it is read."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


def makers(weights: dict[str, Weights], body: str = STANDARD) -> dict[str, MakeController]:
    """What makes the controllers of learned skills, of robots with this body."""
    return {skill: partial(Learned, known, body) for skill, known in weights.items()}


def _folder(source: str) -> Path:
    folder = SHIPPED if source == LEARNED else Path(source)
    if source != LEARNED and not list(folder.glob(f"*{SUFFIX}")):
        raise OptionError(f"skills: {source!r} is no folder with weights in it; valid: {VALID}")
    return folder


def _kept(folder: Path, body: str) -> str:
    known = [skill for skill in SKILLS if weights_of(folder, skill, body) is not None]
    return ", ".join([*known, "or scripted"])


@lru_cache(maxsize=64)
def _read(path: Path, changed: int, body: str) -> Weights:
    """Weights are shared between episodes; a file that has changed is read again."""
    return read_weights(path, body)
