"""Making environments for the tests of the robosuite room. Imports robosuite only when it is called."""

from __future__ import annotations

from typing import Any

QUICK = {"has_renderer": False, "has_offscreen_renderer": False, "use_camera_obs": False, "looks": False}


def make(task: str, *, robots: int = 2, **options: Any) -> Any:
    """A task with robots that fit, and without pictures unless asked for."""
    import robosuite

    from remac_env.integrations.robosuite import environment_name

    return robosuite.make(environment_name(task), robots=["PandaOmron"] * robots, **{**QUICK, **options})
