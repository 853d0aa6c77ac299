"""A hundred thousand calls at random: only documented errors come of them."""

from __future__ import annotations

from typing import Any

import pytest
from endurance_calls import Caller, Undocumented, call_often

from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.options import Options
from remac_env.tasks import get

PLACES = ("one_wall_small", "galley")
"""Layouts of the short tests."""


def check_variety(caller: Caller, calls: int) -> None:
    """All kinds of calls were made, and enough of them were refused, for several reasons."""
    assert sum(caller.counts.values()) == calls
    kinds = {name.split("(")[0] for name in caller.counts}
    assert {"step", "reset", "render", "state", "spaces", "mutation", "masks", "facts", "make", "close"} <= kinds
    assert {"ActionError", "OptionError", "LifecycleError"} <= set(caller.raised)
    assert 0.05 < sum(caller.raised.values()) / calls < 0.9


def test_two_thousand_symbolic_calls() -> None:
    check_variety(call_often(Caller(1, backend="symbolic", places=PLACES), 2000), 2000)


def test_some_calls_in_physics() -> None:
    caller = call_often(Caller(2, backend="physics", places=PLACES), 60)
    assert sum(caller.counts.values()) == 60 and caller.raised


@pytest.mark.long
@pytest.mark.parametrize("seed", range(9))
def test_99_000_symbolic_calls(seed: int) -> None:
    check_variety(call_often(Caller(seed + 10, backend="symbolic"), 11_000), 11_000)


@pytest.mark.long
def test_1_000_calls_in_physics() -> None:
    check_variety(call_often(Caller(30, backend="physics"), 1000), 1000)


# -- what the caller must find ----------------------------------------------------------------------------------------


class Stumbles(KitchenParallelEnv):
    """Every fortieth step is a KeyError."""

    steps = 0

    def step(self, actions: Any) -> Any:
        self.steps += 1
        if self.steps % 40 == 0:
            raise KeyError("robot_0")
        return super().step(actions)


class TakesAnySeed(KitchenParallelEnv):
    def reset(self, seed: Any = None, options: Any = None) -> Any:
        return super().reset(seed=abs(int(seed)) if seed is not None else None, options=options)


class GivesItsOwnState(KitchenParallelEnv):
    """What it returns is what it works with."""

    kept: Any = None

    def state(self) -> Any:
        if self.kept is None or self.kept.shape != super().state().shape:
            self.kept = super().state()
        return self.kept


class SaysNothing(KitchenParallelEnv):
    def step(self, actions: Any) -> Any:
        from remac_env.errors import ActionError

        raise ActionError


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        (Stumbles, "raised KeyError"),
        (TakesAnySeed, "raised (TypeError|ValueError|OverflowError)"),
        (GivesItsOwnState, "writing to what was told"),
        (SaysNothing, "without a message"),
    ],
)
def test_a_faulty_environment_is_caught(kind: type[KitchenParallelEnv], words: str) -> None:
    def make(task: str, **options: Any) -> KitchenParallelEnv:
        return kind(get(task), Options(**options))

    with pytest.raises(Undocumented, match=words):
        call_often(Caller(3, backend="symbolic", make=make, places=PLACES), 2000)
