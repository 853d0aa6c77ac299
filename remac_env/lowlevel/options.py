"""The options of a skill's environment, one row each, checked once before anything is built."""

from __future__ import annotations

from dataclasses import dataclass

from remac_env.option_rows import Choice, check_rows, option, same
from remac_env.options import Options
from remac_env.rules.skill_row import Skill
from remac_env.values import python_fields
from remac_env.vocabulary import built_in

CONTROLS = ("joints", "ee")
REWARDS = ("sparse", "progress")


def targets(skill: Skill) -> tuple[str, ...]:
    """What commands with this skill may name."""
    vocabulary = built_in()
    found = (vocabulary.subtask(token) for token in range(len(vocabulary)))
    return tuple(subtask.target for subtask in found if subtask.skill == skill.name)


@dataclass(frozen=True)
class SkillOptions:
    """Keywords of the environments `RemacSkill-<Skill>-v0`, beside the skill itself."""

    target: str | None = option(None, "What the skill is about; by default the seed picks.")
    style: str | None = same(Options, "style")
    layout: str | None = same(Options, "layout")
    body: str = same(Options, "body")
    obs: str = same(Options, "obs")
    control: str = option(
        "joints", "joints (changes of the commanded joints) or ee (of the hand's commanded pose, and of the base).",
        Choice(CONTROLS),
    )  # fmt: skip
    reward: str = option(
        "sparse", "sparse (1 on success) or progress (by how much nearer the skill is to its end; 1 in all).",
        Choice(REWARDS),
    )  # fmt: skip
    image_size: int = same(Options, "image_size")
    render_mode: str | None = same(Options, "render_mode")

    def __post_init__(self) -> None:
        """Refuse values that are not offered.

        Raises:
            UnknownNameError: for a name that is not among the valid ones.
            OptionError: for a number outside its range.
        """
        python_fields(self)
        check_rows(self)
