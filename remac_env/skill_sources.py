"""Where skills come from: the values of the option `skills`, as one text."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from remac_env.errors import OptionError, check_choice
from remac_env.option_rows import Values
from remac_env.quoting import quoted
from remac_env.rules.skills import SKILLS

SCRIPTED, LEARNED = "scripted", "learned"
VALID = "scripted, learned, a folder of weights, or SKILL=one of these with commas between them"


@dataclass(frozen=True)
class Sources:
    """Where each skill comes from: `scripted`, `learned` (those that the package has) or a folder of weights.

    Attributes:
        named: skill -> source, of the skills that were named.
        others: the source of all others.
    """

    named: Mapping[str, str]
    others: str = SCRIPTED

    def of(self, skill: str) -> str:
        """The source of a skill."""
        return self.named.get(skill, self.others)

    @staticmethod
    def read(text: str) -> Sources:
        """The sources that a text of the option says, which SkillValues has checked."""
        parts = [part.strip() for part in text.split(",")]
        named = dict(part.split("=", 1) for part in parts if "=" in part)
        others = [part for part in parts if "=" not in part]
        return Sources(named, others[0] if others else SCRIPTED)


class SkillValues(Values):
    """The values of the option `skills`; a mapping by skill becomes a text too."""

    def check(self, name: str, value: Any) -> str:
        """See Values."""
        if isinstance(value, Mapping):
            value = ",".join(f"{skill}={_text(name, source)}" for skill, source in value.items()) or SCRIPTED
        parts = [part.strip() for part in _text(name, value).split(",")]
        skills = [part.partition("=")[0].strip() for part in parts if "=" in part]
        for skill in skills:
            check_choice(f"skill of {name}", skill, [row.name for row in SKILLS.values() if not row.still])
        sources = [part.rpartition("=")[2].strip() for part in parts]
        if not all(sources) or len(parts) - len(skills) > 1 or len(set(skills)) < len(skills):
            raise OptionError(f"{name} {quoted(value)} is not valid; valid: {VALID}")
        return ",".join("=".join(end.strip() for end in part.split("=", 1)) for part in parts)

    def read(self, text: Any) -> str:
        """See Values."""
        return self.check("", text)


def _text(name: str, value: Any) -> str:
    if not isinstance(value, str | PurePath):
        raise OptionError(f"{name} {quoted(value)} is not valid; valid: {VALID}")
    return str(value)
