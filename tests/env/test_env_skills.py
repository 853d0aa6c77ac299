"""The option `skills`: who moves robots, said in every way, refused where it means nothing, and recorded."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import remac_env
from remac_env.backends.physics.controllers.learned.library import SHIPPED, file_name, learned_skills
from remac_env.backends.physics.controllers.learned.network import Network, commanded
from remac_env.backends.physics.controllers.learned.seen import entries
from remac_env.backends.physics.controllers.learned.weights import About, Weights, save_weights
from remac_env.errors import OptionError, UnknownNameError
from remac_env.options import Options
from remac_env.robots import bodies
from remac_env.robots.panda.body import Panda
from remac_env.rules.skills import SKILLS

TASK = "OpenMicrowavePnP"
COMMANDED = commanded(bodies.get())


def write(folder: Path, skill: str) -> Path:
    """Weights that stand still, in this folder."""
    inputs = len(entries(SKILLS[skill]))
    layer = tuple(np.zeros(shape, np.float32) for shape in ((4, inputs), (4,), (4,), (4,)))
    last = (np.zeros((COMMANDED, 4), np.float32), np.zeros(COMMANDED, np.float32))
    out = np.zeros((1, COMMANDED), np.float32)
    network = Network(np.zeros(inputs, np.float32), np.ones(inputs, np.float32), (layer,), last, out, out + 1)  # type: ignore[arg-type]
    about = About(skill=skill, targets=(), execute=1)
    path = folder / file_name(skill)
    save_weights(path, Weights(about=about, network=network, sample=np.zeros((1, inputs), np.float32)))
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for skill in ("open door", "navigate to"):
        write(tmp_path, skill)
    return tmp_path


def told(skills: Any, robots: int = 1) -> dict[str, str]:
    """Of the learned skills, the first digits of the digests that an environment tells."""
    env = remac_env.parallel_env(TASK, robots=robots, skills=skills)
    try:
        return {skill: known[:6] for skill, known in env.skills.items() if known != "scripted"}
    finally:
        env.close()


def test_scripted_skills_are_the_default_and_say_nothing() -> None:
    assert Options().skills == "scripted" and told("scripted") == {}
    assert remac_env.parallel_env(TASK).skills == {}


def test_a_folder_is_used_as_far_as_it_goes(folder: Path) -> None:
    assert set(told(str(folder))) == {"open door", "navigate to"} == set(told(folder))
    assert set(told(str(folder), robots=2)) == {"open door"}, "drives of two robots stay scripted"


@pytest.mark.parametrize("spoken", [
    {"open door": "FOLDER"}, "open door=FOLDER", "scripted, open door = FOLDER", {"open door": Path("FOLDER")},
    "FOLDER,navigate to=scripted",
])  # fmt: skip
def test_a_mapping_by_skill_says_the_same_as_a_text(spoken: Any, folder: Path) -> None:
    if isinstance(spoken, dict):
        given: Any = {skill: type(name)(str(name).replace("FOLDER", str(folder))) for skill, name in spoken.items()}
    else:
        given = spoken.replace("FOLDER", str(folder))
    assert set(told(given)) == {"open door"}
    assert Options(skills=Options(skills=given).skills).skills == Options(skills=given).skills


@pytest.mark.parametrize(("given", "why"), [
    ("nowhere", "folder with weights"), ("juggle=learned", "valid: navigate aside"),
    ("wait=learned", "skill of skills"), ("", "SKILL="), ("open door=", "SKILL="), ("a,b", "SKILL="), (7, "SKILL="),
    ({"open door": 3}, "SKILL="), ("open door=learned,open door=scripted", "SKILL="),
    ("close door=FOLDER", "has no weights for 'close door'"),
])  # fmt: skip
def test_what_means_nothing_is_refused_before_anything_is_built(given: Any, why: str, folder: Path) -> None:
    given = given.replace("FOLDER", str(folder)) if isinstance(given, str) else given
    with pytest.raises((OptionError, UnknownNameError), match=why):
        remac_env.parallel_env(TASK, robots=1, skills=given)


def test_learned_drives_of_two_robots_and_symbolic_skills_are_refused(folder: Path) -> None:
    with pytest.raises(OptionError, match="one robot"):
        remac_env.parallel_env(TASK, robots=2, skills={"navigate to": str(folder)})
    with pytest.raises(OptionError, match="physics"):
        remac_env.parallel_env(TASK, backend="symbolic", skills="learned")


def test_damaged_weights_are_refused_when_the_environment_is_made(folder: Path) -> None:
    path = folder / file_name("open door")
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(OptionError, match="OpenDoor.npz.*cannot be read"):
        remac_env.parallel_env(TASK, robots=1, skills=folder)


def test_a_learned_skill_is_played_without_torch_and_judged_by_the_kitchen(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for library in ("torch", "h5py"):
        monkeypatch.setitem(sys.modules, library, None)
    env = remac_env.parallel_env(TASK, robots=1, skills={"open door": folder})
    env.reset(seed=3)
    for text in ("navigate to microwave", "open microwave door"):
        *_, infos = env.step({"robot_0": env.vocabulary.encode(text)})
    outcome = infos["robot_0"]["outcome"]
    assert (outcome["status"], outcome["reason"]) == ("failure", "slipped"), "these weights stand still"
    env.close()


def test_what_was_learned_with_another_body_is_refused() -> None:
    body = Panda(name="low panda", mount_height=0.62)
    bodies.register_body(body)
    try:
        with pytest.raises(OptionError, match="learnt with body 'panda', got body='low panda'"):
            remac_env.parallel_env(TASK, robots=1, skills="learned", body=body.name).reset(seed=0)
        assert learned_skills("scripted", 1, body.name) == {}
    finally:
        bodies._BODIES.pop(body.name)


def test_the_packages_own_weights_are_small_whole_and_measured() -> None:
    found = learned_skills("learned", 1)
    assert {file_name(skill) for skill in found} == {path.name for path in SHIPPED.glob("*.npz")}
    for skill, known in found.items():
        assert known.about.skill == skill and known.about.measured and known.about.demonstrations
        assert (SHIPPED / file_name(skill)).stat().st_size < 1_000_000


def test_it_is_told_in_which_cases_things_are_handled_by_what_was_learned() -> None:
    env = remac_env.parallel_env(TASK, robots=1, skills="learned")
    assert env.skill_cases == {
        "navigate to": ["carrying", "empty-handed"],
        "pick up": ["food on surface", "vessel on surface"],
        "place to": [
            *("food in vessel on basin", "food in vessel on burner", "food in vessel on cavity"),
            *("food in vessel on surface", "food on surface", "vessel on basin", "vessel on burner"),
        ],
    }
    assert remac_env.parallel_env(TASK, robots=1).skill_cases == {}


@pytest.mark.long
def test_the_packages_own_skills_take_pan_and_food_and_put_them_down() -> None:
    env = remac_env.parallel_env("HeatOnStove", robots=1, skills="learned")
    done = drives = 0
    for seed in range(4):
        env.reset(seed=seed)
        for thing, place in (("pan", "stove"), ("vegetable", "pan")):
            for text in (f"navigate to {thing}", f"pick up {thing}", f"navigate to {place}", f"place to {place}"):
                *_, infos = env.step({"robot_0": env.vocabulary.encode(text)})
                drives += text.startswith("navigate") and infos["robot_0"]["outcome"]["status"] == "success"
        done += env.world.objects["vegetable"].place.where == "pan" and "stove" in env.world.objects["pan"].place.where
    assert done >= 3 and drives == 16, "drives with something in the hand are none that was learned"
    env.close()


@pytest.mark.long
def test_the_packages_own_skills_turn_things_on_and_off() -> None:
    env = remac_env.parallel_env("HeatOnStove", robots=1, skills="learned")
    for seed in range(3):
        env.reset(seed=seed)
        for text in ("navigate to stove", "turn on stove", "turn off stove", "navigate to faucet", "turn on faucet"):
            *_, infos = env.step({"robot_0": env.vocabulary.encode(text)})
            assert infos["robot_0"]["outcome"]["status"] == "success", (seed, text, infos["robot_0"]["outcome"])
    env.close()
