"""Which environment a task is, by its options."""

from __future__ import annotations

from remac_env.event_parallel import KitchenEventEnv
from remac_env.options import Options
from remac_env.parallel import KitchenParallelEnv
from remac_env.tasks.spec import TaskSpec


def make_kitchen(spec: TaskSpec, options: Options) -> KitchenParallelEnv:
    """The environment in which every step is a round, or that in which it runs to the next decision point."""
    return (KitchenEventEnv if options.clock == "events" else KitchenParallelEnv)(spec, options)
