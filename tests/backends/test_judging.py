"""What an outcome says and the world that is told with it agree, whatever a controller or a moment shows."""

from __future__ import annotations

from typing import Any

import mujoco
import pytest
from physics_kit import ROBOT, command, kitchen, run
from timed_physics import play
from timed_plans import plan_of

import remac_env
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.scripted import controller
from remac_env.backends.physics.controllers.scripted.dispatch import motion
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.judging import Begun, judged
from remac_env.backends.physics.timeline import Timeline
from remac_env.backends.physics.truth import GRASP_LASTS, Truth
from remac_env.episode import max_seconds
from remac_env.rules.claims import Claim
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask
from remac_env.state import Place, WorldState

LONGEST = 2
"""Control periods for which a pad was seen off what it held, of 16 times in 11 episodes."""
TAKE = ["navigate to mug", "pick up mug"]


def bounce(backend: PhysicsBackend) -> None:
    """Part the fingers from what they hold by 1 mm, for this moment."""
    robot = timeline(backend).simulation.robots[ROBOT]
    backend.data.qpos[robot.finger_qpos] += 0.001
    mujoco.mj_forward(backend.model, backend.data)


def timeline(backend: PhysicsBackend) -> Timeline:
    assert backend._timeline is not None
    return backend._timeline


def truth(backend: PhysicsBackend) -> Truth:
    return timeline(backend)._truth


def test_a_pad_that_bounces_off_loses_nothing_and_a_hand_that_opens_does() -> None:
    backend, _, worlds = kitchen({"mug": "counter"}, 120700)
    assert run(backend, worlds, TAKE) == [None, None]
    bounce(backend)
    for _ in range(LONGEST):
        truth(backend).update()
    assert truth(backend).seen().robots[ROBOT].holding is None
    assert truth(backend).read().robots[ROBOT].holding == "mug"
    timeline(backend).simulation.robots[ROBOT].let_go = True
    for _ in range(2 * GRASP_LASTS):
        timeline(backend).tick()
    assert truth(backend).read().robots[ROBOT].holding is None
    assert truth(backend).read().objects["mug"].place != Place("held", ROBOT)


def test_a_moment_without_touch_between_two_ends_is_no_fall() -> None:
    backend, _, worlds = kitchen({"mug": "counter"}, 120700)
    assert run(backend, worlds, TAKE) == [None, None]
    backend.begin({ROBOT: command(worlds, "navigate to sink")})
    backend.advance(until=round(backend.clock + 1.0, 2))
    bounce(backend)
    assert backend.advance(until=backend.clock) == {}
    assert backend.world.objects["mug"].place == Place("held", ROBOT)
    assert backend.advance()[ROBOT].success


@pytest.mark.parametrize("reason", ["blocked", "slipped", "timeout"])
def test_who_gives_up_with_the_object_in_its_hand_has_picked_it_up_and_can_put_it_down(monkeypatch, reason) -> None:
    backend, _, worlds = kitchen({"mug": "counter"}, 120700)
    assert run(backend, worlds, TAKE[:1]) == [None]

    def gives_up(here: Workspace, *told: Any) -> Steps:
        yield from motion(here, *told)
        if told[-1].skill == "pick up":
            here.hand.away += 1.0
            here.hand.body = None
            raise SkillFailure(reason, "it says so itself")

    monkeypatch.setattr(controller, "motion", gives_up)
    assert run(backend, worlds, TAKE[1:]) == [None]
    assert backend.world.robots[ROBOT].holding == "mug"
    assert run(backend, worlds, ["place to counter"]) == [None]


def _begun(text: str) -> tuple[Begun, WorldState, Any]:
    env = remac_env.parallel_env("HeatOnStove", robots=1, backend="symbolic", starts="paper")
    env.reset(seed=3)
    subtask, world, scene = env.vocabulary.subtask(env.vocabulary.encode(text)), env.start.world, env.start.scene
    assert isinstance(subtask, Subtask)
    claim = Claim.of(scene, world, ROBOT, subtask, world.robots[ROBOT].station)
    return Begun(subtask, ROBOT, 0, world, claim, world), subtask.effect(scene, world, ROBOT), scene


def test_an_outcome_is_what_has_come_true_since_the_subtask_began() -> None:
    task, done, scene = _begun("pick up pan")
    success = Outcome("success", seconds=3.0)
    assert judged(task, success, scene, done) == success
    assert judged(task, success, scene, task.world).reason == "slipped"
    assert judged(task, failure("blocked", "no way", seconds=3.0), scene, done) == success
    assert judged(task, failure("blocked"), scene, task.world).reason == "blocked"
    # A drive can always be tried again; what fell has fallen; and what was true before is nobody's doing.
    assert judged(task, failure("dropped"), scene, done).reason == "dropped"
    drive, there, _ = _begun("navigate to pan")
    assert judged(drive, failure("blocked"), scene, there).reason == "blocked"
    again = Begun(task.subtask, ROBOT, 0, done, task.claim, done)
    assert judged(again, failure("blocked"), scene, done).reason == "blocked"


@pytest.mark.long
def test_a_pan_that_is_jolted_as_another_robot_goes_on_is_held() -> None:
    """As the hand that took the pan comes home, a pad bounces off its handle in the period that is read."""
    env = remac_env.parallel_env("HeatBoth", robots=2, backend="symbolic", clock="events")
    env.reset(seed=198012)
    backend = PhysicsBackend(env.worlds)
    backend.reset(env.start)
    deadline = max_seconds(env.worlds.spec, env.options)
    played = play(backend, env.start, env.goal, plan_of("HeatBoth", env.start, env.vocabulary), deadline)
    assert (played.success, played.failures) == (True, [])
