"""The bodies there are, by name; others are registered by whoever has one."""

from __future__ import annotations

from remac_env.errors import OptionError, check_choice
from remac_env.robots.body import Body
from remac_env.robots.panda.body import Panda

STANDARD = "panda"
"""The body of robots for which no other is asked: the one that built-in fixtures are certified for."""

_BODIES: dict[str, Body] = {STANDARD: Panda()}


def names() -> tuple[str, ...]:
    """All bodies, the standard one first."""
    return tuple(_BODIES)


def get(name: str = STANDARD) -> Body:
    """A body by name; raises UnknownNameError."""
    check_choice("body", name, names())
    return _BODIES[name]


def register_body(body: Body) -> None:
    """Let robots have this body, as `parallel_env(..., body=body.name)`, in this process.

    Raises:
        OptionError: if another body has its name, or parts of it do not fit together.
    """
    if body.name in _BODIES and _BODIES[body.name] is not body:
        raise OptionError(f"body {body.name!r} exists already; valid: a name other than {', '.join(names())}")
    joints = len(body.joints)
    for part in ("lower", "upper", "lowest", "highest", "speed", "top_speed", "arm_weights", "door_weights"):
        shape = getattr(body, part).shape
        if shape != (joints,):
            raise OptionError(f"{part} of body {body.name!r} has the shape {shape}; valid: ({joints},)")
    if body.tuck(0.0, 0.0, 0.0).shape != (joints,):
        raise OptionError(f"body {body.name!r} tucks into another number of joints than it has; valid: {joints}")
    _BODIES[body.name] = body
