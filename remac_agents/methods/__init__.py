"""The methods: how roles are combined. Each is a generator that yields what its robots do next.

A method yields `{robot: Subtask}` and is sent the next View, which the run has taken in by then. When it
returns, every robot says `done`. One of your own is written with what this module exports:

    @register_method("IMPATIENT", checks=False)
    def impatient(run: MethodRun) -> Turns:
        run.make_plan(run.briefing.robots)
        while not run.finished:
            yield run.turn
            run.advance()
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from string import ascii_letters, digits
from typing import Any

from remac_agents.methods.base import base
from remac_agents.methods.best import best_of
from remac_agents.methods.cape import cape
from remac_agents.methods.cc import cc
from remac_agents.methods.human import human
from remac_agents.methods.re import re
from remac_agents.methods.react import react
from remac_agents.methods.reflect import reflect, reflect_cc
from remac_agents.methods.remac import remac
from remac_agents.methods.smart_llm import smart_llm
from remac_agents.running.checks import adjust, check_after, check_before
from remac_agents.running.method_run import MethodRun, Turns
from remac_env.errors import OptionError, check_choice

_LETTERS = frozenset(f"{ascii_letters}{digits}-_+.")  # a comma would end a name on command lines

__all__ = [
    "METHODS",
    "Method",
    "MethodRun",
    "Turns",
    "adjust",
    "check_after",
    "check_before",
    "register_method",
]


Run = Callable[[MethodRun], Turns]


@dataclass(frozen=True, kw_only=True)
class Method:
    """A method by name.

    Attributes:
        run: its generator.
        robots: how many robots it is made for.
        remembers: its runs go into the memory.
        iterates: playing one start again may end differently, so that it is given k+1 iterations.
        plans_ahead: it has a first plan, whose length is the IPL.
        checks: it asks for conditions and verdicts; one that does not asks its planner alone, has no checker and no
            pictures for one.
        asks_again: its planner is told of steps that failed, and asked for what to do then.
        by_events: it is made for the event clock, and asked for the robots that are ready. Any other sees rounds under
            that clock too: who has ended early waits until all have.
    """

    name: str
    run: Run
    robots: int = 1
    remembers: bool = False
    iterates: bool = False
    plans_ahead: bool = True
    checks: bool = True
    asks_again: bool = False
    by_events: bool = False


METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        Method(name="BASE", run=base, checks=False),
        Method(name="CC", run=cc),
        Method(name="RE", run=re, remembers=True, iterates=True),
        Method(name="REMAC", run=remac, robots=2, remembers=True, iterates=True, by_events=True),
        Method(name="SMART-LLM", run=smart_llm, robots=2, checks=False),
        Method(name="REFLECT", run=reflect, asks_again=True),
        Method(name="REFLECT+CC", run=reflect_cc, asks_again=True),
        Method(name="CAPE", run=cape("explicit"), plans_ahead=False, asks_again=True),
        Method(name="CAPE-IMPLICIT", run=cape("implicit"), plans_ahead=False, asks_again=True),
        Method(name="CAPE-SUCCESS", run=cape("success"), plans_ahead=False, asks_again=True),
        Method(name="CAPE-RESAMPLE", run=cape("resample"), plans_ahead=False, asks_again=True),
        Method(name="BASE-BEST", run=best_of(base), iterates=True, checks=False),
        Method(name="CC-BEST", run=best_of(cc), iterates=True),
        Method(name="REACT", run=react, robots=2, plans_ahead=False, checks=False, asks_again=True, by_events=True),
        Method(name="human", run=human, checks=False, asks_again=True),
    )
}
"""Every method by its name."""


def register_method(name: str, **facts: Any) -> Callable[[Run], Run]:
    """Add the method that is decorated; it is then made, run and shown in tables by its name.

    Args:
        name: letters, figures, and -, _, + or .
        facts: attributes of Method beside name and run.

    Raises:
        OptionError: for another name, or one that is taken.
        UnknownNameError: for a fact that methods do not have; lists the valid ones.
    """
    if not name or not set(name) <= _LETTERS:
        raise OptionError(f"method name {name!r} is not valid; valid: letters, figures, and -, _, + or .")
    if name in METHODS:
        raise OptionError(f"method {name!r} exists already; valid: a name other than {', '.join(METHODS)}")
    known = [each.name for each in fields(Method) if each.name not in ("name", "run")]
    for fact in facts:
        check_choice("fact of a method", fact, known)

    def add(run: Run) -> Run:
        METHODS[name] = Method(name=name, run=run, **facts)
        return run

    return add
