"""robosuite's wrappers, recordings and cameras over our kitchens."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from robosuite_kitchen import make

from remac_env.errors import OptionError, RenderingError

pytest.importorskip("robosuite", reason="robosuite is not installed: docs/robosuite.md says how")


def test_gym_wrapper() -> None:
    from robosuite.wrappers import GymWrapper

    env = GymWrapper(make("DefrostInBowl", seed=8))
    first, _ = env.reset()
    assert env.observation_space.contains(first.astype(np.float32))
    again, reward, terminated, truncated, info = env.step(np.zeros(env.action_space.shape))
    assert again.shape == first.shape
    assert (reward, terminated, truncated, info["success"]) == (0.0, False, False, False)
    env.unwrapped.set_seed(9)
    other, _ = env.reset()
    assert other.shape == first.shape, "observations have the same shape in every start"
    assert not np.array_equal(other, first)
    env.close()


def recorded(folder: Path, **options: Any) -> tuple[Any, list[np.ndarray], str]:
    """An environment that has recorded an episode in which the microwave's button is pressed."""
    from robosuite.wrappers import DataCollectionWrapper

    inner = make("OpenMicrowavePnP", **options)
    env = DataCollectionWrapper(inner, str(folder), collect_freq=1, flush_freq=1000)
    env.reset()
    assert inner.world == inner.episode.start.world
    button = inner.sim.model._model.joint("microwave/button").dofadr[0]
    low, high = inner.action_spec
    rng = np.random.default_rng(1)
    states = [np.array(inner.sim.get_state().flatten())]
    for step in range(8):
        inner.sim.data._data.qfrc_applied[button] = 30.0 if step == 3 else 0.0
        env.step(rng.uniform(low, high))
        states.append(np.array(inner.sim.get_state().flatten()))
    assert inner.world.fixtures["microwave"].on
    start = inner.episode.start.digest
    env.close()
    return inner, states, start


def test_a_recording_is_played_back_by_its_states_and_by_its_actions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Into an environment that was at another start, on a machine whose textures lie elsewhere."""
    _, states, start = recorded(tmp_path / "demos", looks=True, style="industrial")
    (episode,) = (tmp_path / "demos").iterdir()
    kept = np.load(next(episode.glob("state_*.npz")), allow_pickle=True)
    text, meta = (episode / "model.xml").read_text(), json.loads((episode / "ep_meta.json").read_text())
    assert np.array_equal(kept["states"], np.array(states))
    assert meta["lang"]

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "elsewhere"))
    env = make("OpenMicrowavePnP", seed=3, looks=True, layout="galley")
    env.reset()
    env.reset_from_xml_string(env.edit_model_xml(text))
    assert env.episode.start.digest == start
    assert env.get_ep_meta() == meta
    ran = []
    for state in kept["states"]:
        env.sim.set_state_from_flattened(state)
        env.sim.forward()
        env.update_state()
        ran.append(bool(env.world.fixtures["microwave"].on))
    assert ran[0] is False
    assert ran[-1] is True, "the press is seen on the way, not in the last state"

    env.reset_from_xml_string(env.edit_model_xml(text))
    env.sim.reset()
    env.sim.set_state_from_flattened(kept["states"][0])
    env.sim.forward()
    for info, state in zip(kept["action_infos"][:3], kept["states"][1:], strict=False):
        env.step(info["actions"])
        assert np.array_equal(env.sim.get_state().flatten(), state)

    env.set_ep_meta(meta)
    env.reset()
    assert (env.episode.start.digest, env.world) == (start, env.episode.start.world)
    env.set_ep_meta({"remac": {**meta["remac"], "start": "0" * 12}})
    with pytest.raises(OptionError, match="another version"):
        env.reset()
    with pytest.raises(OptionError, match="not the facts of a recorded episode"):
        env.reset_from_xml_string(text.replace("&quot;naming&quot;", "&quot;called&quot;"))
    env.close()


def test_cameras(monkeypatch: pytest.MonkeyPatch) -> None:
    from remac_env.rendering import gl

    try:
        if gl.probe() is None:
            pytest.skip("no OpenGL here")
    except RenderingError:
        pytest.skip("no OpenGL here")
    cameras = ["frontview", "side/sink", "robot0_eye_in_hand"]
    env = make(
        "HeatOnStove", seed=1, looks=True, has_offscreen_renderer=True, use_camera_obs=True, camera_names=cameras,
        camera_heights=96, camera_widths=96,
    )  # fmt: skip
    observed = env.reset()
    for camera in cameras:
        picture = observed[f"{camera}_image"]
        assert picture.shape == (96, 96, 3)
        assert picture.std() > 10, camera
    env.close()
