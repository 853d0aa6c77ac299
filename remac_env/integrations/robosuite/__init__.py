"""The tasks as robosuite environments: our kitchens, starts and goals, robosuite's robots and controllers.

Importing this registers `RemacKitchen<Task>` for every task, those from outside too that are registered by then:
`robosuite.make("RemacKitchenOpenCabinetPnP", robots=["PandaOmron", "PandaOmron"], seed=7)`. `RemacKitchen` documents
the options; docs/robosuite.md says how to install robosuite, of which `import remac_env` loads nothing.
"""

from __future__ import annotations

SUPPORTED = "1.5."
"""How the versions of robosuite begin that are known to work; 1.4 has other robots, controllers and wrappers."""

_INSTALL = "install it as docs/robosuite.md says (in a checkout: `make robosuite`)"

try:
    import robosuite
except ImportError as error:
    raise ImportError(f"robosuite cannot be imported ({error}): {_INSTALL}") from error
if not robosuite.__version__.startswith(SUPPORTED):
    raise ImportError(f"robosuite {robosuite.__version__} is installed, {SUPPORTED}x is needed: {_INSTALL}")

from remac_env.integrations.robosuite.env import RemacKitchen  # noqa: E402
from remac_env.integrations.robosuite.registry import environment_name, register_tasks  # noqa: E402

register_tasks()

__all__ = ["RemacKitchen", "environment_name", "register_tasks"]
