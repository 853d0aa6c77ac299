"""check_task: all checks on one task, with the symbolic backend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from remac_env.options import WORDINGS
from remac_env.oracle import certify, most_states
from remac_env.oracle.witness import witness
from remac_env.tasks import get
from remac_env.tasks.spec import TaskSpec
from remac_env.testing.actions import check_actions, check_masks
from remac_env.testing.changes import check_changes
from remac_env.testing.commands import check_commands
from remac_env.testing.determinism import check_determinism
from remac_env.testing.lifecycle import check_lifecycle
from remac_env.testing.names import check_names
from remac_env.testing.play import EnvMaker, expect, opened, play, scripted
from remac_env.testing.spaces import check_spaces
from remac_env.testing.text import check_text
from remac_env.vocabulary import built_in

MOST_STATES = 5_000
"""States that the search for a shortest plan looks at."""


def check_task(
    task: str | TaskSpec,
    *,
    seeds: Sequence[int] = (0, 1),
    rounds: int = 30,
    robots: Sequence[int] = (1, 2),
    starts: Sequence[str] = ("paper", "mixed"),
) -> None:
    """Run every check of this package on a task, with the symbolic backend.

    And look at its certificate: no start is solved or lost, each can be solved, and the shortest plan, carried out,
    reaches the goal in exactly as many rounds as it has. Built-in tokens keep their numbers.

    Args:
        task: a name, or a spec that need not be registered.
        seeds: seeds of the episodes that are looked at.
        rounds: length of the random episodes.
        robots: how many robots.
        starts: kinds of starts; each with each number of robots.

    Raises:
        ContractError: naming the check, the seed and the round at fault.
    """
    spec = task if isinstance(task, TaskSpec) else get(task)
    for count in robots:
        for kind in starts:
            make = _maker(spec, robots=count, starts=kind)
            check_certificate(make, seeds=seeds)
            check_commands(make, seeds=seeds)
            check_spaces(make, seeds=seeds, rounds=rounds)
            check_changes(make, seeds=seeds, rounds=max(rounds, 30))
            check_determinism(make, seeds=seeds, rounds=rounds)
            check_names(make, seeds=seeds, rounds=rounds)
            check_text(make, seeds=seeds, rounds=rounds)
        check_masks(make, seeds=seeds[:1])
        check_actions(make, seed=seeds[0])
        check_lifecycle(make, seed=seeds[0])
    _check_words(spec, seeds[0])


def check_certificate(env_fn: EnvMaker, *, seeds: Sequence[int] = (0, 1)) -> None:
    """Every start is open and can be solved, and the shortest plan, carried out, ends the episode in its last round.

    Where the search for the shortest plan gives up, a plan that is put together part after part has to end it too.
    In physics, where subtasks can fail, the plan need not succeed: this check is for the symbolic backend.

    Raises:
        ContractError: with the seed at fault.
    """
    with opened(env_fn) as env:
        wait = env.vocabulary.encode("wait")
        for seed in seeds:
            where = f"check_certificate, seed {seed}"
            _, infos = env.reset(seed=seed)
            scene, world, goal = env.start.scene, env.world, env.goal
            expect(not goal.holds(scene, world), f"{where}: the goal holds at the start: {goal.text}")
            expect(not any(info["success"] for info in infos.values()), f"{where}: success is told at the start")
            certificate = certify(scene, world, goal, max_states=min(MOST_STATES, most_states(scene)))
            plan, shortest = certificate.plan, certificate.optimum is not None
            if plan is None and certificate.proof != "exhausted":
                plan = witness(scene, world, goal)
            why = "no plan reaches the goal" if certificate.proof == "exhausted" else "no plan was found to the goal"
            expect(plan is not None, f"{where}: {why}: {goal.text}")
            if plan is None:
                return
            script = [{r: env.vocabulary.encode(s.text) for r, s in joint.items()} for joint in plan.rounds]
            turns = list(play(env, seed, scripted(script, otherwise=wait), rounds=plan.length + 1))
            reached = turns[-1].number
            told = f"the {'shortest' if shortest else 'best known'} plan has {plan.length} rounds: {plan.as_text()}"
            as_long = reached == plan.length or (reached < plan.length and not shortest)
            expect(as_long, f"{where}: {told}, but the episode ended after round {reached}")
            won = all(info["success"] for info in turns[-1].infos.values()) and all(turns[-1].terminations.values())
            expect(won, f"{where}: {told}, but it does not end with success")


def _maker(spec: TaskSpec, **options: Any) -> EnvMaker:
    # Imported here, so that the other checks can be had without the environment of this project.
    from remac_env.envs.parallel import KitchenParallelEnv
    from remac_env.options import Options

    return lambda: KitchenParallelEnv(spec, Options(backend="symbolic", **options))


def _check_words(spec: TaskSpec, seed: int) -> None:
    """The three wordings are complete sentences, and the built-in tokens have not moved."""
    for wording in WORDINGS:
        with opened(_maker(spec, wording=wording)) as env:
            _, infos = env.reset(seed=seed)
            sentences = {info["goal"] for info in infos.values()}
            expect(len(sentences) == 1, f"check_task: the robots are told of different goals: {sentences}")
            goal = sentences.pop()
            whole = goal.strip() and "{" not in goal and goal == goal.strip(" .")
            expect(whole, f"check_task: wording {wording} of {spec.name} is not a sentence without stop: {goal!r}")
            moved = [t for t in range(len(built_in())) if env.vocabulary.decode(t) != built_in().decode(t)]
            expect(not moved, f"check_task: built-in tokens {moved} mean something else")
