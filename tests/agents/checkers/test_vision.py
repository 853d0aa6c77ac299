"""The checker with eyes: planted networks whose answers are known, and files that are not what they should be."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from agent_kitchens import suite_kitchen

import remac_agents
from remac_agents.checkers.vision import VisionChecker
from remac_agents.roles import FreeText, StopEpisode, View
from remac_agents.vision.network import CAMERAS, LARGEST, SIZE, STRIDES, Network, Words, convolved, shapes
from remac_agents.vision.pictures import fitted
from remac_agents.vision.questions import RARE, Question, kinds_of, predicates, question_of, robot_of
from remac_agents.vision.weights import About, Weights, read_weights, save_weights
from remac_env.errors import OptionError
from remac_env.rules.conditions import condition, denied
from remac_env.rules.predicates import PREDICATES
from remac_env.rules.scene import public_scene

WORDS = Words(predicates(), ("bowl", "counter", "faucet", "fish", "meat", "sink"))
DARK, BRIGHT = np.zeros((SIZE, SIZE, 3), np.uint8), np.full((SIZE, SIZE, 3), 255, np.uint8)


def arrays_of(last_bias: tuple[float, float, float] = (0.0, 0.0, 0.0), *, looks: float = 0.0) -> dict[str, np.ndarray]:
    """A network whose answer is `last_bias`, and "true" the more, the brighter the station is (times `looks`)."""
    found = {name: np.zeros(shape, np.float32) for name, shape in shapes(WORDS, (1,) * len(STRIDES), 2, 1, 1).items()}
    for number in range(len(STRIDES)):
        size = 27 if number == 0 else 9
        found[f"station_weight_{number}"] = np.full((1, size), 1.0 / size, np.float32)
    found["station_bias_0"][:] = 0.5  # pictures are told about 0: dark ones are seen as nothing, not cut off
    found["hidden"][0, 2] = 1.0  # the first head of the station's picture
    found["last"][0, 0] = looks
    found["last_bias"][:] = last_bias
    return found


def weights_of(arrays: Mapping[str, np.ndarray], *, least: float = 0.9) -> Weights:
    kinds = {kind for name in WORDS.predicates for kind in (name, f"{name} {RARE}")}
    about = About(
        predicates=WORDS.predicates, words=WORDS.words, common=WORDS.words[:3],
        least=dict.fromkeys(kinds, (least, least)),
        sample=(("door_open", "sink"), ("inside", "fish", "bowl")), seeds={"train": "3:9"},
    )  # fmt: skip
    return Weights(about=about, network=Network(WORDS, arrays), sample=((BRIGHT, DARK),))


@pytest.fixture
def made(tmp_path: Path) -> Any:
    def make(*args: Any, sure: float | None = None, rules: bool = False, **options: Any) -> VisionChecker:
        path = tmp_path / f"{len(list(tmp_path.iterdir()))}.npz"
        save_weights(path, weights_of(arrays_of(*args, **options)))
        return VisionChecker(weights=path, sure=sure, rules=rules)

    return make


@pytest.fixture(scope="module")
def view() -> View:
    env = suite_kitchen("DefrostInBowl", robots=2)
    env.reset(seed=3)
    robots = env.start.scene.robots
    scene = public_scene(env.start.scene)
    return View("defrost", scene, dict.fromkeys(robots), images=seen(robots, DARK), robot="robot_0")


def seen(robots: Any, picture: np.ndarray) -> dict[str, dict[str, np.ndarray]]:
    return {robot: dict.fromkeys(CAMERAS, picture) for robot in robots}


ON = condition("switched_on", "faucet")


def values(checker: VisionChecker, view: View, *conditions: Any) -> list[bool | None]:
    return [verdict.value for verdict in checker.check(conditions, view)]


def test_it_says_what_its_network_is_sure_of_and_else_that_it_cannot_tell(made: Any, view: View) -> None:
    assert values(made((9.0, 0.0, 0.0)), view, ON, condition("inside", "fish", "bowl")) == [True, True]
    assert values(made((0.0, 9.0, 0.0)), view, ON, denied(ON)) == [False, True]
    assert values(made((0.0, 0.0, 9.0)), view, ON, denied(ON)) == [None, None]
    assert values(made((1.0, 0.0, 0.0)), view, ON) == [None], "60% are not 90%"
    assert values(made((1.0, 0.0, 0.0), sure=0.5), view, ON) == [True]


def test_opposites_are_judged_by_one_answer_turned_round(made: Any, view: View) -> None:
    opposites = [condition("switched_off", "faucet"), condition("all_off", "faucet")]
    for said, told in (((9.0, 0.0, 0.0), False), ((0.0, 9.0, 0.0), True), ((0.0, 0.0, 9.0), None)):
        assert values(made(said), view, *opposites) == [told, told]
        assert values(made(said), view, denied(opposites[0])) == [None if told is None else not told]


def test_each_kind_of_question_has_levels_of_its_own(made: Any, view: View) -> None:
    bowl, fish = condition("inside", "bowl", "counter"), condition("inside", "fish", "counter")
    assert kinds_of(Question("inside", ("bowl", "counter")), WORDS.words[:3]) == (
        "inside bowl counter", "inside counter", "inside"
    )  # fmt: skip
    assert kinds_of(Question("inside", ("fish", "counter")), WORDS.words[:3]) == (f"inside {RARE}",)
    checker = made((1.0, 0.0, 0.0))  # 58% of "true"
    assert values(checker, view, bowl, fish) == [None, None]
    usual = checker._about.least
    for kind, told in (("inside", [True, None]), (f"inside {RARE}", [None, True]), ("inside counter", [True, None])):
        checker._about = replace(checker._about, least={**usual, kind: (0.5, 0.9)})
        assert values(checker, view, bowl, fish) == told, kind
    narrow = {"inside": (0.5, 0.5), "inside counter": (1.5, 1.5)}
    checker._about = replace(checker._about, least={**usual, **narrow})
    assert values(checker, view, bowl) == [None], "the narrowest that there is counts"


def test_it_looks_at_the_pictures(made: Any, view: View) -> None:
    checker = made((0.0, 5.0, 0.0), looks=40.0)
    bright = replace(view, images=seen(view.images, BRIGHT))
    assert values(checker, view, ON) == [False] and values(checker, bright, ON) == [True]


def test_where_one_robot_cannot_tell_the_others_pictures_are_looked_at_but_not_about_the_robot_itself(
    made: Any, view: View
) -> None:
    checker = made((-20.0, -20.0, 5.0), looks=80.0)  # it sees nothing in the dark
    one = replace(view, images={**seen(["robot_0"], DARK), **seen(["robot_1"], BRIGHT)})
    here, there = condition("at", "robot_0", "sink"), condition("at", "robot_1", "sink")
    assert values(checker, one, ON, here, there) == [True, None, True]


def test_what_is_felt_or_known_or_never_learnt_is_not_looked_for(made: Any, view: View) -> None:
    checker, held = made((9.0, 0.0, 0.0)), replace(view, holding={"robot_0": "fish", "robot_1": None})
    felt = condition("holding", "robot_0", "fish"), condition("hand_empty", "robot_0")
    assert values(checker, held, *felt) == [True, False]
    assert values(checker, held, condition("placed", "fish"), condition("inside", "fish", "bowl")) == [False, False]
    assert values(checker, held, condition("placed", "sink"), condition("placed", "bowl")) == [True, True]
    unknown = [condition("door_open", "microwave"), condition("graspable", "fish"), FreeText.of("the room is tidy")]
    unknown += [condition("marked", "fish", "washed"), condition("station_free", "robot_0", "sink")]
    assert values(checker, view, *unknown) == [None] * len(unknown)
    told = {verdict.reason for verdict in checker.check(unknown, view)}
    assert told == {"no picture shows it", "it never learnt what 'microwave' is"}


def test_with_the_rules_it_knows_what_needs_a_vessel_and_sees_whether_there_is_one(made: Any) -> None:
    env = suite_kitchen("DefrostInBowl", robots=1)
    env.reset(seed=3)
    rules = env.start.scene
    food = next(name for name, facts in rules.objects.items() if "sink" in facts.needs_vessel_in)
    view = View("defrost", public_scene(rules), {"robot_0": food}, images=seen(["robot_0"], DARK), robot="robot_0")
    asked, told = condition("no_vessel_needed", "robot_0", "sink"), replace(view, rules=rules)
    nothing_there, there = made((0.0, 9.0, 0.0), rules=True), made((9.0, 0.0, 0.0), rules=True)
    assert values(nothing_there, told, asked, denied(asked)) == [False, True]
    unsure = made((0.0, 0.0, 9.0), rules=True)
    assert values(there, told, asked) == [True] and values(unsure, told, asked) == [False]
    assert values(unsure, replace(told, holding={"robot_0": None}), asked) == [True], "an empty hand needs none"
    assert values(unsure, replace(told, holding={}), asked) == [None], "who knows what it holds"
    assert values(made((0.0, 9.0, 0.0)), told, asked) == [None], "the rules are for those who declare them"
    assert nothing_there.needs_rules and not nothing_there.needs_truth


def test_reports_say_that_it_was_given_the_rules() -> None:
    obs, infos = suite_kitchen("DefrostInBowl", robots=1).reset(seed=1)
    for checker, given in (("vision,rules=true", True), ("vision", False)):
        agent = remac_agents.make("CC", checker=checker)
        agent.reset({robot: {**told, **dict.fromkeys(CAMERAS, DARK)} for robot, told in obs.items()}, infos)
        report = agent.report()
        assert ("checker" in report.rule_readers) is given and "checker" not in report.truth_readers


def test_without_pictures_the_episode_ends_and_nobody_is_to_blame(made: Any, view: View) -> None:
    usual = dict.fromkeys(("front", "side", "wrist"), DARK)
    for images in ({}, usual):
        with pytest.raises(StopEpisode, match='image_size=96, cameras="station,wrist"') as stopped:
            made().check([ON], replace(view, images={"robot_0": images}))
        assert stopped.value.infrastructure
    obs, infos = suite_kitchen("DefrostInBowl", robots=1).reset(seed=1)
    with pytest.raises(OptionError, match='cameras="station,wrist"'):
        remac_agents.make("CC", checker="vision").reset({name: {**told, **usual} for name, told in obs.items()}, infos)


def test_it_is_given_neither_truth_nor_rules_and_its_weights_are_named_in_the_report() -> None:
    agent = remac_agents.make("CC", checker="vision")
    checker: Any = agent.roles.checker
    assert not checker.needs_truth and not checker.needs_rules and len(checker.sha256) == 64
    obs, infos = suite_kitchen("OpenMicrowavePnP", robots=1).reset(seed=1)
    obs = {robot: {**told, **dict.fromkeys(CAMERAS, DARK)} for robot, told in obs.items()}
    agent.reset(obs, infos)
    agent.act(obs, infos)
    agent.close_episode(obs, infos)
    report = agent.report()
    assert report.weights == {"checker": checker.sha256} and "checker" not in report.truth_readers
    assert {check.verdict for check in report.pre_checks} <= {True, False, None} and report.pre_checks
    assert "torch" not in sys.modules


def test_what_is_shipped_knows_its_data_and_fits_this_player() -> None:
    checker: Any = remac_agents.make("CC", checker="vision").roles.checker
    about = checker._about
    assert set(about.predicates) == set(predicates()) and set(about.seeds) == {"train", "calibrate", "test"}
    assert about.measured and about.data and about.code
    assert not set(about.layouts["train"]) & set(about.layouts["test"])
    assert not set(about.styles["train"]) & set(about.styles["test"])


def test_every_seen_condition_that_the_round_does_not_settle_is_a_question_or_the_opposite_of_one() -> None:
    rows = [row for row in PREDICATES.values() if row.kind == "seen" and not row.settled]
    assert {row.denies or row.name for row in rows} | {"marked seasoned"} == set(predicates())
    assert not {row.name for row in rows if row.denies} & set(predicates())
    assert question_of(condition("door_not_open", "sink")) == question_of(condition("door_open", "sink"))
    assert question_of(condition("room", "robot_1", "sink")) == Question("room", ("sink",))
    assert robot_of(condition("room", "robot_1", "sink")) == "robot_1"
    assert question_of(condition("marked", "fish", "seasoned")) == Question("marked seasoned", ("fish",))


def test_a_convolution_is_what_it_is_called() -> None:
    chance = np.random.default_rng(0)
    values, kernel = (chance.normal(size=size).astype(np.float32) for size in ((2, 6, 6), (1, 2, 3, 3)))
    found = convolved(values, kernel.reshape(1, 18), 2).reshape(3, 3)
    padded = np.pad(values, ((0, 0), (1, 1), (1, 1)))
    slow = [[(padded[:, r : r + 3, c : c + 3] * kernel[0]).sum() for c in (0, 2, 4)] for r in (0, 2, 4)]
    assert found == pytest.approx(np.array(slow), abs=1e-4)


def test_pictures_of_any_size_are_fitted() -> None:
    large = np.zeros((4 * SIZE, 4 * SIZE, 3), np.uint8)
    large[:, : 2 * SIZE] = 200
    assert fitted(large).shape == (SIZE, SIZE, 3) and fitted(large)[:, : SIZE // 2].min() == 200
    assert fitted(np.zeros((40, 40, 3), np.uint8)).shape == (SIZE, SIZE, 3)


# -- files -----------------------------------------------------------------------------------------------------------


def test_weights_come_back_as_they_were_saved(tmp_path: Path) -> None:
    weights = weights_of(arrays_of((1.0, 2.0, 3.0)))
    save_weights(tmp_path / "a.npz", weights)
    back = read_weights(tmp_path / "a.npz")
    assert replace(back.about, least={}, sample=()) == replace(weights.about, least={}, sample=()) and back.sha256
    found = back.network.arrays
    assert all(np.allclose(array, found[name], rtol=1e-3) for name, array in weights.network.arrays.items())


def changed(path: Path, **arrays: Any) -> Path:
    with np.load(path) as file:
        kept = {name: file[name] for name in file.files}
    about = json.loads(str(kept["about"])) | arrays.pop("about", {})
    np.savez_compressed(path, **{**kept, "about": np.array(json.dumps(about)), **arrays})
    return path


@pytest.mark.parametrize(("change", "said"), [
    ({"hidden": np.full((1, 11), np.nan, np.float16)}, "finite"),
    ({"hidden": np.zeros((2, 11), np.float16)}, "do not fit together"),
    ({"extra": np.zeros(1, np.float16)}, "do not fit together"),
    ({"last_bias": np.array([3.0, 0.0, 0.0], np.float16)}, "damaged"),
    ({"last": np.array([[object()]])}, "cannot be read"),
    ({"last": np.zeros((3, 1), int)}, "damaged|finite"),
    ({"sample_station": np.zeros((1, 4, 4, 3), np.uint8)}, "sample"),
    ({"about": {"format": "remac-checker-2"}}, "train it anew"),
    ({"about": {"predicates": ["is_tasty", *predicates()[1:]]}}, "is_tasty"),
    ({"about": {"words": ["bowl"]}}, "do not fit together"),
    ({"about": {"temperature": 0.0}}, "temperature"), ({"about": {"least": {}}}, "least"),
    ({"about": {"least": dict.fromkeys(predicates(), (0.9, 0.9))}}, "least"), ({"about": {"common": [3]}}, "texts"),
    ({"about": {"mood": "good"}}, "mood"), ({"about": {"sample": []}}, "sample"),
    ({"padding": np.random.default_rng(0).integers(0, 255, 2 * LARGEST).astype(np.uint8)}, "bytes"),
])  # fmt: skip
def test_weights_that_are_not_what_they_are_said_to_be_are_refused(
    tmp_path: Path, change: dict[str, Any], said: str
) -> None:
    path = tmp_path / "a.npz"
    save_weights(path, weights_of(arrays_of(looks=1.0)))
    with pytest.raises(OptionError, match=said):
        VisionChecker(weights=changed(path, **change))


@pytest.mark.parametrize("data", [b"", b"PK\x03\x04 no zip", b"\x80\x04N."])
def test_files_that_are_none_are_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(data)
    with pytest.raises(OptionError, match="cannot be read"):
        VisionChecker(weights=path)
    save_weights(path, weights_of(arrays_of()))
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(OptionError, match="cannot be read"):
        VisionChecker(weights=path)


@pytest.mark.parametrize(("options", "said"), [
    ({"weights": "nowhere.npz"}, "cannot be read"), ({"sure": 2.0}, "0..1"), ({"sure": "very"}, "0..1"),
    ({"rules": "some"}, "true or false"),
])  # fmt: skip
def test_wrong_options_are_refused(options: dict[str, Any], said: str) -> None:
    with pytest.raises(OptionError, match=said):
        remac_agents.make("CC", checker={"name": "vision", **options})
