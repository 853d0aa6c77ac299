"""What went wrong in an episode, round by round: faults of skills, of the checker and of the planner."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from remac_bench.blame.replay import Replay, ReplayedRound, is_work
from remac_bench.judging.alarms import derailments, detours, is_false_alarm, is_miss, runs
from remac_bench.records import CheckEntry, Record
from remac_env.rules.claims import first_false
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import WAIT
from remac_env.state import FLOOR

Kind = Literal["planner", "checker", "skill"]


@dataclass(frozen=True, kw_only=True)
class Fault:
    """One thing that went wrong in round `round` (an index of the record's outcomes), in words."""

    kind: Kind
    round: int
    robot: str
    subtask: str
    what: str


@dataclass(frozen=True, kw_only=True)
class Faults:
    """All of an episode, each list in the order of the rounds.

    Attributes:
        skill: subtasks that failed though the table says that they succeed; of these
        lasting: those that were not made good by running them again at once, nor waved through;
        waved: those of which the checker was asked afterwards, and said that all was well.
        checker: wrong verdicts that were acted upon, `waved` among them.
        planner: subtasks that the table says are refused, fail or are wrong, where no checker vouched for them.
    """

    skill: tuple[Fault, ...]
    lasting: tuple[Fault, ...]
    waved: tuple[Fault, ...]
    checker: tuple[Fault, ...]
    planner: tuple[Fault, ...]


def find_faults(record: Record, replay: Replay) -> Faults:
    """The faults of an episode that was played again."""
    skill = [fault for index, turn in enumerate(replay.rounds) for fault in _slips(replay.scene, index, turn)]
    passed = {(c.round - 1, c.robot, c.subtask) for c in record.post_checks if is_miss(c)}
    caught = {(c.round - 1, c.robot, c.subtask) for c in record.post_checks if c.verdict is False}
    waved = [fault for fault in skill if _key(fault) in passed - caught]
    lasting = [fault for fault in skill if fault not in waved and not _made_good(replay, fault)]
    checker = sorted([*_wrong_verdicts(record, replay), *map(_as_waved, waved)], key=lambda fault: fault.round)
    vouched = {_key(fault) for fault in checker}
    planner = [fault for index, turn in enumerate(replay.rounds) for fault in _mistakes(replay.scene, index, turn)]
    return Faults(
        skill=tuple(skill),
        lasting=tuple(lasting),
        waved=tuple(waved),
        checker=tuple(checker),
        planner=tuple(fault for fault in planner if _key(fault) not in vouched),
    )


def lost_rounds(record: Record, replay: Replay, faults: Faults) -> dict[Kind, set[int]]:
    """Rounds that brought nothing, each counted once: failed skills, false alarms, mistakes, and ways in circles.

    The rounds between two moments in which the world was the same count for the last fault before them, or for the
    planner where there was none.
    """
    lost: dict[Kind, set[int]] = {"skill": {fault.round for fault in faults.skill}, "checker": set(), "planner": set()}
    vouched = {fault.round for fault in faults.checker if fault.round < len(replay.rounds)}
    lost["checker"] = (set(detours(record)) | vouched) - lost["skill"]
    lost["planner"] = {fault.round for fault in faults.planner} - lost["checker"] - lost["skill"]
    causes = sorted([*faults.skill, *faults.checker, *faults.planner], key=lambda fault: fault.round)
    for index in sorted(_circles(replay) - set().union(*lost.values())):
        before = [fault.kind for fault in causes if fault.round <= index]
        lost[before[-1] if before else "planner"].add(index)
    return lost


def _circles(replay: Replay) -> set[int]:
    """The rounds after which the world was as it had been before, and those on the way round."""
    way, lost = [(replay.start, -1)], set()
    for index, turn in enumerate(replay.rounds):
        seen = next((place for place, (world, _) in enumerate(way) if world == turn.after), None)
        if seen is None:
            way.append((turn.after, index))
            continue
        lost |= {at for _, at in way[seen + 1 :]} | {index}
        way = way[: seen + 1]
    return lost


def _key(fault: Fault) -> tuple[int, str, str]:
    return (fault.round, fault.robot, fault.subtask)


def _slips(scene: Rules, index: int, turn: ReplayedRound) -> Iterable[Fault]:
    """Skills that did not do what the table says."""
    for robot, entry in turn.outcomes.items():
        if not is_work(entry) or not turn.expected[robot].success:
            continue
        subtask, held = turn.joint[robot], turn.before.robots[robot].holding
        promised = [c for c in subtask.achieves(robot, held) if c.holds(scene, turn.table)]
        broken = next((c.sentence for c in promised if not c.holds(scene, turn.after)), None)
        if entry.status != "success" and subtask != WAIT:
            yield _fault("skill", index, robot, entry.subtask, f"failed: {entry.reason or 'no reason'}")
        elif broken is not None:
            yield _fault("skill", index, robot, entry.subtask, f"reported success, but not true: {broken}")
    for name, item in turn.after.objects.items():
        fell = item.place == FLOOR and FLOOR not in (turn.table.objects[name].place, turn.before.objects[name].place)
        if fell and all(entry.status == "success" for entry in turn.outcomes.values()):
            robot, entry = next(iter(sorted(turn.outcomes.items())))
            yield _fault("skill", index, robot, entry.subtask, f"the {name} fell to the floor")


def _mistakes(scene: Rules, index: int, turn: ReplayedRound) -> Iterable[Fault]:
    """Subtasks that could not succeed, or ought not to be run, in the world before them."""
    for robot, entry in turn.outcomes.items():
        if not is_work(entry):
            continue
        subtask = turn.joint[robot]
        if subtask == WAIT:
            yield _fault("planner", index, robot, entry.subtask, "names nothing in this kitchen")
            continue
        wrong = first_false(scene, turn.before, robot, subtask, "advise")
        expected = turn.expected[robot]
        if not expected.success:
            yield _fault("planner", index, robot, entry.subtask, f"{expected.reason}: {expected.detail}")
        elif wrong is not None:
            yield _fault("planner", index, robot, entry.subtask, f"not true: {wrong.condition.sentence}")


def _wrong_verdicts(record: Record, replay: Replay) -> Iterable[Fault]:
    """Wrong verdicts that were acted upon."""
    rounds = replay.rounds
    found = {(c.round, c.robot, c.subtask) for c in record.pre_checks if c.truth is False and c.verdict is False}
    for check in record.pre_checks:
        key = (check.round, check.robot, check.subtask)
        ran = check.round < len(rounds) and runs(record, check.round, check)
        if check.asked and None not in (check.truth, check.verdict) and check.truth != check.verdict:
            yield _verdict(check, check.round, "the adjuster asked, and was told wrongly")
        elif is_miss(check) and ran and key not in found:
            yield _verdict(check, check.round, "called true before the subtask, and is false")
    for check in derailments(record):
        yield _verdict(check, check.round, "called false before the subtask, and is true")
    for check in record.post_checks:
        again = check.round < len(rounds) and runs(record, check.round, check)
        if is_false_alarm(check) and again and rounds[check.round].after != rounds[check.round].before:
            yield _verdict(check, check.round, "called false after the subtask, and is true")


def _made_good(replay: Replay, fault: Fault) -> bool:
    """Whether the subtask was run again and again, without anything else between, until it succeeded."""
    for turn in replay.rounds[fault.round + 1 :]:
        entry = turn.outcomes[fault.robot]
        if entry.subtask == fault.subtask and entry.status == "success":
            return True
        if entry.subtask not in (fault.subtask, WAIT.text):
            return False
    return False


def _as_waved(fault: Fault) -> Fault:
    what = f"{fault.what}; the checker said that it went well"
    return _fault("checker", fault.round, fault.robot, fault.subtask, what)


def _verdict(check: CheckEntry, index: int, how: str) -> Fault:
    return _fault("checker", index, check.robot, check.subtask, f'"{check.condition}": {how}')


def _fault(kind: Kind, index: int, robot: str, subtask: str, what: str) -> Fault:
    return Fault(kind=kind, round=index, robot=robot, subtask=subtask, what=what)
