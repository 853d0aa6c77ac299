"""Environments that are wrong on purpose: each breaks one promise, and one check has to find it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.options import Options
from remac_env.rules.outcomes import REASONS
from remac_env.state import FrozenMap, Place
from remac_env.tasks import get

REWARD, TERMINATED, TRUNCATED, INFOS = 1, 2, 3, 4


class Tampered(KitchenParallelEnv):
    """A kitchen whose answers can be changed on their way out."""

    def __init__(self, task: str = "OpenCabinetPnP", **options: Any) -> None:
        super().__init__(get(task), Options(**({"backend": "symbolic", "robots": 2} | options)))
        self.round = 0

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> Any:
        self.round = 0
        observations, infos = super().reset(seed=seed, options=options)
        return self.tamper(observations), self.tamper_infos(infos)

    def step(self, actions: Mapping[str, int]) -> Any:
        observations, rewards, terminations, truncations, infos = super().step(actions)
        self.round += 1
        answer = [self.tamper(observations), rewards, terminations, truncations, self.tamper_infos(infos)]
        return tuple(self.tamper_step(answer))

    def tamper(self, observations: Any) -> Any:
        return observations

    def tamper_infos(self, infos: Any) -> Any:
        return infos

    def tamper_step(self, answer: list[Any]) -> list[Any]:
        return answer


# -- spaces ---------------------------------------------------------------------------------------------------------


class OutsideItsSpace(Tampered):
    def tamper(self, observations: Any) -> Any:
        return {name: seen | {"observation": seen["observation"] * 2} for name, seen in observations.items()}


class OutsideItsSpaceLater(OutsideItsSpace):
    def tamper(self, observations: Any) -> Any:
        return super().tamper(observations) if self.round == 5 else observations


class DoublePrecision(Tampered):
    def tamper(self, observations: Any) -> Any:
        return {n: s | {"observation": s["observation"].astype(np.float64)} for n, s in observations.items()}


class LacksAKey(Tampered):
    def tamper(self, observations: Any) -> Any:
        return {name: {"observation": seen["observation"]} for name, seen in observations.items()}


class ForgetsOneRobot(Tampered):
    def tamper_infos(self, infos: Any) -> Any:
        return dict(list(infos.items())[1:])


class LacksAField(Tampered):
    def tamper_infos(self, infos: Any) -> Any:
        return {name: {k: v for k, v in info.items() if k != "success"} for name, info in infos.items()}


class UnlistedReason(Tampered):
    def tamper_infos(self, infos: Any) -> Any:
        wrong = {"status": "failure", "reason": "bad luck", "detail": "", "seconds": 0.0, "began": 0.0, "ended": 0.0}
        assert wrong["reason"] not in REASONS
        return {name: info | ({"outcome": wrong} if info["outcome"] else {}) for name, info in infos.items()}


class NoOutcomeYet(Tampered):
    """None before the first outcome: a vector environment cannot put that beside a dict."""

    def tamper_infos(self, infos: Any) -> Any:
        return {name: info | {"outcome": info["outcome"] or None} for name, info in infos.items()}


class EndsInNone(Tampered):
    def tamper_infos(self, infos: Any) -> Any:
        return {name: info | {"end": info["end"] or None} for name, info in infos.items()}


class NoReasonOnSuccess(Tampered):
    """The same one level deeper, where it is a success that has no reason."""

    def tamper_infos(self, infos: Any) -> Any:
        for info in infos.values():
            if info["outcome"]:
                info["outcome"]["reason"] = info["outcome"]["reason"] or None
        return infos


class NumpyCounters(Tampered):
    """Counters that become numbers of NumPy once something was counted."""

    def tamper_infos(self, infos: Any) -> Any:
        return {name: info | {"round": np.int64(info["round"]) if self.round else 0} for name, info in infos.items()}


class WholeRewards(Tampered):
    def tamper_step(self, answer: list[Any]) -> list[Any]:
        answer[REWARD] = {name: int(reward) for name, reward in answer[REWARD].items()}
        return answer


class NumpyFlags(Tampered):
    def tamper_step(self, answer: list[Any]) -> list[Any]:
        answer[TERMINATED] = {name: np.bool_(flag) for name, flag in answer[TERMINATED].items()}
        return answer


class ForgetsTheDead(Tampered):
    """At the end only the robots that are still alive are answered: nobody."""

    def tamper_step(self, answer: list[Any]) -> list[Any]:
        return answer if self.agents else [{}, {}, {}, {}, {}]


class EndsOneByOne(Tampered):
    def tamper_step(self, answer: list[Any]) -> list[Any]:
        if self.round == 3:
            answer[TRUNCATED] = {name: name == "robot_1" for name in answer[TRUNCATED]}
        return answer


class WritesToWhatItGave(Tampered):
    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.buffers: dict[str, np.ndarray] = {}

    def tamper(self, observations: Any) -> Any:
        for name, seen in observations.items():
            buffer = self.buffers.setdefault(name, seen["observation"].copy())
            buffer[:] = seen["observation"]
            seen["observation"] = buffer
        return observations


class NewSpacesEachTime(Tampered):
    def action_space(self, agent: str) -> Any:
        return type(self.action_spaces[agent])(self.action_spaces[agent].n)


class TwoInOneSlot(Tampered):
    def tamper_infos(self, infos: Any) -> Any:
        world = next(iter(infos.values()))["world"]
        for name in world.objects:
            world = world.with_object(name, place=Place("slot", "counter.0"))
        return {name: info | {"world": world} for name, info in infos.items()}


class LosesAThing(Tampered):
    def tamper_infos(self, infos: Any) -> Any:
        world = next(iter(infos.values()))["world"]
        object.__setattr__(world, "objects", FrozenMap(dict(list(world.objects.items())[1:])))
        return infos


# -- changes --------------------------------------------------------------------------------------------------------


class SeesTheStartOnly(Tampered):
    """What reset showed, for the whole episode."""

    shown: Any = None

    def tamper(self, observations: Any) -> Any:
        if self.round == 0:
            self.shown = {name: seen["observation"].copy() for name, seen in observations.items()}
        return {name: seen | {"observation": self.shown[name].copy()} for name, seen in observations.items()}


class OneRobotIsBlind(Tampered):
    def tamper(self, observations: Any) -> Any:
        last = sorted(observations)[-1:]
        return {n: s | ({"observation": s["observation"] * 0} if n in last else {}) for n, s in observations.items()}


class StandsStillLater(SeesTheStartOnly):
    """The same from the second round on, in episodes that begin as they should."""

    def tamper(self, observations: Any) -> Any:
        if self.round <= 2:
            self.shown = {name: seen["observation"].copy() for name, seen in observations.items()}
        return {name: seen | {"observation": self.shown[name].copy()} for name, seen in observations.items()}


# -- determinism ----------------------------------------------------------------------------------------------------


class RandomOnTheSameSeed(Tampered):
    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> Any:
        return super().reset(seed=int(np.random.default_rng().integers(1_000_000)), options=options)


class CountsItsResets(Tampered):
    resets = 0

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> Any:
        self.resets += 1
        return super().reset(seed=int(seed or 0) * 100 + self.resets, options=options)


class ListensToGlobalRandom(Tampered):
    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> Any:
        return super().reset(seed=int(np.random.get_state()[1][0]) + int(seed or 0), options=options)  # noqa: NPY002


class DrawsFromGlobalRandom(Tampered):
    """The episode is the same, but the user's own random numbers are not."""

    def step(self, actions: Mapping[str, int]) -> Any:
        np.random.random()  # noqa: NPY002
        return super().step(actions)


class RandomAtTheEnd(Tampered):
    """The first step, which is all that PettingZoo's seed test compares for certain, is as it should be."""

    def tamper(self, observations: Any) -> Any:
        if self.round >= 2:
            for seen in observations.values():
                seen["observation"][0] = np.float32(np.random.default_rng().random())
        return observations


class OneEpisodeOnly(Tampered):
    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> Any:
        return super().reset(seed=0, options=options)


class RemembersTheLastEpisode(Tampered):
    """Robots that were told anything before start with something left over."""

    told = 0

    def tamper_step(self, answer: list[Any]) -> list[Any]:
        self.told += 1
        answer[REWARD] = {name: float(self.told > 40) for name in answer[REWARD]}
        return answer
