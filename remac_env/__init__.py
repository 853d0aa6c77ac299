"""REMAC Kitchen: robot-kitchen tasks in real physics for planners of all kinds.

Examples:
    >>> import remac_env
    >>> env = remac_env.parallel_env("OpenMicrowavePnP", robots=2, backend="symbolic")
    >>> observations, infos = env.reset(seed=0)
"""

from remac_env.registry import env, generate, parallel_env, register_task, tasks

__version__ = "0.1.0"
__all__ = ["__version__", "env", "generate", "parallel_env", "register_task", "tasks"]
