"""The bodies there are: those of the package and of installed ones by name, those of files and modules by address."""

from __future__ import annotations

import inspect
import sys
from pathlib import Path

import numpy as np

from remac_env.errors import OptionError, check_choice
from remac_env.plugins import BODIES, FORMS, find, installed
from remac_env.robots.body import Body
from remac_env.robots.panda.body import Panda
from remac_env.seeding import digest

STANDARD = "panda"
"""The body of robots for which no other is asked: the one that built-in fixtures are certified for."""

_BODIES: dict[str, Body] = {STANDARD: Panda()}

_EACH_JOINT = ("lower", "upper", "lowest", "highest", "speed", "top_speed", "arm_weights", "door_weights")
_MEASURES = tuple(Body.__annotations__)
_ASKED = ("name", "fingerprint", "tuck", "add_to", "kinematics")


def names() -> tuple[str, ...]:
    """All bodies that need not be imported from outside: the standard one first, then those this process knows."""
    return tuple(_BODIES)


def every_name() -> tuple[str, ...]:
    """The same, and the names that installed packages add (`remac.bodies`)."""
    return tuple(dict.fromkeys((*names(), *installed(BODIES))))


def get(name: str = STANDARD) -> Body:
    """A body by its name, or by the address of its class or object: "path/file.py:Name" or "package.module:Name".

    What lies at an address is imported once in a process, and is part of that process: name only code that you trust.

    Raises:
        UnknownNameError: for what is neither, or cannot be imported; it lists the names and forms.
        OptionError: for what is no body.
    """
    if not isinstance(name, str):
        check_choice("body", name, every_name())
    if name not in _BODIES:
        found = find("body", name, own=dict.fromkeys(names(), ""), group=BODIES)
        _BODIES[name] = _made(found, name)
    return _BODIES[name]


def register_body(body: Body) -> None:
    """Let robots have this body, as `parallel_env(..., body=body.name)`, in this process.

    Raises:
        OptionError: if another body has its name, or parts of it do not fit together.
    """
    if body.name in _BODIES and _BODIES[body.name] is not body:
        raise OptionError(f"body {body.name!r} exists already; valid: a name other than {', '.join(names())}")
    _check(body)
    _BODIES[body.name] = body


def described(name: str) -> dict[str, str]:
    """What records say of a body: its own name, and a digest of its measures, fingerprint and code.

    Nothing of the standard one, which is a part of the package's code.
    """
    if name == STANDARD:
        return {}
    body = get(name)
    measures = [str(np.asarray(getattr(body, part)).tolist()) for part in _MEASURES]
    file = source(body)
    code = "" if file is None else file.read_text("utf-8")
    return {"body": body.name, "body_digest": digest([body.fingerprint, measures, code])}


def source(body: Body) -> Path | None:
    """The file in which the class of a body is; None for one that was typed in."""
    file = getattr(sys.modules.get(type(body).__module__), "__file__", None)
    return None if file is None else Path(file)


def _made(found: object, address: str) -> Body:
    """The body that lies at an address: an object, or a class that is called without arguments."""
    if not inspect.isclass(found):
        return _check(found)
    try:
        inspect.signature(found).bind()
    except TypeError as error:
        raise OptionError(f"body {address!r} cannot be made: {error}; valid: a class without arguments") from error
    return _check(found())


def _check(body: object) -> Body:
    """The same, with parts that fit together; OptionError where they do not."""
    if missing := [part for part in (*_ASKED, *_MEASURES) if not hasattr(body, part)]:
        told = f"{type(body).__name__} lacks {', '.join(missing)}"
        raise OptionError(f"this is no body: {told}; valid: all of remac_env.robots.body.Body, or {', '.join(FORMS)}")
    made: Body = body  # type: ignore[assignment]
    joints = len(made.joints)
    for part in _EACH_JOINT:
        shape = np.shape(getattr(made, part))
        if shape != (joints,):
            raise OptionError(f"{part} of body {made.name!r} has the shape {shape}; valid: ({joints},)")
    if made.tuck(0.0, 0.0, 0.0).shape != (joints,):
        raise OptionError(f"body {made.name!r} tucks into another number of joints than it has; valid: {joints}")
    return made
