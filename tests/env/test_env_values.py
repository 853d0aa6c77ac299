"""Texts, numbers and booleans of NumPy are taken wherever Python's are, and mean the same."""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from enum import StrEnum
from typing import Any

import gymnasium
import numpy as np
import pytest
from remac_bench.playing.job_lists import make_jobs

import remac_agents
import remac_env
from remac_env.errors import ActionError, OptionError, RemacError, UnknownNameError
from remac_env.options import Options
from remac_env.tasks.goals import All, Inside, Released
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.validate import validate
from remac_env.values import python_value, python_values
from remac_env.vocabulary import Noun

CHANCE = np.random.default_rng(0)

GIVEN: dict[str, Any] = {
    "robots": 1, "backend": "symbolic", "style": "rustic", "layout": "galley", "starts": "mixed",
    "obs": "state+images", "text": "states", "feedback": "reason", "wording": 2, "naming": "category",
    "perception_noise": 0.1, "image_size": 32, "render_mode": "rgb_array", "max_rounds": 7, "reward": "progress",
    "failure_rate": 0.3, "masks": "feasible", "obs_format": "dict", "clock": "events", "max_seconds": 64.0,
    "think": "fixed:2", "body": "panda", "skills": "scripted", "grade": 2, "template": "washed fruit", "quirks": 0,
    "knowledge": "seen", "interrupts": True, "cameras": "wrist,side",
}  # fmt: skip
"""A value of every keyword of `parallel_env`."""

DRAWN = ("grade", "template", "quirks")
"""Those that are for generated tasks alone."""

STATED = {name: value for name, value in GIVEN.items() if name not in DRAWN}


def forms(value: object) -> list[Any]:
    """The same value as NumPy has it."""
    if isinstance(value, str):
        return [np.str_(value), np.array(value), np.array([value])[0], CHANCE.choice([value])]
    if isinstance(value, bool):
        return [np.bool_(value), np.array(value)]
    if isinstance(value, int):
        return [kind(value) for kind in (np.int8, np.uint8, np.int32, np.int64, np.uint64)] + [np.array(value)]
    return [kind(value) for kind in (np.float16, np.float32, np.float64, np.longdouble)] + [np.array(value)]


def test_the_table_has_every_keyword() -> None:
    assert set(GIVEN) == {field.name for field in fields(Options)}


@pytest.mark.parametrize("name", GIVEN)
def test_every_option_of_a_kitchen(name: str) -> None:
    right = Options(**GIVEN)
    for form in forms(GIVEN[name]):
        made = Options(**GIVEN | {name: form})
        assert made == right and type(getattr(made, name)) is type(GIVEN[name]), form
        assert json.dumps(asdict(made)) == json.dumps(asdict(right)), form
        if name in DRAWN:
            remac_env.parallel_env("Generated", **{"backend": "symbolic", "grade": 2, name: form}).close()
        else:
            remac_env.parallel_env(np.str_("HeatOnStove"), **STATED | {name: form}).close()


@pytest.mark.parametrize("flag", [True, np.True_, np.array(True)])
@pytest.mark.parametrize("name", [n for n, v in GIVEN.items() if not isinstance(v, str | bool)])
def test_booleans_are_no_numbers(name: str, flag: object) -> None:
    with pytest.raises(OptionError, match=f"{name} True is not valid"):
        Options(**GIVEN | {name: flag})


@pytest.mark.parametrize(
    ("name", "wrong", "told"),
    [
        ("style", np.str_("rustik"), "unknown style 'rustik'"),
        ("max_rounds", np.float64(3), "max_rounds 3.0"),
        ("perception_noise", np.float32("nan"), "perception_noise nan"),
        ("failure_rate", np.float64("inf"), "failure_rate inf"),
        ("image_size", np.array([32, 32]), "image_size"),
    ],
)
def test_what_is_wrong_is_told_in_plain_words(name: str, wrong: object, told: str) -> None:
    with pytest.raises(RemacError, match=told) as caught:
        remac_env.parallel_env("HeatOnStove", **STATED | {name: wrong})
    assert "np." not in str(caught.value)


def test_seeds_styles_and_tokens_of_a_reset() -> None:
    env = gymnasium.make("RemacKitchen-HeatOnStove-v0", robots=np.int64(2), backend=np.str_("symbolic"))
    start = {"style": "rustic", "layout": "galley"}
    env.reset(seed=4, options=start)
    right = env.unwrapped.parallel.start.digest
    for seed in forms(4):
        for turned in ({key: form for key, value in start.items() for form in [again(value)]} for again in _AGAIN):
            env.unwrapped.reset(seed=seed, options=turned)
            assert env.unwrapped.parallel.start.digest == right
    parallel = env.unwrapped.parallel
    for token in forms(2):
        parallel.reset(seed=4)
        _, _, _, _, infos = parallel.step({"robot_0": token, "robot_1": 0})
        assert parallel.vocabulary.decode(token) == parallel.vocabulary.decode(2)
        assert infos["robot_0"]["outcome"]["status"] == "success"
    for wrong in (np.True_, np.array(True), np.float64(2), np.str_("2"), np.array([2, 3])):
        with pytest.raises(ActionError):
            parallel.step({"robot_0": wrong, "robot_1": 0})
        with pytest.raises(UnknownNameError):
            parallel.vocabulary.decode(wrong)
    with pytest.raises(OptionError, match="seed True"):
        parallel.reset(seed=np.True_)


_AGAIN = (np.str_, np.array)


def test_tasks_from_outside() -> None:
    plain = TaskSpec(
        name="OnionToSink", wordings=("place the {food} into the sink",) * 3, distractors=(2, 4),
        goal=All(Inside("{food}", "sink"), Released("{food}")), roles=(Role("food", ("onion",)),),
        fixtures=("counter", "sink"), styles=("rustic",), layouts=("galley",), nouns=(Noun("shelf", "fixture"),),
    )  # fmt: skip
    turned = TaskSpec(
        name=np.str_("OnionToSink"), wordings=np.array(["place the {food} into the sink"] * 3),
        distractors=np.array([2, 4]), goal=All(Inside(np.str_("{food}"), np.str_("sink")), Released(np.str_("{food}"))),
        roles=(Role(np.str_("food"), np.array(["onion"])),), fixtures=np.array(["counter", "sink"]),
        styles=np.array(["rustic"]), layouts=np.array(["galley"]), nouns=(Noun(np.str_("shelf"), np.str_("fixture")),),
    )  # fmt: skip
    assert turned == plain
    validate(turned)
    assert {type(part) for part in (turned.name, *turned.styles, *turned.distractors)} == {str, int}


def test_agents_and_jobs() -> None:
    agent = remac_agents.make(
        np.str_("CC"), planner=np.str_("literal"), checker={"name": np.str_("noisy"), "miss": np.float32(0.2)},
        retries=np.int64(1), max_adjustments=np.uint8(3), max_rounds=np.array(9), lead=np.str_("robot_0"),
    )  # fmt: skip
    assert agent.roles.checker.miss == 0.2
    remac_agents.Memory(keep=np.int64(3))
    with pytest.raises(OptionError, match="retries True"):
        remac_agents.make("CC", retries=np.True_)
    with pytest.raises(OptionError, match="keep True"):
        remac_agents.Memory(keep=np.True_)
    kitchen = {"backend": "symbolic", "max_rounds": 7}
    plain = make_jobs(tasks=["HeatOnStove"], methods=["CC"], seeds=[3, 4], kitchen=kitchen, agent={"retries": 1})
    turned = make_jobs(
        tasks=np.array(["HeatOnStove"]), methods=np.array(["CC"]), seeds=np.arange(3, 5),
        kitchen={"backend": np.str_("symbolic"), "max_rounds": np.int64(7)}, agent={"retries": np.int64(1)},
    )  # fmt: skip
    assert [job.key for job in turned] == [job.key for job in plain]


def test_values_that_are_no_scalars_stay_as_they_are() -> None:
    class Look(StrEnum):
        RUSTIC = "rustic"

    obj = object()
    assert python_value(obj) is obj and python_value(None) is None
    assert Options(style=Look.RUSTIC) == Options(style="rustic")
    turned = python_values({np.str_("a"): [np.int64(1), (np.float32(0.1), np.array([[True]]))]})
    assert repr(turned) == "{'a': [1, (0.1, ((True,),))]}"
    held = np.empty((), object)
    held[()] = obj
    assert python_value(held) is obj
