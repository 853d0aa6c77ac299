"""Calls of the environments' interface at random, right and wrong, and which exceptions may come of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any

import gymnasium
import numpy as np

import remac_env
from remac_env.errors import RemacError
from remac_env.kitchen import layout, style
from remac_env.seeding import generator

Maker = Callable[..., Any]

ALLOWED: Mapping[str, tuple[type[BaseException], ...]] = {
    "parallel": (RemacError,),
    # Gymnasium's own, for what is called before reset.
    "gym": (RemacError, gymnasium.error.ResetNeeded),
    # PettingZoo's own: its order-enforcing wrapper raises these for what comes before reset; see BEFORE_RESET.
    "aec": (RemacError, AttributeError, AssertionError),
}
"""Errors that are documented, by the kind of environment. KeyError, IndexError and the like are in none."""

BEFORE_RESET = ("cannot be accessed before reset", "reset() needs to be called before", "before you call `reset`")
"""Words of one of which PettingZoo's AttributeErrors and AssertionErrors for a call before reset are made."""

JUNK: tuple[Any, ...] = (
    None, "", "wait", "robot_0", 1.0, 2.5, float("nan"), float("-inf"), True, False, 1j, b"0", [], [0], (0,), {}, {0},
    np.float32(1), np.bool_(True), np.ones(2), np.zeros((2, 2), int), np.array("a"), object(), int, Ellipsis,
)  # fmt: skip
"""Values that are nothing of what is asked for."""

WHOLE: tuple[Any, ...] = (
    0, 1, 2, 3, -1, 10**4, 2**31, 2**63 - 1, 2**63, 2**70, -(2**70), 10**400, np.int8(3), np.uint64(2**64 - 1),
    np.int64(5), np.array(4), np.array([2]),
)  # fmt: skip
"""Whole numbers of all kinds, tokens and others."""

NAMES = ("robot_0", "robot_1", "robot_2", "", 0, None, ("robot_0",))
KEYWORDS = (
    "task", "robots", "backend", "style", "layout", "starts", "obs", "text", "feedback", "wording", "naming",
    "perception_noise", "image_size", "render_mode", "max_rounds", "reward", "failure_rate",
)  # fmt: skip


class Undocumented(AssertionError):
    """A call raised what it must not, or returned what it must not."""


class Caller:
    """Makes calls drawn from a seeded generator on one environment after another.

    Args:
        make: makes a parallel environment from a task's name and keywords.
        backend: of the environments.
        places: layouts of the environments; None leaves them to the seeds, as reading each takes a while.
    """

    def __init__(
        self, seed: int, *, backend: str, make: Maker = remac_env.parallel_env, places: tuple[str, ...] | None = None
    ) -> None:
        self.chance = generator(seed, "calls at random")
        self.backend, self.make, self.places = backend, make, places
        self.counts: Counter[str] = Counter()
        self.raised: Counter[str] = Counter()
        self.kind, self.env = "parallel", None
        self.log: list[str] = []
        self._fresh()

    def call(self) -> None:
        """One call.

        Raises:
            Undocumented: for an exception that is not documented; the message has the last calls.
        """
        name, act = self._drawn()
        self.counts[name] += 1
        self.log = [*self.log[-5:], name]
        try:
            act()
        except ALLOWED[self.kind] as error:
            strange = not isinstance(error, (RemacError, gymnasium.error.ResetNeeded))
            if strange and not any(words in str(error) for words in BEFORE_RESET):
                raise Undocumented(f"{self.kind}: {self.log} raised {error!r}") from error
            if not str(error):
                raise Undocumented(f"{self.kind}: {name} raised {error!r} without a message") from error
            self.raised[type(error).__name__] += 1
        except Undocumented:
            raise
        except Exception as error:
            raise Undocumented(f"{self.kind}, {self.backend}: {self.log} raised {error!r}") from error

    # -- what may be called --------------------------------------------------------------------------------------------

    def _drawn(self) -> tuple[str, Callable[[], object]]:
        """A call's name and the call; most are steps, and few make a new environment."""
        if self._parallel()._closed and self.chance.random() < 0.25:
            return "fresh", self._fresh
        share = self.chance.random()
        if share < 0.55:
            return self._step()
        if share < 0.68:
            return self._reset()
        others: list[tuple[str, Callable[[], object]]] = [
            ("render", self.env.render),
            ("state", lambda: self._parallel().state()),
            ("spaces", self._spaces),
            ("mutation", self._mutate),
            ("masks", lambda: self.env.action_masks() if self.kind == "gym" else None),
            ("facts", lambda: (self._parallel().world, self._parallel().start.digest, self._parallel().progress)),
            ("recording", lambda: self._parallel().recorded_rounds()),
            ("last", lambda: self.env.last() if self.kind == "aec" else None),
        ]
        if share < 0.975:
            return others[int(self.chance.integers(len(others)))]
        rare: list[tuple[str, Callable[[], object]]] = [
            ("close", self.env.close), ("close twice", self._close_twice), ("make", self._make), ("make", self._make),
            ("fresh", self._fresh), ("fresh", self._fresh),
        ]  # fmt: skip
        return rare[int(self.chance.integers(len(rare)))]

    def _step(self) -> tuple[str, Callable[[], object]]:
        if self.kind == "aec":
            action = self._action()
            return f"step({action!r:.60})", lambda: self.env.step(action)
        if self.kind == "gym":
            pair = [self._action() for _ in range(int(self.chance.integers(1, 4)))]
            several: Any = np.array(pair[:2]) if all(type(one) is int and abs(one) < 2**60 for one in pair) else pair
            action = pair[0] if self.chance.random() < 0.4 else several
            return f"step({action!r:.60})", lambda: self.env.step(action)
        actions = self._actions()
        return f"step({actions!r:.90})", lambda: self.env.step(actions)

    def _actions(self) -> Any:
        """Joint actions: mostly right, with robots missing or too many, or no mapping at all."""
        share = self.chance.random()
        if share < 0.05:
            return self._one_of(JUNK)
        names = list(self.env.possible_agents)
        if share < 0.15:
            names = [self._one_of(NAMES) for _ in range(int(self.chance.integers(0, 4)))]
        return {name: self._action() for name in names}

    def _action(self) -> Any:
        """A token: two of three legal ones where there is an episode, else whole numbers and junk."""
        share = self.chance.random()
        if share < 0.7:
            return int(self._one_of(self._legal))
        return self._one_of(WHOLE) if share < 0.9 else self._one_of(JUNK)

    def _reset(self) -> tuple[str, Callable[[], object]]:
        share = self.chance.random()
        seed = int(self.chance.integers(100_000)) if share < 0.6 else self._one_of((*WHOLE[:5], *WHOLE[8:], *JUNK))
        keywords: dict[str, Any] = {"seed": seed}
        if self.chance.random() < 0.3:
            names = (*self._names, *JUNK) if self.places is None else (*self.places, "modern_1", "castle", *JUNK)
            options: Any = {self._one_of(("style", "layout", "anything")): self._one_of(names)}
            keywords["options"] = options if self.chance.random() < 0.7 else self._one_of(JUNK)
        return f"reset({keywords!r:.90})", lambda: self._begin(keywords)

    def _begin(self, keywords: dict[str, Any]) -> None:
        self.env.reset(**keywords)
        self._legal = [int(t) for t in np.flatnonzero(self._parallel()._mask)]

    def _spaces(self) -> None:
        parallel = self._parallel()
        for name in parallel.possible_agents:
            if parallel.observation_space(name) is not parallel.observation_space(name):
                raise Undocumented("another space at each call")

    def _mutate(self) -> None:
        """Writing to what was told must not reach the environment."""
        parallel = self._parallel()
        state, world = parallel.state(), parallel.world
        state[:] = 7
        infos = parallel._infos()
        for info in infos.values():
            for key in list(info):
                if isinstance(info[key], dict):
                    info[key].clear()
                info[key] = None
        for part in (world.robots, world.objects, world.fixtures):
            for change in (lambda p=part: p.__setitem__("x", 1), lambda p=part: p.clear()):
                try:
                    change()
                except (TypeError, AttributeError):
                    continue
                raise Undocumented("a world could be written to")
        if (parallel.state() > 1).any() or parallel.world != world:
            raise Undocumented("writing to what was told changed the environment")

    def _close_twice(self) -> None:
        self.env.close()
        self.env.close()

    def _make(self) -> None:
        """An environment with one or two keywords that are drawn; no draw opens a window."""
        keywords: dict[str, Any] = {"backend": self.backend}
        for _ in range(int(self.chance.integers(1, 3))):
            keywords[self._one_of(KEYWORDS)] = self._one_of((*JUNK, *WHOLE, *self._names))
        keywords["task"] = keywords.get("task", "HeatOnStove")
        self.log.append(f"make({keywords!r:.90})")
        self.make(**keywords).close()

    def _fresh(self) -> None:
        """Go on with another environment."""
        if self.env is not None:
            self.env.close()
        task, robots = self._one_of(remac_env.tasks()), int(self.chance.integers(1, 3))
        self.kind = self._one_of(("parallel", "parallel", "gym", "aec"))
        keywords = {"robots": robots, "backend": self.backend, "starts": self._one_of(("paper", "mixed"))}
        if self.places is not None:
            keywords |= {"style": "modern_1", "layout": self._one_of(self.places)}
        if self.kind == "gym":
            self.env = gymnasium.make(f"RemacKitchen-{task}-v0", **keywords).unwrapped
        elif self.kind == "aec":
            self.env = remac_env.env(task, **keywords)
        else:
            self.env = self.make(task, **keywords)
        self._legal, self._names = [0, 1, 2, 3], (*style.names(), *layout.names(), "castle")

    def _parallel(self) -> Any:
        """The parallel environment within."""
        if self.kind == "gym":
            return self.env.parallel
        return self.env.unwrapped if self.kind == "aec" else self.env

    def _one_of(self, choices: Any) -> Any:
        return choices[int(self.chance.integers(len(choices)))]


def call_often(caller: Caller, calls: int) -> Caller:
    """So many calls."""
    for _ in range(calls):
        caller.call()
    return caller
