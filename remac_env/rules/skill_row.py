"""What a row of the skill table says, and what makes one valid.

A skill's requirements carry one of three marks: `refuse` - the controller declines and nothing changes; `attempt` -
physics decides, and the table says what comes of it; `advise` - nothing stops it, but it is wrong.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from remac_env.errors import OptionError, check_choice
from remac_env.rules.conditions import Condition
from remac_env.rules.facts import ObjectFacts, Rules
from remac_env.rules.outcomes import Outcome, Reason, failure
from remac_env.rules.predicates import PREDICATES
from remac_env.rules.scene import NAME_KINDS, NameKind
from remac_env.state import WorldState

Mark = Literal["refuse", "attempt", "advise"]
TargetKind = NameKind | Literal["none"]
Relevance = Literal["never", "nouns", "vessels"]

TARGETS: tuple[str, ...] = (*NAME_KINDS[1:], "none")
"""Kinds of targets: no skill is about a robot."""


@dataclass(frozen=True, slots=True)
class Requirement:
    """A pre-condition with its mark and the reason given when it is false. `drops`: what is held then falls."""

    mark: Mark
    condition: Condition
    reason: Reason
    drops: bool = False

    @property
    def outcome(self) -> Outcome:
        """How a subtask ends for which this is the first requirement that is false."""
        return _untrue(self.mark, self.reason, self.condition.predicate, self.condition.args)


@lru_cache(maxsize=4096)
def _untrue(mark: Mark, reason: Reason, predicate: str, args: tuple[str, ...]) -> Outcome:
    sentence = Condition(predicate, args).sentence
    return failure(reason, f"not true: {sentence}", refused=mark == "refuse")


Requires = Callable[[str, str], tuple[Requirement, ...]]
Effect = Callable[[Rules, WorldState, str, str], WorldState]
Achieves = Callable[[str, str, str | None], tuple[Condition, ...]]
Goes = Callable[[Rules, WorldState, str, str], str | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Skill:
    """One row.

    Attributes:
        name: what `Subtask.skill` and records call it.
        form: its command, with `{}` for the target where it has one.
        target: the kind of its target; "none" for a command without. "thing" is every noun, which need not list it
            among its `uses`.
        seconds: nominal duration in s, the mean seen in physics (benchmarks/skills.py).
        requires: (robot, target) -> what must hold before, in the order in which it is tested.
        achieves: (robot, target, what the robot held before) -> what holds after success.
        effect: (rules, world, robot, target) -> the world after success. None where nothing changes but where the robot
            stands.
        goes: (rules, world, robot, target) -> the station to which it moves the base, None where there is no way; None
            for a skill that leaves the base where it is.
        takes: its target is taken into the hand, so that two robots cannot do it at once.
        puts: what is held is put down at its target.
        lasting: its work need not be done twice in a row.
        still: nothing moves; a failing controller cannot slip.
        leaves: the mark that it leaves on its target; it matters only for goals that want that mark.
        tool: the objects of which one must be in hand; they matter wherever the skill does.
        relevant: for which nouns the search for shortest plans tries it: "never", those of the goal and around it
            ("nouns"), or spare vessels too, in which objects can be put out of the way ("vessels").
    """

    name: str
    form: str
    target: TargetKind
    seconds: float
    requires: Requires
    achieves: Achieves
    effect: Effect | None = None
    goes: Goes | None = None
    takes: bool = False
    puts: bool = False
    lasting: bool = False
    still: bool = False
    leaves: str | None = None
    tool: Callable[[ObjectFacts], bool] | None = None
    relevant: Relevance = "nouns"

    def __post_init__(self) -> None:
        """Refuse a row that lacks a part or contradicts itself."""
        where = f"skill {self.name!r}"
        check_choice(f"{where}: target", self.target, TARGETS)
        check_choice(f"{where}: relevant", self.relevant, Relevance.__args__)  # type: ignore[attr-defined]
        if self.form.count("{}") != (self.target != "none") or not self.form.startswith(self.name.split()[0]):
            raise OptionError(f"{where}: form {self.form!r} is not valid; valid: begins as the name, with one {{}} for "
                              "a target and none without")  # fmt: skip
        if not self.seconds >= 0.0:
            raise OptionError(f"{where}: seconds {self.seconds!r} is not valid; valid: 0 or more")
        if self.still and (self.goes or self.effect or self.leaves):
            raise OptionError(f"{where}: it is still, and goes, has an effect or leaves a mark; valid: one of the two")
        if not self.still and self.goes is None and self.effect is None:
            raise OptionError(f"{where}: nothing says what it changes; valid: an effect, goes, or still=True")
        target = "" if self.target == "none" else "target"
        said = [c for held in (None, "thing") for c in self.achieves("robot", target, held)]
        for stated in [requirement.condition for requirement in self.requires("robot", target)] + said:
            check_choice(f"{where}: predicate", stated.predicate, PREDICATES)
            if len(stated.args) != len(PREDICATES[stated.predicate].about):
                raise OptionError(f"{where}: {stated.predicate} of {stated.args}; valid: "
                                  f"{', '.join(PREDICATES[stated.predicate].about)}")  # fmt: skip

    @property
    def moves(self) -> bool:
        """Whether it moves the base."""
        return self.goes is not None

    def after(self, rules: Rules, world: WorldState, robot: str, target: str) -> WorldState:
        """The world after success."""
        moved = world if self.goes is None else world.with_robot(robot, station=self.goes(rules, world, robot, target))
        return moved if self.effect is None else self.effect(rules, moved, robot, target)
