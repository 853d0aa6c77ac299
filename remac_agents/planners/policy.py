"""The planner that is a trained policy: it plays forward in the skill table and writes down what it does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from remac_agents.plan import Plan, PlanError
from remac_agents.planners.oracle import for_robots
from remac_agents.planners.policy_file import Policy, read_policy
from remac_agents.roles import PlanRequest
from remac_env.observation import Facts
from remac_env.rules.claims import feasible
from remac_env.rules.facts import Rules
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import DONE, WAIT, Subtask
from remac_env.state import WorldState

LONGEST = 40
"""Rounds that are played forward at most: more than the longest shortest plan of any built-in start."""


class PolicyPlanner:
    """The greedy plan of a policy, from the true state: its observations are facts of the WorldState.

    A policy that learnt with one robot commands the leading robot alone; one that learnt with more chooses for as many
    of those that are planned for. The plan ends where the goal holds in the table, where the policy says `done`, or
    where it comes back to a world where it has been.

    Args:
        path: a file of `policy_file.save_policy`.
        sha256: the file's digest, 64 hexadecimal digits, so that records name the numbers and not the file alone; "":
            not looked at.

    Raises:
        OptionError: if the file cannot be read, is not a policy, or has another digest.
    """

    needs_truth = needs_rules = True

    def __init__(self, path: str, sha256: str = "") -> None:
        self._policy, self._path = read_policy(path, sha256=sha256), path
        self._facts = Facts(self._policy.vocabulary, self._policy.robots)

    def plan(self, request: PlanRequest) -> Plan | PlanError:
        """What the policy would do, or an error where it has learnt another task or other words."""
        if request.world is None or request.rules is None or request.goal_test is None:
            return PlanError("the policy was not given the truth")
        task, policy = str(request.episode.get("task", "")), self._policy
        if task not in policy.tasks:
            return PlanError(f"{self._path} has not learnt {task!r}; it has learnt {', '.join(policy.tasks)}")
        strange = {*request.rules.objects, *request.rules.fixtures} - {noun.name for noun in policy.vocabulary.nouns}
        if strange:
            return PlanError(f"{self._path} does not know {', '.join(sorted(strange))}")
        robots = (request.lead, *(name for name in request.robots if name != request.lead))[: policy.robots]
        scene, world = for_robots(request.rules, request.world, robots)
        choices = _Choices(policy, self._facts, task, scene)
        rows: dict[str, list[Subtask]] = {robot: [] for robot in request.robots}
        been: set[WorldState] = set()
        while not request.goal_test.holds(scene, world) and world not in been and len(been) < LONGEST:
            been.add(world)
            joint = choices.joint(world)
            if DONE in joint.values():
                break
            for robot, step in joint.items():
                rows[robot].append(step)
            world, _ = transition(scene, world, joint)
        return Plan.of(rows)


class _Choices:
    """What a policy chooses in one kitchen."""

    def __init__(self, policy: Policy, facts: Facts, task: str, scene: Rules) -> None:
        self._policy, self._facts, self._task, self._scene = policy, facts, task, scene
        self._legal = {token: policy.vocabulary.subtask(token) for token in policy.vocabulary.legal(scene).values()}

    def joint(self, world: WorldState) -> dict[str, Subtask]:
        """Robot -> the subtask of the highest score among those that the masks allow."""
        seen = self._facts.vectors(self._scene, world, self._scene.robots)
        return {robot: self._best(world, robot, facts) for robot, facts in seen.items()}

    def _best(self, world: WorldState, robot: str, facts: NDArray[np.float32]) -> Subtask:
        scores = self._policy.scores(facts, self._task)
        allowed = [
            token
            for token, subtask in self._legal.items()
            if self._policy.masks == "grammar" or feasible(self._scene, world, robot, subtask)
        ]
        return self._legal[max(allowed, key=lambda token: float(scores[token]))] if allowed else WAIT
