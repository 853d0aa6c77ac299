"""Small pieces of text that prompts are filled with."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from remac_agents.llm import plain
from remac_agents.roles import Attempt, PreviousTry, Ran, Report, View
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.sights import describe_sight
from remac_env.text import describe_room, describe_use

LONGEST = 300
"""Characters of one sentence that a model wrote and that goes into another prompt, a record or the memory."""


def bullets(lines: Iterable[str]) -> str:
    """One line each, "" for none."""
    return "\n".join(f"- {line}" for line in lines)


def numbered(lines: Iterable[str]) -> str:
    """One line each, counted from 1."""
    return "\n".join(f"{number}. {line}" for number, line in enumerate(lines, 1))


def commands(steps: Sequence[Subtask]) -> str:
    """Steps as a list in brackets."""
    return f"[{', '.join(step.text for step in steps)}]"


def rows(plan: Mapping[str, Sequence[str]] | None) -> str:
    """A plan as a line a robot, "" for none."""
    return "\n".join(f"{robot}: [{', '.join(row)}]" for robot, row in (plan or {}).items())


def sentences(conditions: Iterable[Condition]) -> str:
    """Conditions, one a line."""
    return bullets(condition.sentence for condition in conditions)


def one_line(text: str) -> str:
    """A model's words as one short line without control characters."""
    return plain(text, limit=LONGEST)


def held(view: View, robot: str) -> str:
    """What a robot feels in its gripper."""
    obj = view.holding.get(robot)
    return f"the {obj}" if obj else "nothing"


def room(view: View) -> dict[str, str]:
    """The fields `fixtures`, `things` and `goal`."""
    return {**names(view), "goal": view.goal}


def names(view: View) -> dict[str, str]:
    """The fields `fixtures` and `things`."""
    return {"fixtures": ", ".join(view.scene.fixtures), "things": ", ".join(view.scene.objects)}


def use(view: View) -> dict[str, str]:
    """The field `use`: what the kitchen says of rounds, places and room, without its names and states."""
    return {"use": describe_use(view.scene, clock="rounds" if view.clock is None else "events")}


def sight(view: View, shown: Iterable[tuple[str, str]]) -> dict[str, str]:
    """The fields `pictures`, `sight` and `room_for` of who looks at pictures of (robot, camera)."""
    spots = tuple(shown)
    return {
        "pictures": "; ".join(f"{robot}, {camera} camera" for robot, camera in spots),
        "sight": describe_sight(view.scene.robots, (camera for _, camera in spots)) if spots else "",
        "room_for": " ".join(describe_room(view.scene)),
    }


def rounds(ran: Iterable[Ran]) -> str:
    """Commands that were run and how each ended, a line a round; of one that fails again, how often it has by then."""
    lines: dict[int, list[str]] = {}
    failures: dict[tuple[str, str], int] = {}
    for each in ran:
        what = (each.robot, each.command)
        failures[what] = failures.get(what, 0) + each.failed
        again = f" ({failures[what]} times so far)" if each.failed and failures[what] > 1 else ""
        lines.setdefault(each.round, []).append(f"{each.robot}: {each.command}: {each.status}{again}")
    return "\n".join(f"{number}. {'; '.join(told)}" for number, told in lines.items())


def report(last: Report | None) -> str:
    """A robot's last command and how it ended."""
    if last is None:
        return "none yet"
    if last.subtask == WAIT.text:
        return "waited"
    ended = f"{last.status} ({last.reason})" if last.reason else last.status
    return f"{last.subtask}: {ended}" if last.subtask else ended


def previous_try(previous: PreviousTry | None) -> str:
    """The plan of the iteration before and how that went; "" where there was none."""
    if previous is None:
        return ""
    count = "" if previous.rounds is None else f" in {previous.rounds} round{'s' * (previous.rounds != 1)}"
    ended = f"It {'reached' if previous.success else 'did not reach'} the goal{count}."
    told = [rows(previous.plan) or "(an empty plan)", ended]
    failed = [what if often == 1 else f"{what} ({often} times)" for what, often in previous.failed.items()]
    told += [f"Commands that failed: {'; '.join(failed)}."] if failed else []
    if previous.changed:
        return "\n".join([*told, "It was changed on the way. What was run, round by round:", rounds(previous.ran)])
    return "\n".join([*told, "It was not changed on the way."])


def attempts(history: Iterable[Attempt]) -> str:
    """Steps that were run or refused, one a line, with what was found false about them."""
    return numbered(f"{attempt.robot}: {attempt.subtask.text}: {_ended(attempt)}" for attempt in history)


def _ended(attempt: Attempt) -> str:
    words = {True: "worked", False: "failed", None: "was run"}[attempt.succeeded] if attempt.ran else "was not run"
    false = "; ".join(condition.sentence for condition in attempt.false)
    why = f" ({attempt.reason})" if attempt.reason else ""
    return f"{words}{why}, not true: {false}" if false else f"{words}{why}"
