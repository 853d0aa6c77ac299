"""Controllers of one's own: what they sense, how they mix with scripted ones, and that nothing bad reaches MuJoCo."""

from __future__ import annotations

import copy
from collections.abc import Generator, Sequence
from dataclasses import fields

import mujoco
import numpy as np
import pytest
from physics_kit import ROBOT, command, kitchen, run

from remac_env.backends.physics import pilot, timeline
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.base import Command, CommandError, MakeController, Sensing, set_points
from remac_env.backends.physics.pose import Pose
from remac_env.backends.physics.sensing import Briefed
from remac_env.errors import LifecycleError, OptionError, PhysicsError, UnknownNameError
from remac_env.kitchen.frame import WORLD, Frame
from remac_env.robots import bodies
from remac_env.robots.panda import measures as panda
from remac_env.robots.rotation import about_z
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.subtasks import Subtask

Run = Generator[Command, None, Outcome]
MUG = {"mug": "counter"}
TO_MICROWAVE = "navigate to microwave"


def hold(sensing: Sensing) -> Command:
    """The command that changes nothing."""
    return Command(sensing.body.commanded, sensing.body.commanded_opening)


class Liar:
    """Does nothing for half a second and says that it succeeded."""

    def run(self, subtask: Subtask, sensing: Sensing) -> Run:
        for _ in range(10):
            yield hold(sensing)
        return Outcome("success")


class Endless:
    """Never stops."""

    def run(self, subtask: Subtask, sensing: Sensing) -> Run:
        while True:
            yield hold(sensing)


class Stubborn:
    """Never stops, and does not want to be stopped."""

    def run(self, subtask: Subtask, sensing: Sensing) -> Run:
        while True:
            try:
                yield hold(sensing)
            except GeneratorExit:
                yield hold(sensing)


class Raising:
    """Raises after its first command."""

    def run(self, subtask: Subtask, sensing: Sensing) -> Run:
        yield hold(sensing)
        raise ZeroDivisionError("by design")


class Quitter:
    """Gives up with a reason of its own."""

    def run(self, subtask: Subtask, sensing: Sensing) -> Run:
        yield hold(sensing)
        return failure("unreachable", "too far for me")


class Wordless:
    """Returns nothing."""

    def run(self, subtask: Subtask, sensing: Sensing) -> Run:
        yield hold(sensing)
        return None  # type: ignore[return-value]


class Tangled:
    """Presses the forearm against the upper arm, as no path may, and says that it is done."""

    ARM = (0.24, 0.57, -1.14, -0.76, -2.96, -1.24, 2.54, 0.43)

    def run(self, subtask: Subtask, sensing: Sensing) -> Run:
        start = sensing.body.commanded
        end = np.array([*start[:3], *self.ARM])
        for share in np.linspace(0.0, 1.0, 60):
            yield Command(start + share * (end - start), sensing.body.commanded_opening)
        for _ in range(10):
            yield Command(end, sensing.body.commanded_opening)
        return Outcome("success")


def saying(given: object) -> MakeController:
    """Makes a controller that gives this for a command."""

    class Saying:
        def run(self, subtask: Subtask, sensing: Sensing) -> Run:
            yield hold(sensing)
            yield given  # type: ignore[misc]
            return Outcome("success")

    return Saying


def replaying(commands: Sequence[Command]) -> MakeController:
    """Makes a controller that gives recorded commands."""

    class Replaying:
        def run(self, subtask: Subtask, sensing: Sensing) -> Run:
            yield from commands
            return Outcome("success")

    return Replaying


NAN, LOW = np.full(11, np.nan), panda.tucked(0.0, 0.0, 0.0)
WRONG = {
    "nan": (Command(NAN, 0.04), "not finite"), "no finger": (Command(LOW, float("inf")), "not finite"),
    "short": (Command(LOW[:10], 0.04), r"shape \(10,\); valid: \(11,\)"), "none": (None, "not NoneType"),
    "array": (LOW, "not ndarray"), "words": (Command(["far"] * 11, 0.04), "no number"),  # type: ignore[arg-type]
    "frame": (Command(LOW, 0.04, "wall"), "frame is a str"),  # type: ignore[arg-type]
}  # fmt: skip


def turned_on(make: MakeController, *, seed: int = 120700) -> tuple[PhysicsBackend, Outcome, float]:
    """A microwave that a controller was to turn on: the backend, the outcome, and the largest change of a position."""
    backend, _, worlds = kitchen(MUG, seed, controllers={"turn on": make})
    assert run(backend, worlds, [TO_MICROWAVE]) == [None]
    before = backend.positions()
    outcome = backend.run_round({ROBOT: command(worlds, "turn on microwave")}).outcomes[ROBOT]
    return backend, outcome, float(np.abs(backend.positions() - before).max())


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_command_reaches_no_servo(name: str) -> None:
    given, why = WRONG[name]
    with pytest.raises(CommandError, match=why):
        set_points(given, bodies.get())


@pytest.mark.parametrize("name", ["nan", "none"])
def test_a_wrong_command_ends_its_subtask(name: str) -> None:
    backend, outcome, moved = turned_on(saying(WRONG[name][0]))
    assert outcome.reason == "invalid" and outcome.seconds < 1.0, outcome
    assert moved < 0.02 and np.isfinite(backend.data.ctrl).all() and np.isfinite(backend.data.qpos).all()


def test_without_the_check_it_would_reach_mujoco(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pilot, "set_points", lambda given, body: (given.q, given.opening))
    with pytest.raises(PhysicsError, match="not finite"):
        turned_on(saying(WRONG["nan"][0]))


def test_commands_are_clipped_to_what_the_maker_allows() -> None:
    far = Command(np.full(11, 1e6), 1.0)
    q, opening = set_points(far, bodies.get())
    assert opening == panda.FINGER_OPEN and (q[3:] <= panda.HIGHEST[3:]).all()
    backend, _, worlds = kitchen(MUG, 120701, controllers={"turn on": saying(far)})
    run(backend, worlds, [TO_MICROWAVE])
    handle, steps = backend._begun().simulation.robots[ROBOT], list[np.ndarray]()
    backend.watch = lambda: steps.append(handle.commanded)
    run(backend, worlds, ["turn on microwave"])
    change = np.abs(np.diff(np.array(steps), axis=0))
    assert (change <= panda.TOP_SPEED * 0.05 + 1e-9).all() and change.max() > 0.04


def test_a_controllers_word_counts_for_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    assert turned_on(Liar)[1].reason == "slipped"
    monkeypatch.setattr(timeline, "judged", lambda task, outcome, rules, world: outcome)
    assert turned_on(Liar)[1].success, "as it would be if its word counted"


@pytest.mark.parametrize("make", [Endless, Stubborn])
def test_one_that_never_stops_is_stopped(make: MakeController, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pilot, "SKILL_TIME", 3.0)
    backend, outcome, _ = turned_on(make)
    assert outcome.reason == "timeout" and outcome.seconds == pytest.approx(3.0, abs=1.0), outcome
    assert not backend.busy


def test_one_that_raises_fails_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = turned_on(Raising)[1]
    assert outcome.reason == "invalid" and "Raising raised ZeroDivisionError: by design" in outcome.detail
    monkeypatch.setattr(pilot, "guarded", lambda controller, subtask, sensing: controller.run(subtask, sensing))
    with pytest.raises(ZeroDivisionError):
        turned_on(Raising)


@pytest.mark.parametrize(("pieces", "reason"), [(pilot._PIECES, None), (0, "blocked")])
def test_an_arm_that_finds_no_way_goes_back_as_it_came(
    monkeypatch: pytest.MonkeyPatch, pieces: int, reason: str | None
) -> None:
    monkeypatch.setattr(pilot, "_PIECES", pieces)
    backend, _, worlds = kitchen(MUG, 120700, controllers={"turn on": Tangled})
    assert run(backend, worlds, [TO_MICROWAVE, "turn on microwave", "navigate to counter"])[-1] == reason


def test_one_may_give_up_with_a_reason_and_must_return_an_outcome() -> None:
    outcome = turned_on(Quitter)[1]
    assert (outcome.reason, outcome.detail) == ("unreachable", "too far for me")
    outcome = turned_on(Wordless)[1]
    assert outcome.reason == "invalid" and "returned NoneType; valid: Outcome" in outcome.detail


def recorded(backend: PhysicsBackend, texts: Sequence[str], worlds: object) -> list[list[Command]]:
    """The commands of the scripted controllers for some subtasks, which all succeed."""
    handle, taken = backend._begun().simulation.robots[ROBOT], list[Command]()
    backend.watch = lambda: taken.append(Command(handle.commanded, handle.grip))
    found = []
    for text in texts:
        taken.clear()
        assert run(backend, worlds, [text]) == [None], text  # type: ignore[arg-type]
        found.append(list(taken))
    return found


def test_controllers_mix_by_skill() -> None:
    """Drive and grasp as recorded, all else scripted: hands and places are known to those that go on."""
    texts = ["navigate to mug", "pick up mug", "navigate to sink", "place to sink"]
    backend, _, worlds = kitchen(MUG, 120702)
    drive, pick, *_ = recorded(backend, texts, worlds)
    own = {"pick up": replaying(pick)}
    backend, _, worlds = kitchen(MUG, 120702, controllers=own)
    assert run(backend, worlds, texts) == [None] * 4
    backend, _, worlds = kitchen(MUG, 120702, controllers={**own, "navigate to": replaying(drive)})
    assert run(backend, worlds, texts[:2]) == [None] * 2
    assert backend.world.robots[ROBOT].holding == "mug"
    other = copy.deepcopy(backend)
    assert (backend.positions() == other.positions()).all()
    assert run(backend, worlds, texts[2:3]) == ["blocked"], "the recorded drive leads elsewhere"


def test_controllers_are_for_skills_and_drives_for_one_robot() -> None:
    with pytest.raises(UnknownNameError, match="'juggle'; valid: .*pick up"):
        PhysicsBackend(controllers={"juggle": Liar})
    with pytest.raises(UnknownNameError, match="'wait'"):
        PhysicsBackend(controllers={"wait": Liar})
    with pytest.raises(OptionError, match="'navigate to' knows no other robot"):
        kitchen(MUG, 120703, robots=("robot_0", "robot_1"), controllers={"navigate to": Liar})


def test_two_robots_go_on_while_ones_controller_fails() -> None:
    backend, _, worlds = kitchen(MUG, 120704, robots=("robot_0", "robot_1"), controllers={"turn on": Raising})
    there = {"robot_0": "navigate to microwave", "robot_1": "navigate to sink"}
    outcomes = backend.run_round({robot: command(worlds, text) for robot, text in there.items()}).outcomes
    assert all(outcome.success for outcome in outcomes.values())
    both = {"robot_0": "turn on microwave", "robot_1": "navigate to stove"}
    outcomes = backend.run_round({robot: command(worlds, text) for robot, text in both.items()}).outcomes
    assert outcomes["robot_0"].reason == "invalid" and outcomes["robot_1"].success


# -- what is sensed ------------------------------------------------------------------------------------------------


class Looking:
    """Keeps what it sensed, and does nothing."""

    seen: list[Briefed]

    def run(self, subtask: Subtask, sensing: Sensing) -> Run:
        assert isinstance(sensing, Briefed)
        type(self).seen.append(sensing)
        yield hold(sensing)
        return Outcome("success")


def sensed(noise: float) -> tuple[PhysicsBackend, Briefed]:
    Looking.seen = []
    backend, _, worlds = kitchen(MUG, 120705, noise=noise, controllers={"turn on": Looking})
    run(backend, worlds, [TO_MICROWAVE, "turn on microwave"])
    return backend, Looking.seen[-1]


def test_everything_but_the_robot_is_seen_with_noise() -> None:
    for noise in (0.0, 0.02):
        backend, sensing = sensed(noise)
        data, model = backend.data, backend.model
        sites = {model.site(k).name: data.site_xpos[k] for k in range(model.nsite)}
        bodies = {model.body(k).name: data.xpos[k] for k in range(model.nbody)}
        names = ["mug", *(name for name in (*sites, *bodies) if name.startswith(("microwave/", "faucet/", "cabinet/")))]
        assert len(names) > 4
        for name in names:
            off = float(np.abs(sensing.pose(name).position - {**bodies, **sites}[name]).max())
            assert (off > 1e-4) == (noise > 0.0), (name, off)
        for name, middle in sensing.layout.middles.items():
            off = float(np.abs(sensing.slot(name).position - np.array(middle)).max())
            assert (off > 1e-4) == (noise > 0.0), (name, off)
        np.testing.assert_array_equal(sensing.body.q, backend._begun().simulation.robots[ROBOT].q)
        np.testing.assert_array_equal(sensing.body.grip.position, sites[f"{ROBOT}/grip"])


def test_nothing_sensed_leads_to_the_simulation() -> None:
    backend, sensing = sensed(0.0)
    for name in (name for name in dir(sensing) if not name.startswith("_")):
        assert not isinstance(getattr(sensing, name), mujoco.MjData | mujoco.MjModel), name
    assert all(field.name.startswith("_") or field.name in dir(Sensing) for field in fields(Briefed))
    before = backend.positions()
    for array in (sensing.body.q, sensing.body.commanded, sensing.body.grip.position, sensing.pose("mug").position):
        array += 1.0
    assert (backend.positions() == before).all()
    assert np.abs(backend._begun().simulation.robots[ROBOT].commanded).max() < 10.0
    with pytest.raises(UnknownNameError, match="'unicorn'; valid: .*mug"):
        sensing.pose("unicorn")
    with pytest.raises(UnknownNameError, match="fixture 'unicorn'"):
        sensing.reading("unicorn")


def test_pictures_are_drawn_when_asked_for() -> None:
    backend, sensing = sensed(0.0)
    with pytest.raises(LifecycleError, match="nothing draws"):
        sensing.pictures()
    asked = []
    backend._begun().simulation.pictures = lambda robot: asked.append(robot) or {}  # type: ignore[func-returns-value]
    assert sensing.pictures() == {} and asked == [ROBOT]


def test_poses_say_in_which_frame_they_are() -> None:
    pose, frame = Pose(np.array([1.0, 2.0, 3.0]), about_z(0.3), WORLD), Frame(0.5, -1.0, 1)
    seen = pose.seen_from(frame)
    assert seen.frame is frame
    np.testing.assert_allclose(seen.position, [3.0, -0.5, 3.0])
    np.testing.assert_allclose(seen.in_room().position, pose.position)
    np.testing.assert_allclose(seen.in_room().rotation, pose.rotation, atol=1e-12)
    q, _ = set_points(Command(panda.tucked(3.0, -0.5, 0.0), 0.0, frame), bodies.get())
    np.testing.assert_allclose(q[:3], [1.0, 2.0, 0.5 * np.pi])
