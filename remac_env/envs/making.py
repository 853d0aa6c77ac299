"""Which environment a task is, by its options."""

from __future__ import annotations

from remac_env.envs.event_parallel import KitchenEventEnv
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.errors import OptionError
from remac_env.options import Options
from remac_env.tasks.spec import TaskSpec


def make_kitchen(spec: TaskSpec, options: Options) -> KitchenParallelEnv:
    """The environment in which every step is a round, or that in which it runs to the next decision point.

    Raises:
        OptionError: for a task in which things take their time, with rounds.
    """
    if spec.timed and options.clock != "events":
        raise OptionError(f"in {spec.name} things take their time, got clock={options.clock!r}; valid: clock='events'")
    return (KitchenEventEnv if options.clock == "events" else KitchenParallelEnv)(spec, options)
