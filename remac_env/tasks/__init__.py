"""The tasks of the suite, and those registered from outside."""

from __future__ import annotations

from remac_env.errors import OptionError, UnknownNameError, check_choice
from remac_env.plugins import load_tasks
from remac_env.tasks import generated
from remac_env.tasks.defrost_in_bowl import SPEC as _DEFROST
from remac_env.tasks.heat_on_stove import SPEC as _HEAT
from remac_env.tasks.open_cabinet_pnp import SPEC as _CABINET
from remac_env.tasks.open_microwave_pnp import SPEC as _MICROWAVE
from remac_env.tasks.seasoned_microwave import SPEC as _SEASONED
from remac_env.tasks.spec import TaskSpec
from remac_env.tasks.timed import SPECS as TIMED
from remac_env.tasks.wash_pnp_heat import SPEC as _WASH
from remac_env.values import python_value

_SPECS: dict[str, TaskSpec] = {spec.name: spec for spec in (_CABINET, _MICROWAVE, _DEFROST, _HEAT, _WASH, _SEASONED)}

_TIMED: dict[str, TaskSpec] = {spec.name: spec for spec in TIMED}

BUILT_IN = tuple(_SPECS)
"""The names of the tasks of this package."""


def known() -> tuple[str, ...]:
    """The names of the tasks that are registered by now and can be played in rounds, those from outside last."""
    return tuple(name for name, spec in _SPECS.items() if not spec.timed)


def timed() -> tuple[str, ...]:
    """The names of the tasks that need the event clock."""
    return (*_TIMED, *(name for name, spec in _SPECS.items() if spec.timed))


def names() -> tuple[str, ...]:
    """The names of all tasks, those that installed packages add (`remac.tasks`) among them."""
    load_tasks()
    return known()


def get(name: str) -> TaskSpec:
    """The task of that name, `Generated` among them.

    Raises:
        UnknownNameError: for another name; it lists the tasks, and the installed packages whose tasks cannot be had.
    """
    name = python_value(name)
    if isinstance(name, str) and name == generated.SPEC.name:
        return generated.SPEC
    missing = load_tasks() if not isinstance(name, str) or name not in (*known(), *timed()) else ()
    every = _SPECS | _TIMED
    try:
        check_choice("task", name, every)
    except UnknownNameError as error:
        raise UnknownNameError("; ".join((str(error), *missing))) from None
    return every[name]


def add(spec: TaskSpec) -> None:
    """Add a task from outside. Adding an equal one again changes nothing.

    Raises:
        OptionError: if another task has the name.
    """
    every = _SPECS | _TIMED
    if spec.name in every and every[spec.name] != spec:
        raise OptionError(f"task name {spec.name!r} is taken by another task; taken: {', '.join(every)}")
    _SPECS[spec.name] = spec
