"""More environments that are wrong on purpose: in what they accept, when, from whom, and what they tell."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bad_environments import INFOS, REWARD, TERMINATED, Tampered

from remac_env.text import describe_states

# -- tokens and actions ---------------------------------------------------------------------------------------------


class RaisesOnIllegalTokens(Tampered):
    def step(self, actions: Mapping[str, int]) -> Any:
        for token in actions.values():
            if not 0 <= token < len(self.vocabulary) or not self._mask[token]:
                raise ValueError(f"token {token} is not legal")
        return super().step(actions)


class ForgivesIllegalTokens(Tampered):
    def tamper_infos(self, infos: Any) -> Any:
        for info in infos.values():
            if info["outcome"].get("reason") == "invalid":
                info["outcome"] |= {"status": "success", "reason": ""}
        return infos


class BooleanMask(Tampered):
    def tamper(self, observations: Any) -> Any:
        return {n: s | {"action_mask": s["action_mask"].astype(bool)} for n, s in observations.items()}


class WaitingIsForbidden(Tampered):
    def tamper(self, observations: Any) -> Any:
        for seen in observations.values():
            seen["action_mask"][0] = 0
        return observations


class MasksByFeasibility(Tampered):
    """A mask that tells that the door is closed."""

    def tamper(self, observations: Any) -> Any:
        for seen in observations.values():
            seen["action_mask"][self.vocabulary.encode("close cabinet door")] = 0
        return observations


class RoundsNumbers(Tampered):
    def step(self, actions: Mapping[str, int]) -> Any:
        return super().step({name: int(token) for name, token in actions.items()})


class FillsInMissingRobots(Tampered):
    def step(self, actions: Mapping[str, int]) -> Any:
        return super().step(dict.fromkeys(self.agents, 0) | dict(actions))


class NamesNobody(Tampered):
    def step(self, actions: Mapping[str, int]) -> Any:
        try:
            return super().step(actions)
        except TypeError:
            raise TypeError("bad action") from None


class ActsBeforeItChecks(Tampered):
    """What comes first in a malformed action is carried out before the exception."""

    def step(self, actions: Mapping[str, int]) -> Any:
        if isinstance(actions, Mapping) and self._episode is not None:
            self._episode.rounds += 1
        return super().step(actions)


# -- life cycle -----------------------------------------------------------------------------------------------------


class StepsBeforeReset(Tampered):
    def step(self, actions: Mapping[str, int]) -> Any:
        if self._episode is None:
            self.reset(seed=0)
        return super().step(actions)


class StartsAgainByItself(Tampered):
    def step(self, actions: Mapping[str, int]) -> Any:
        if not self.agents and self._episode is not None and not self._closed:
            self.reset(seed=0)
        return super().step(actions or {})


class IgnoresDone(Tampered):
    def step(self, actions: Mapping[str, int]) -> Any:
        return super().step({name: 0 if token == 1 else token for name, token in actions.items()})


class ClosesOnlyOnce(Tampered):
    def close(self) -> None:
        if self._closed:
            raise RuntimeError("closed already")
        super().close()


class RisesFromTheDead(Tampered):
    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> Any:
        self._closed = False
        return super().reset(seed=seed, options=options)


# -- robots, text, verdict ------------------------------------------------------------------------------------------


class WatchesOneRobotOnly(Tampered):
    """Success when the robot number zero holds nothing and stands at the cabinet: the others are forgotten."""

    def tamper_step(self, answer: list[Any]) -> list[Any]:
        won = self.world.robots["robot_0"].station == "cabinet"
        for info in answer[INFOS].values():
            info["success"] = won
        return answer


class PaysOneRobotOnly(Tampered):
    def tamper_step(self, answer: list[Any]) -> list[Any]:
        held = {name: self.world.robots[name].holding is not None for name in answer[REWARD]}
        answer[REWARD] = {name: float(name == "robot_0" and full) for name, full in held.items()}
        return answer


class FirstComeFirstServed(Tampered):
    """Where two robots claim one station, the robot number zero gets it."""

    def step(self, actions: Mapping[str, int]) -> Any:
        if len(set(actions.values())) == 1:
            actions = {name: token if name == "robot_0" else 0 for name, token in actions.items()}
        return super().step(actions)


class TellsStates(Tampered):
    def tamper_infos(self, infos: Any) -> Any:
        for info in infos.values():
            info["text"] += "\n" + describe_states(info["scene"], info["world"])
        return infos


class HintsAtStates(Tampered):
    """No word of a state, and yet the text is another one when something is on."""

    def tamper_infos(self, infos: Any) -> Any:
        for info in infos.values():
            busy = sum(robot.holding is not None for robot in info["world"].robots.values())
            info["text"] += "\nWell!" if busy else ""
        return infos


class HidesAThing(Tampered):
    def tamper_infos(self, infos: Any) -> Any:
        for info in infos.values():
            info["text"] = info["text"].replace("plate", "thing")
        return infos


class WinsTooEarly(Tampered):
    def tamper_step(self, answer: list[Any]) -> list[Any]:
        if self.round == 2:
            answer[TERMINATED] = dict.fromkeys(answer[TERMINATED], True)
            self.agents = []
        return answer


class NeverWins(Tampered):
    def tamper_step(self, answer: list[Any]) -> list[Any]:
        for info in answer[INFOS].values():
            info["success"] = False
        return answer
