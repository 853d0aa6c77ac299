"""The two backends of one table: symbolic (pure Python) and physics (MuJoCo)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from remac_env.backends.base import Backend
from remac_env.backends.symbolic import SymbolicBackend
from remac_env.rules.skills import SKILLS
from remac_env.simulator import load_mujoco
from remac_env.skill_sources import SCRIPTED

if TYPE_CHECKING:
    from remac_env.kitchen.worlds import TaskWorlds
    from remac_env.options import Options


def make_backend(options: Options, worlds: TaskWorlds) -> Backend:
    """The backend that the options name; physics loads MuJoCo."""
    if options.backend == "symbolic":
        return SymbolicBackend(failure_rate=options.failure_rate)
    load_mujoco()
    from remac_env.backends.physics.backend import PhysicsBackend
    from remac_env.backends.physics.controllers.learned.library import learned_skills, makers

    learned = learned_skills(options.skills, options.robots, options.body)
    return PhysicsBackend(worlds, controllers=makers(learned, options.body))


def told_skills(options: Options) -> dict[str, str]:
    """Skill -> "scripted", or the digest of its weights (sha256); empty where all of them are scripted.

    Raises:
        OptionError: for weights that are not there or cannot be used.
    """
    if options.skills == SCRIPTED:
        return {}
    load_mujoco()
    from remac_env.backends.physics.controllers.learned.library import learned_skills

    learned = learned_skills(options.skills, options.robots, options.body)
    moving = [skill for skill, row in SKILLS.items() if not row.still]
    return {skill: learned[skill].sha256 if skill in learned else SCRIPTED for skill in moving}


def told_cases(options: Options) -> dict[str, list[str]]:
    """Skill -> the cases in which it moves by its weights, and outside of which it is scripted; see `case_of`.

    Skills that are scripted, or learned whatever the case, are left out.
    """
    if options.skills == SCRIPTED:
        return {}
    from remac_env.backends.physics.controllers.learned.library import learned_skills

    found = learned_skills(options.skills, options.robots, options.body)
    learned = {skill: known.about for skill, known in found.items()}
    return {skill: list(about.played(skill)) for skill, about in learned.items() if about.shown(skill)}
