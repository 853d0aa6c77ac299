"""What a robot is told to do in a round: a skill of the table with its target."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from remac_env.rules.conditions import Condition
from remac_env.rules.facts import Rules
from remac_env.rules.skill_row import Requirement, Skill
from remac_env.rules.skills import SKILLS
from remac_env.state import WorldState


@dataclass(frozen=True, slots=True)
class Subtask:
    """A skill with its target ("" where it has none)."""

    skill: str
    target: str = ""

    @property
    def row(self) -> Skill:
        """The skill's row of the table."""
        return SKILLS[self.skill]

    @property
    def text(self) -> str:
        """The command, as "pick up vegetable"."""
        return _text(self.skill, self.target)

    @property
    def moves(self) -> bool:
        """Whether it moves the robot's base."""
        return self.row.moves

    def requirements(self, robot: str) -> tuple[Requirement, ...]:
        """What must hold before `robot` runs it, in the order in which it is tested."""
        return _requirements(self.skill, self.target, robot)

    def achieves(self, robot: str, held: str | None) -> tuple[Condition, ...]:
        """What holds after success; `held` is what the robot held before."""
        return self.row.achieves(robot, self.target, held)

    def effect(self, rules: Rules, world: WorldState, robot: str) -> WorldState:
        """The world after success."""
        return self.row.after(rules, world, robot, self.target)


@lru_cache(maxsize=4096)
def _text(skill: str, target: str) -> str:
    return SKILLS[skill].form.format(target)


@lru_cache(maxsize=4096)
def _requirements(skill: str, target: str, robot: str) -> tuple[Requirement, ...]:
    return SKILLS[skill].requires(robot, target)


WAIT = Subtask("wait")
DONE = Subtask("done")
STEP_ASIDE = Subtask("navigate aside")
