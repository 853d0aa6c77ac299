"""The label of a failed episode: planner, checker, skill or budget; docs/judging.md defines each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from remac_bench.blame.faults import Fault, Faults, find_faults, lost_rounds
from remac_bench.blame.replay import Joint, Replay, play_again, rescue, rounds_of
from remac_bench.judging.episodes import cap_rounds, distinct, setting
from remac_bench.records import Record
from remac_env.rules.claims import first_false
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import DONE, WAIT

Label = Literal["planner", "checker", "skill", "budget", "crash", "unclear"]
LABELS: tuple[Label, ...] = Label.__args__  # type: ignore[attr-defined]
"""`crash`: the agent raised an exception. `unclear`: the episode could not be played again as it was recorded, or
how long its shortest plan is could not be found out."""


class Blame(BaseModel):
    """Why one scored episode failed.

    Attributes:
        job, iteration: of the record.
        round: index of the record's outcomes in which it shows; their number where it is what did not come.
        robot, subtask: whose, where it is one robot's.
        what: what happened there, in words.
        rescued: whether the oracle's steps from that round on reach the goal; None where that was not tried.
    """

    model_config = ConfigDict(frozen=True, extra="ignore")

    job: str
    iteration: int
    setting: str
    task: str
    agent: str
    method: str
    seed: int
    label: Label
    round: int
    robot: str = ""
    subtask: str = ""
    what: str = ""
    rescued: bool | None = None


def blame_all(records: Iterable[Record], *, rescuing: bool = True) -> Iterator[Blame]:
    """The labels of all failed scored episodes, one after the other, in an order that does not depend on theirs."""
    for record in failed(records):
        yield blame(record, rescuing=rescuing)


def failed(records: Iterable[Record]) -> list[Record]:
    """The scored episodes that failed, each once."""
    return [record for record in distinct(records) if record.scored and not record.success]


def blame(record: Record, *, rescuing: bool = True) -> Blame:
    """Play a failed episode again and label it.

    Args:
        rescuing: also try whether the oracle's steps, from the round that shows it on, reach the goal.
    """
    if record.error is not None:
        return _labelled(record, "crash", len(record.outcomes), f"{record.error.type}: {record.error.message}")
    if record.clock == "events":
        return _labelled(record, "unclear", 0, "played by the event clock, in which there are no rounds to blame")
    replay = play_again(record)
    if not replay.faithful:
        at = max(0, len(replay.rounds) - 1)
        return _labelled(record, "unclear", at, "played again, the episode goes another way than its record")
    label, fault = _decide(record, replay)
    if label == "unclear":
        return _labelled(record, label, fault.round, fault.what)
    rescued = rescue(record, fault.round) if rescuing and label != "budget" else None
    return _labelled(record, label, fault.round, fault.what, robot=fault.robot, subtask=fault.subtask, rescued=rescued)


def _decide(record: Record, replay: Replay) -> tuple[Label, Fault]:
    limit = _limit(record)
    certificate = replay.certify(replay.start, max_rounds=limit)
    if certificate.plan is None and not certificate.unknown:
        return "budget", _at(limit, f"no plan has so few rounds: {limit}")
    faults = find_faults(record, replay)
    if _cut_short(record, limit):
        needed = _rest(record, replay)
        if needed is not None:
            return _of_lost(record, replay, faults, needed)
    return _of_faults(record, replay, faults)


def _of_lost(record: Record, replay: Replay, faults: Faults, needed: int) -> tuple[Label, Fault]:
    """The plan was on its way and the rounds ran out: who lost as many as were needed, or was it the budget?"""
    lost = lost_rounds(record, replay, faults)
    count = {kind: len(rounds) for kind, rounds in lost.items()}
    if sum(count.values()) < needed:
        what = f"the plan in force reaches the goal {needed} rounds later, and {sum(count.values())} were lost"
        return "budget", _at(len(record.outcomes), what)
    kind = max(count, key=lambda name: (count[name], -min(lost[name], default=0)))
    named = {"skill": faults.skill, "checker": faults.checker, "planner": faults.planner}[kind]
    what = f"{count[kind]} of {len(record.outcomes)} rounds were lost; the plan in force needed {needed} more"
    first = min(lost[kind])
    shown = next((fault for fault in named if fault.round in lost[kind]), None)
    if shown is None:
        return kind, _at(first, what)
    return kind, replace(shown, what=f"{shown.what}; {what}")


def _of_faults(record: Record, replay: Replay, faults: Faults) -> tuple[Label, Fault]:
    """The plan did not lead to the goal: the first fault that a plan which does lead there did not survive."""
    lasting, checker = faults.lasting[:1], faults.checker[:1]
    planned = _planned(record, replay)
    if planned and lasting and (not checker or lasting[0].round < checker[0].round):
        return "skill", lasting[0]
    first = not faults.planner or (bool(checker) and checker[0].round <= faults.planner[0].round)
    if checker and (planned or (first and not _wrong_unseen(record, replay))):
        return "checker", checker[0]
    mistake = _first_mistake(record, replay, faults)
    return ("unclear", _at(0, "the search for the shortest plan gave up")) if mistake is None else ("planner", mistake)


def _wrong_unseen(record: Record, replay: Replay) -> bool:
    """Whether every step of the first plan goes well by the table: no check of conditions could have mended it."""
    world = replay.start
    for joint in rounds_of(record.initial_plan, replay):
        if any(first_false(replay.scene, world, robot, subtask, "advise") for robot, subtask in joint.items()):
            return False
        world, outcomes = transition(replay.scene, world, {r: joint.get(r, WAIT) for r in replay.scene.robots})
        if not all(outcome.success for outcome in outcomes.values()):
            return False
    return True


def _planned(record: Record, replay: Replay) -> bool:
    """Whether the first plan, the final one or the subtasks as they were run reach the goal if no skill fails."""
    played = [turn.joint for turn in replay.rounds]
    plans = [rounds_of(record.initial_plan, replay), rounds_of(record.final_plan, replay), played]
    return any(replay.carry_out(plan, replay.start) is not None for plan in plans)


def _first_mistake(record: Record, replay: Replay, faults: Faults) -> Fault | None:
    """The first subtask that could not go well; else the first round after which the way to the goal is no shorter.

    None where that hangs on the length of a shortest plan that is not known.
    """
    if faults.planner:
        return faults.planner[0]
    shortest = replay.certify(replay.start, max_rounds=_limit(record))
    if shortest.unknown:
        return None
    left = shortest.optimum or 0
    for index, turn in enumerate(replay.rounds):
        if all(subtask == DONE for subtask in turn.joint.values()):
            return _at(index, "the plan ended, and the goal did not hold")
        found = replay.certify(turn.after, max_rounds=left)
        if found.unknown:
            return None
        if found.optimum is None or found.optimum >= left:
            told = "; ".join(f"{robot}: {subtask.text}" for robot, subtask in turn.joint.items())
            return _at(index, f"{told}: the goal is no nearer after it")
        left = found.optimum
    return _at(len(replay.rounds), "the plan ended, and the goal did not hold")


def _rest(record: Record, replay: Replay) -> int | None:
    """Rounds that what remains of the plan in force still needs, if it leads to the goal from where it stopped.

    What remains is an end of that plan; of all ends that lead to the goal the shortest counts.
    """
    plan: list[Joint] = rounds_of(record.final_plan, replay)
    needs = (replay.carry_out(plan[start:], replay.end) for start in range(len(plan)))
    return min((rounds for rounds in needs if rounds is not None), default=None)


def _limit(record: Record) -> int:
    """The rounds that kitchen and agent allow."""
    own = record.options.get("agent", {}).get("max_rounds")
    return min(cap_rounds(record), int(own)) if own is not None else cap_rounds(record)


def _cut_short(record: Record, limit: int) -> bool:
    """Whether kitchen or agent ended the episode because of its rounds."""
    played = sum(any(entry.subtask != DONE.text for entry in turn.values()) for turn in record.outcomes)
    return record.end == "truncated" or (record.end == "done" and played >= limit)


def _at(index: int, what: str) -> Fault:
    return Fault(kind="planner", round=index, robot="", subtask="", what=what)


def _labelled(record: Record, label: Label, index: int, what: str, **more: Any) -> Blame:
    return Blame(
        job=record.job,
        iteration=record.iteration,
        setting=setting(record),
        task=record.task,
        agent=record.agent,
        method=record.method,
        seed=record.seed,
        label=label,
        round=index,
        what=what,
        **more,
    )
