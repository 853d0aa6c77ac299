"""Generated tasks that physics can have: which they are, what is refused, and one of them played."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from remac_bench.playing.recording import Recorder

import remac_env
from remac_env.errors import OptionError, RenderingError
from remac_env.generator import make, templates
from remac_env.generator.making import candidates
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.objects.shapes import shape
from remac_env.kitchen.objects.tints import load, tint_of, tinted


@pytest.mark.parametrize("grade", [1, 2, 3, 4, 5])
def test_every_grade_has_templates_that_physics_can_have(grade: int) -> None:
    rows = candidates(grade, "physics", 1)
    assert len(rows) >= 7
    assert not any(row.annexes or row.team for row in rows)
    assert not {row.name for row in rows} & {row.name for row in candidates(grade, None, 1)}


def test_what_physics_lacks_is_refused_by_name() -> None:
    spec = remac_env.generate(1, 0, template="mugs into the sideboard")
    with pytest.raises(OptionError, match=r"sideboard.*template='physics'"):
        remac_env.parallel_env(spec, robots=1)
    spec = remac_env.generate(1, 0, template="physics")
    assert spec.layouts[0] in layouts.names("rich") and not spec.annexes
    remac_env.parallel_env(spec, robots=1)


def test_the_words_are_the_same_for_every_seed() -> None:
    env = remac_env.parallel_env("Generated", robots=1, grade=1, template="physics", backend="symbolic")
    spec = make(grade=1, seed=3, template="physics").spec
    own = remac_env.parallel_env(spec, robots=1, backend="symbolic").vocabulary
    assert env.vocabulary.nouns == own.nouns
    assert "cupboard" in {noun.name for noun in env.vocabulary.nouns}


def test_objects_of_one_kind_are_drawn_in_their_colours() -> None:
    assert tint_of("red mug", "mug") == load()["red"]
    assert tint_of("mug", "mug") is tint_of("red mug", "glass") is tint_of("first plate", "plate") is None
    pictures = {word: tinted(shape("mug"), load()[word])[0].picture for word in ("red", "blue")}
    red, blue = (np.asarray(pictures[word]).reshape(-1, 3).mean(axis=0) for word in ("red", "blue"))
    assert red[0] > blue[0] + 50 and blue[2] > red[2] + 50


def test_rows_of_a_family_name_layouts_and_no_annexes() -> None:
    rows = [row for row in templates.load().values() if row.family]
    assert rows and all(row.family in layouts.FAMILIES and not row.annexes for row in rows)


@pytest.mark.long
@pytest.mark.parametrize("robots", [1, 2])
def test_a_plan_that_is_known_to_work_works_in_physics(robots: int) -> None:
    task = make(grade=1, seed=1, template="physics", robots=robots)
    env = remac_env.parallel_env(task.spec, robots=robots)
    env.reset(seed=0)
    for joint in task.plan.rounds:
        env.step({name: env.vocabulary.encode(subtask.text) for name, subtask in joint.items()})
    assert env.goal.holds(env.start.scene, env.world)


@pytest.mark.parametrize("options", [{"obs": "state+images"}, {"render_mode": "rgb_array"}])
def test_a_kitchen_with_annexes_says_that_it_cannot_be_drawn(options: dict[str, Any]) -> None:
    spec = remac_env.generate(1, 0, template="fruit into the pantry")
    env = remac_env.parallel_env(spec, robots=1, backend="symbolic", **options)
    with pytest.raises(RenderingError, match=r"pantry, trolley: annexes have no shape.*template='physics'"):
        env.reset(seed=0)
        env.render()


def test_a_video_of_annexes_is_refused_and_the_episode_goes_on(tmp_path: Path) -> None:
    spec = remac_env.generate(1, 0, template="fruit into the pantry")
    env = remac_env.parallel_env(spec, robots=1, backend="symbolic")
    recorder = Recorder(env, tmp_path, "annexes", "all", last=True)
    recorder.start()
    env.reset(seed=0)
    video = recorder.finish(success=True)
    assert video is not None and video.path is None and "pantry, trolley" in str(video.error)
    assert env._repr_png_() is None
