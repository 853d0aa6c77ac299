"""What robots of benchmarks/twin.py prepare, so that every pair of a skill and a reason comes about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.oracle import search_plan
from remac_env.rules.facts import Rules
from remac_env.rules.rounds import transition
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState

Stratum = tuple[str, str]
"""A skill and the reason that the table predicts, "success" where there is none."""

STRATA: tuple[Stratum, ...] = tuple(
    (skill.name, reason)
    for skill in SKILLS.values()
    for reason in dict.fromkeys(r.reason for r in skill.requires("robot", "target") if r.mark != "advise")
    if reason not in ("not_at_station", "station_occupied")
)
"""The pairs that need a preparation; robots that are elsewhere, and claims, come about by themselves."""

_FAR, _STATES = 8, 1500  # rounds and states up to which a preparation is searched for


class Agenda:
    """What one robot prepares: pairs of skill and reason in an order of its own, each until it has come about.

    Seasoning comes first where there is any, as few kitchens have it.
    """

    def __init__(self, chance: np.random.Generator, scene: Rules) -> None:
        order = [STRATA[k] for k in chance.permutation(len(STRATA))]
        seasons = any(facts.seasons for facts in scene.objects.values())
        first = [stratum for stratum in order if stratum[0] == "season" and seasons]
        self._wanted = first + [stratum for stratum in order if stratum[0] != "season"]

    def next(self, env: KitchenParallelEnv, name: str, commands: Sequence[Subtask]) -> Subtask | None:
        """The next command towards the first pair that can be reached, or None; a pair is left once it is tried."""
        scene = replace(env.start.scene, robots=(name,))
        while self._wanted:
            skill, reason = self._wanted[0]
            ripe = [subtask for subtask in commands if subtask.skill == skill]
            plan = search_plan(
                scene,
                env.world,
                lambda world, ripe=ripe, reason=reason: any(foretell(scene, world, name, s) == reason for s in ripe),
                commands=[subtask for subtask in commands if not subtask.row.still],
                max_rounds=_FAR,
                max_states=_STATES,
            )
            if plan is not None and plan.rounds:
                return plan.rounds[0][name]
            self._wanted.pop(0)
            if plan is not None:
                return next(s for s in ripe if foretell(scene, env.world, name, s) == reason)
        return None


def foretell(scene: Rules, world: WorldState, robot: str, subtask: Subtask) -> str:
    """What the table predicts for one robot's command while the others stand still: a reason or "success"."""
    _, outcomes = transition(scene, world, {robot: subtask})
    return outcomes[robot].reason or "success"
