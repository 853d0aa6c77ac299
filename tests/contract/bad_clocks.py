"""Kitchens under the event clock that are wrong on purpose: each breaks one promise, and check_events finds it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from remac_env.envs.event_parallel import KitchenEventEnv
from remac_env.options import Options
from remac_env.tasks import get


class Timed(KitchenEventEnv):
    """Nothing is wrong with this one."""

    def __init__(self, **options: Any) -> None:
        made = {"backend": "symbolic", "robots": 2, "clock": "events"} | options
        super().__init__(get("OpenCabinetPnP"), Options(**made))

    def step(self, actions: Mapping[str, int]) -> Any:
        seen, rewards, terminations, truncations, infos = super().step(actions)
        return self.tamper(seen, rewards, infos), rewards, terminations, truncations, infos

    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        return seen


class AsksTheBusy(Timed):
    """A robot that is at work is asked for its next command."""

    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for name, info in infos.items():
            info["ready"], info["running"] = True, ""
            seen[name]["action_mask"] = super(KitchenEventEnv, self).action_mask(name)
        return seen


class MasksNothing(Timed):
    def action_mask(self, agent: str) -> Any:
        mask = super().action_mask(agent)
        return mask if mask.sum() > 1 else np.zeros_like(mask)


class ForgetsContinue(Timed):
    """A busy robot may do whatever a ready one may."""

    def action_mask(self, agent: str) -> Any:
        return super(KitchenEventEnv, self).action_mask(agent)


class OffersContinue(Timed):
    """A ready robot may go on with nothing."""

    def action_mask(self, agent: str) -> Any:
        mask = super().action_mask(agent)
        mask[-1] = 1
        return mask


class StandsStill(Timed):
    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for info in infos.values():
            info["seconds"], info["tau"] = 0.0, 0.0
            info["outcome"] = info["outcome"] and info["outcome"] | {"began": 0.0, "ended": 0.0}
        return seen


class TellsTwice(Timed):
    """What ended is told until something else has ended."""

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> Any:
        self._last: dict[str, Any] = {}
        return super().reset(seed=seed, options=options)

    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for name, info in infos.items():
            info["outcome"] = self._last[name] = info["outcome"] or self._last.get(name, {})
        return seen


class TellsTheLastAgain(TellsTwice):
    """A robot that is ready is told how the command before its last one ended."""

    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for name, info in infos.items():
            if info["outcome"]:
                info["outcome"], self._last[name] = self._last.get(name, info["outcome"]), info["outcome"]
        return seen


class LosesAnOutcome(Timed):
    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for info in infos.values():
            info["outcome"] = {}
        return seen


class CountsFromTheStart(Timed):
    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for info in infos.values():
            info["tau"] = info["seconds"]
        return seen


class PaysTwice(Timed):
    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for info in infos.values():
            info["return"] += 0.5
        return seen


class CountsSteps(Timed):
    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for info in infos.values():
            info["decision"] = info["round"]
        return seen


class RunningMayBeNone(Timed):
    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for info in infos.values():
            info["running"] = info["running"] or None
        return seen


class Stoppable(Timed):
    """Nothing is wrong with this one either; robots may be told to stop."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"interrupts": True, "starts": "mixed"} | options)

    def stopped(self, infos: Any) -> list[str]:
        """The robots whose stop is told of just now."""
        return [name for name, info in infos.items() if info["outcome"].get("reason") == "interrupted"]


class StopTeleports(Stoppable):
    """A robot that has stopped stands beside the room."""

    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for name in self.stopped(infos):
            episode = self._timed()
            episode.world = episode.world.with_robot(name, station="aside")
        return seen


class StopLetsFall(Stoppable):
    """A robot that has stopped has nothing in its hand, or something new."""

    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for name in self.stopped(infos):
            episode = self._timed()
            thing = next(iter(episode.world.objects))
            held = None if episode.world.robots[name].holding else thing
            episode.world = episode.world.with_robot(name, holding=held)
        return seen


class StopLeavesClaims(Stoppable):
    """What a stopped robot was about to take is kept for it, from itself too."""

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> Any:
        self._kept: set[tuple[str, int]] = set()
        self._last: dict[str, int] = {}
        return super().reset(seed=seed, options=options)

    def step(self, actions: Mapping[str, int]) -> Any:
        ready = self._timed().clock.ready
        self._last |= {name: actions[name] for name in ready}
        lost = {name: self.vocabulary.encode("continue") for name in ready if (name, actions[name]) in self._kept}
        return super().step({**actions, **lost})

    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        self._kept |= {(name, self._last[name]) for name in self.stopped(infos)}
        return seen


class StopsByItself(Stoppable):
    """A failure is called a stop that nobody asked for."""

    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for info in infos.values():
            if info["outcome"].get("status") == "failure":
                info["outcome"] = info["outcome"] | {"reason": "interrupted"}
        return seen


class StopIsDeaf(Stoppable):
    """Who is told to stop goes on for ever."""

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> Any:
        self._deaf: set[str] = set()
        return super().reset(seed=seed, options=options)

    def step(self, actions: Mapping[str, int]) -> Any:
        self._deaf |= {name for name, token in actions.items() if token == self.vocabulary.encode("stop")}
        return super().step(actions)

    def tamper(self, seen: Any, rewards: Any, infos: Any) -> Any:
        for name in self._deaf.intersection(infos):
            infos[name].update(ready=False, running="pick up nothing", outcome={})
            seen[name]["action_mask"] = super(KitchenEventEnv, self).action_mask(name) * 0
            seen[name]["action_mask"][self.vocabulary.encode("continue")] = 1
        return seen
