"""What the skills are called in ids of environments. Importing this loads nothing heavy."""

from __future__ import annotations

from remac_env.errors import check_choice
from remac_env.rules.skill_row import Skill
from remac_env.rules.skills import SKILLS


def camel(name: str) -> str:
    """A skill's name as it stands in ids: "pick up" is PickUp."""
    return "".join(word.capitalize() for word in name.split())


def skills() -> dict[str, Skill]:
    """The skills that have an environment of their own, by their names in ids."""
    return {camel(skill.name): skill for skill in SKILLS.values() if skill.target != "none"}


def skill_named(name: str) -> Skill:
    """The skill of that name in ids; UnknownNameError lists the names."""
    check_choice("skill", name, skills())
    return skills()[name]
