"""Checks of the environment's contract that anyone can run on a task or environment of their own.

Examples:
    >>> from remac_env.testing import check_task
    >>> check_task("OpenMicrowavePnP", seeds=(0,), rounds=4)

Each check takes a function that makes an environment (a KitchenParallelEnv or a wrapper of one), because several
fresh ones are needed. All raise ContractError, an AssertionError, with the seed and the round at fault. They go where
the tests of PettingZoo and Gymnasium do not: those never look whether an observation lies in its space, and their seed
test compares so little that a random environment passes.
"""

from remac_env.testing.actions import check_actions, check_masks
from remac_env.testing.changes import check_changes
from remac_env.testing.commands import check_commands
from remac_env.testing.determinism import check_determinism
from remac_env.testing.events import check_events
from remac_env.testing.interrupts import check_interrupts
from remac_env.testing.lifecycle import check_lifecycle
from remac_env.testing.names import check_names, swap_robots
from remac_env.testing.play import ContractError, EnvMaker
from remac_env.testing.spaces import check_spaces
from remac_env.testing.task import check_task
from remac_env.testing.text import check_text
from remac_env.testing.world import check_world

__all__ = [
    "ContractError",
    "EnvMaker",
    "check_actions",
    "check_changes",
    "check_commands",
    "check_determinism",
    "check_events",
    "check_interrupts",
    "check_lifecycle",
    "check_masks",
    "check_names",
    "check_spaces",
    "check_task",
    "check_text",
    "check_world",
    "swap_robots",
]
