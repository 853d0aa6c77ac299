"""Each check of remac_env.testing passes on every built-in task, and fails on the environment made for it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import bad_environments as bad
import bad_manners as manners
import pytest

import remac_env
from remac_env import testing
from remac_env.state import FLOOR, Place
from remac_env.tasks.goals import All, DoorIs, Inside
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.testing import ContractError
from remac_env.testing.task import check_certificate

short_random = partial(testing.check_determinism, seeds=(0, 1), rounds=6)
short_text = partial(testing.check_text, seeds=(0, 1), rounds=6)
few_masks = partial(testing.check_masks, limit=6)

BROKEN: list[tuple[type[bad.Tampered], Callable[[Any], None], str]] = [
    (bad.OutsideItsSpace, testing.check_spaces, "outside its space"),
    (bad.OutsideItsSpaceLater, testing.check_spaces, "round 5, robot_0: observation lies outside"),
    (bad.DoublePrecision, testing.check_spaces, "float64"),
    (bad.LacksAKey, testing.check_spaces, "action_mask"),
    (bad.ForgetsOneRobot, testing.check_spaces, "infos of"),
    (bad.LacksAField, testing.check_spaces, "lacks 'success'"),
    (bad.UnlistedReason, testing.check_spaces, "bad luck"),
    (bad.NoOutcomeYet, testing.check_spaces, r"info\['outcome'\] is a"),
    (bad.EndsInNone, testing.check_spaces, r"info\['end'\] is a .* one type for every key"),
    (bad.NoReasonOnSuccess, testing.check_spaces, "reason|one type for every key"),
    (bad.NumpyCounters, testing.check_spaces, r"info\['round'\] is a int64 and was a int"),
    (bad.WholeRewards, testing.check_spaces, "not a finite float"),
    (bad.NumpyFlags, testing.check_spaces, "not a bool"),
    (bad.ForgetsTheDead, testing.check_spaces, "alive were"),
    (bad.EndsOneByOne, testing.check_spaces, "do not end together"),
    (bad.WritesToWhatItGave, testing.check_spaces, "written to"),
    (bad.NewSpacesEachTime, testing.check_spaces, "not the same objects"),
    (bad.TwoInOneSlot, testing.check_spaces, "in one slot"),
    (bad.LosesAThing, testing.check_spaces, "objects of the world and of the scene differ"),
    (bad.SeesTheStartOnly, testing.check_changes, "robot_0: observation is constant, while the world changes"),
    (bad.OneRobotIsBlind, testing.check_changes, "robot_1: observation is constant, while"),
    (bad.StandsStillLater, testing.check_changes, "robot_0: observation is constant from round"),
    (bad.RandomOnTheSameSeed, short_random, "differs"),
    (bad.CountsItsResets, short_random, "differs"),
    (bad.ListensToGlobalRandom, short_random, "differs"),
    (bad.DrawsFromGlobalRandom, short_random, "global generator"),
    (bad.RandomAtTheEnd, short_random, "round 2: observations"),
    (bad.OneEpisodeOnly, short_random, "all start the same"),
    (bad.RemembersTheLastEpisode, partial(testing.check_determinism, seeds=(0, 1)), "rewards"),
    (manners.RaisesOnIllegalTokens, few_masks, "raised ValueError"),
    (manners.ForgivesIllegalTokens, few_masks, "illegal token"),
    (manners.BooleanMask, few_masks, "int8"),
    (manners.WaitingIsForbidden, few_masks, "'wait' is masked"),
    (manners.MasksByFeasibility, few_masks, "close cabinet door"),
    (manners.RoundsNumbers, testing.check_actions, "does not name|was accepted"),
    (manners.FillsInMissingRobots, testing.check_actions, "was accepted"),
    (manners.NamesNobody, testing.check_actions, "does not name"),
    (manners.ActsBeforeItChecks, testing.check_actions, "after malformed actions"),
    (manners.StepsBeforeReset, testing.check_lifecycle, r"step\(\) before reset"),
    (manners.StartsAgainByItself, testing.check_lifecycle, "after the end"),
    (manners.IgnoresDone, testing.check_lifecycle, "`done`"),
    (manners.ClosesOnlyOnce, testing.check_lifecycle, "a second time"),
    (manners.RisesFromTheDead, testing.check_lifecycle, r"reset\(\) after close"),
    (manners.WatchesOneRobotOnly, testing.check_names, "success"),
    (manners.PaysOneRobotOnly, testing.check_names, "reward"),
    (manners.FirstComeFirstServed, testing.check_names, "mirror image|gets"),
    (manners.TellsStates, short_text, "tells a state"),
    (manners.HintsAtStates, partial(testing.check_text, seeds=(0, 1, 2), rounds=20), "two worlds, two texts"),
    (manners.HidesAThing, short_text, "does not name"),
    (manners.WinsTooEarly, check_certificate, "ended after round 2"),
    (manners.NeverWins, check_certificate, "does not end with success"),
]


@pytest.mark.few(1)
@pytest.mark.parametrize("task", remac_env.tasks())
def test_every_check_passes_on_the_built_in_tasks(task: str) -> None:
    testing.check_task(task, seeds=(0, 1), rounds=12)


@pytest.mark.parametrize(("environment", "check", "message"), BROKEN, ids=[entry[0].__name__ for entry in BROKEN])
def test_a_wrong_environment_is_found_out(environment: Any, check: Any, message: str) -> None:
    with pytest.raises(ContractError, match=message):
        check(environment)


def test_the_base_of_the_wrong_environments_is_right() -> None:
    """Or else the tests above would prove nothing."""
    testing.check_spaces(bad.Tampered, seeds=(0,))
    testing.check_changes(bad.Tampered)
    testing.check_lifecycle(bad.Tampered)
    testing.check_actions(bad.Tampered)
    testing.check_names(bad.Tampered, seeds=(0,))
    short_random(bad.Tampered)
    short_text(bad.Tampered)
    few_masks(bad.Tampered)
    check_certificate(bad.Tampered)


def test_checks_hold_with_progress_reward_and_states_told() -> None:
    make = partial(remac_env.parallel_env, "DefrostInBowl", backend="symbolic")
    testing.check_spaces(lambda: make(reward="progress", failure_rate=0.3), seeds=(3,))
    testing.check_determinism(lambda: make(failure_rate=0.3, starts="mixed"), seeds=(1, 2), rounds=15)
    with pytest.raises(ContractError, match="tells a state"):
        testing.check_text(lambda: make(text="states"), seeds=(0,))


def test_check_world_finds_what_cannot_be() -> None:
    env = remac_env.parallel_env("HeatOnStove", backend="symbolic")
    env.reset(seed=0)
    scene, world = env.start.scene, env.world
    testing.check_world(scene, world)
    broken = {
        "unknown slot": world.with_object("pan", place=Place("slot", "counter.99")),
        "but in its hand": world.with_object("pan", place=Place("held", "robot_0")),
        "holds": world.with_robot("robot_1", holding="pan"),
        "circle": world.with_object("pan", place=Place("vessel", "pan")),
        "that holds 0": world.with_object("pan", place=Place("vessel", "vegetable")),
        "in conflict": world.with_robot("robot_0", station="sink").with_robot("robot_1", station="sink"),
        "unknown station": world.with_robot("robot_0", station="garden"),
        "has no switches": world.with_fixture("stove", on=frozenset({"faucet"})),
        "runs with its door": world.with_fixture("microwave", on=frozenset({"microwave"}), door="open"),
        "door is 'open'": world.with_fixture("sink", door="open"),
    }
    for message, wrong in broken.items():
        with pytest.raises(ContractError, match=message):
            testing.check_world(scene, wrong)
    testing.check_world(scene, world.with_object("pan", place=FLOOR))


def test_check_task_finds_a_task_without_a_solution() -> None:
    impossible = TaskSpec(
        name="Impossible",
        wordings=("put the {food} into the fridge",) * 3,
        goal=All(Inside("{food}", "fridge")),
        roles=(Role("food", ("vegetable",)),),
        fixtures=("counter", "fridge"),
    )
    with pytest.raises(ContractError, match="no plan reaches the goal"):
        testing.check_task(impossible, seeds=(0,))
    assert "Impossible" not in remac_env.tasks()


@pytest.mark.long
def test_a_task_too_long_for_a_shortest_plan_is_no_task_without_a_solution() -> None:
    spec = remac_env.generate(4, 3)
    check_certificate(lambda: remac_env.parallel_env(spec, robots=1, backend="symbolic"), seeds=(0,))


def test_a_task_that_is_solved_at_every_start_is_refused() -> None:
    solved = TaskSpec(
        name="Solved",
        wordings=("leave the cabinet door closed",) * 3,
        goal=All(DoorIs("cabinet", "closed")),
        roles=(Role("food", ("vegetable",)),),
        fixtures=("counter", "cabinet"),
    )
    with pytest.raises(remac_env.errors.SamplingError, match="goal is still open"):
        testing.check_task(solved, seeds=(0,), starts=("paper",))


def test_a_sentence_with_a_hole_is_found_out() -> None:
    holed = TaskSpec(
        name="Holed",
        wordings=("put the {food} into the cabinet", "put it into the cabinet", ""),
        goal=All(Inside("{food}", "cabinet")),
        roles=(Role("food", ("vegetable",)),),
        fixtures=("counter", "cabinet"),
    )
    with pytest.raises(ContractError, match="is not a sentence"):
        testing.check_task(holed, seeds=(0,), robots=(1,), starts=("paper",), rounds=4)
