"""When one robot has mastered a task, and with which plan: what a run carried out, without what changed nothing.

False alarms of a checker add steps that come to nothing. A run that succeeded proves the steps that are left without
them, however often its plan was adjusted on the way.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from remac_agents.memory import Run
from remac_agents.plan import Commands
from remac_agents.planning.rewriting import tidy
from remac_agents.planning.whereabouts import hands
from remac_agents.roles import Ran
from remac_env.rules.facts import Rules
from remac_env.rules.scene import public_scene
from remac_env.rules.subtasks import Subtask

Steps = tuple[Subtask, ...]

Done = tuple[Subtask, bool | None]
"""A subtask that was run, and whether it succeeded, where that was told."""


def proven_plan(runs: Sequence[Run], commands: Commands, facts: Rules, *, last: bool = False) -> Steps | None:
    """The single-robot plan of a task that is mastered, or None.

    A run by one robot that succeeded masters it if its plan was not adjusted, or came out no longer than it was
    planned or than an earlier one came out: there is nothing left to learn. A run by several robots that failed
    takes the mastery away again.

    Args:
        runs: those of the task, oldest first.
        last: no other iteration follows; any success counts then, and the shortest plan is taken.
    """
    mastered: Steps | None = None
    best: Steps | None = None
    for run in runs:
        if len(run.initial_plan) > 1:
            mastered, best = (mastered, best) if run.success else (None, None)
            continue
        planned = _read([text for row in run.initial_plan.values() for text in row], commands)
        came_out = planned if not run.adjusted else carried_out(run, commands, facts, planned or ())
        if not run.success or not came_out:
            mastered = None
            continue
        refuted = best == planned != came_out  # it was tried, and more was needed
        shorter = best is None or refuted or len(came_out) <= len(best)
        settled = best is not None and shorter and not refuted
        efficient = not run.adjusted or len(came_out) <= len(planned or ()) or settled
        mastered = came_out if efficient else None
        best = came_out if shorter else best
    return mastered or (best if last else None)


def late_plan(runs: Sequence[Run], commands: Commands) -> Steps | None:
    """A single-robot plan with which nothing is wrong but that it takes too long, or None.

    In the last run by one robot all that it did by its plan succeeded, and the rest was still to be done when the
    episode ended. A run by several robots that failed takes it away again.
    """
    late: Steps | None = None
    for run in runs:
        if len(run.initial_plan) == 1:
            late = _read(_cut_short(run), commands)
        elif not run.success:
            late = None
    return late or None


def unkept_plan(runs: Sequence[Run], commands: Commands) -> tuple[Steps, Steps] | None:
    """A single-robot plan of which something came undone by itself, and the steps that did; or None.

    In the last run by one robot such a step had been done, and was done once more after the robot had been elsewhere,
    though nobody had undone it. A run by several robots that failed takes it away again.
    """
    return _last_alone(runs, commands, _came_undone)


def unaided_plan(runs: Sequence[Run], commands: Commands) -> tuple[Steps, Steps] | None:
    """A single-robot plan with switches that never came on or went off, however often it was tried, and which; or None.

    A run by several robots that failed takes it away again.
    """
    return _last_alone(runs, commands, _never_came_about)


def _last_alone(
    runs: Sequence[Run], commands: Commands, wanting: Callable[[Subtask, Sequence[Done]], bool]
) -> tuple[Steps, Steps] | None:
    """The plan of the last run by one robot, if it failed, and which of its steps that last were wanting."""
    found: tuple[Steps, Steps] | None = None
    for run in runs:
        if len(run.initial_plan) > 1:
            found = found if run.success else None
            continue
        planned = _read([text for row in run.initial_plan.values() for text in row], commands) or ()
        entries = [ran for line in run.action_list if (ran := Ran.read(line)) is not None]
        done = [(step, ran.succeeded) for ran in entries if (step := commands.parse(ran.command)) is not None]
        steps = tuple(step for step in dict.fromkeys(planned) if step.row.lasting and wanting(step, done))
        found = (planned, steps) if steps and not run.success else None
    return found


def _came_undone(step: Subtask, done: Sequence[Done]) -> bool:
    """Whether a step was done, and again after a drive, though nothing else had been done to its target that lasts."""
    driven: bool | None = None  # since it was done; None: it is not
    for each in (other for other, succeeded in done if succeeded):
        if each == step and driven:
            return True
        if each.row.lasting and each.target == step.target:
            driven = False if each == step else None
        elif each.moves and driven is not None:
            driven = True
    return False


def _never_came_about(step: Subtask, done: Sequence[Done]) -> bool:
    told = [succeeded for each, succeeded in done if each == step]
    return step.row.target == "switch" and False in told and True not in told


def _cut_short(run: Run) -> Sequence[str]:
    """The one row of a run that the end of its episode cut short; nothing where it went otherwise."""
    ((robot, row),) = run.initial_plan.items()
    entries = [ran for line in run.action_list if (ran := Ran.read(line)) is not None and ran.robot == robot]
    done = [ran.command for ran in entries if ran.succeeded]
    cut = [ran.command for ran in entries if not ran.succeeded]
    as_planned = not run.success and not run.adjusted and done == list(row[: len(done)])
    return row if as_planned and len(done) < len(row) and cut in ([], [row[len(done)]]) else ()


def carried_out(run: Run, commands: Commands, facts: Rules, planned: Steps) -> Steps | None:
    """What one robot did, without steps that failed and detours; None for what this kitchen has no command for."""
    entries = (Ran.read(line) for line in run.action_list)
    steps = _read([ran.command for ran in entries if ran is not None and ran.succeeded], commands)
    return None if steps is None else without_detours(steps, facts, planned)


def without_detours(steps: Sequence[Subtask], facts: Rules, planned: Steps) -> Steps:
    """The steps without idle ways, and without objects that were put down on a plain surface and taken up again.

    Where other work was done between, the object was fetched too early; that holds only if the plan itself had the
    fetch before that work. One that came in later may have been what made the work possible.
    """
    old: list[Subtask] = []
    scene = public_scene(facts)
    new = tidy(steps, scene)
    while new != old:
        old = new
        new = tidy(_without_one_rest(new, facts, planned), scene)
    return tuple(new)


def _without_one_rest(steps: list[Subtask], facts: Rules, planned: Steps) -> list[Subtask]:
    held = hands(steps)
    for down, step in enumerate(steps):
        if not step.row.puts or not _is_plain(step.target, facts):
            continue
        fetch = Subtask("pick up", held[down] or "")
        work = [(i, other) for i, other in enumerate(steps) if not other.moves]
        again = next((i for i, other in work if i > down and held[down] in (other.target, held[i])), None)
        between = [other for i, other in work if again is not None and down < i < again]
        if again is None or steps[again] != fetch:
            continue
        taken = max(i for i in range(down) if steps[i] == fetch)
        early = any(taken < i < down for i, _ in work) or fetch not in planned
        first = planned[: planned.index(fetch)] if fetch in planned else ()
        if not between:
            return [other for i, other in enumerate(steps) if i not in (down, again)]
        if not early and not set(between) & set(first):
            return [other for i, other in enumerate(steps) if i not in (taken, down)]
    return steps


def _is_plain(target: str, facts: Rules) -> bool:
    """Whether putting an object there does nothing else to it."""
    fixture = facts.fixtures.get(target)
    basins = {basin for _, under in facts.taps for basin in under}
    return fixture is not None and not fixture.door and not fixture.switches and target not in basins


def _read(texts: Sequence[str], commands: Commands) -> Steps | None:
    steps = [commands.parse(text) for text in texts]
    return tuple(step for step in steps if step is not None) if None not in steps else None
