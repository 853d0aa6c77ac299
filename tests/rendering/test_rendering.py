"""Pictures show what is there, with OpenGL and with rays; the probe never lies for long; videos play."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest

from remac_env.errors import OptionError, RenderingError, UnknownNameError
from remac_env.rendering import gl, video
from remac_env.rendering.renderer import BEAUTY, OBSERVATION, Renderer

SCENE = """
<mujoco>
  <asset><material name="pane" rgba="0 0 1 1"/></asset>
  <worldbody>
    <light pos="0 -3 3" dir="0 1 -1" diffuse=".6 .6 .6"/>
    <geom name="red" type="box" size=".2 .2 .2" pos="-.4 0 0" rgba="1 0 0 1" group="1"/>
    <geom name="green" type="box" size=".2 .2 .2" pos=".4 0 0" rgba="0 1 0 1" group="1"/>
    <geom name="pane" type="box" size=".3 .02 .3" pos="-.4 -.5 0" material="pane" rgba=".5 .5 1 0" group="1"/>
    <geom name="collider" type="box" size="2 .02 2" pos="0 -1 0" rgba="1 1 1 1" group="3"/>
    <site name="mark" pos="0 -.8 0" size=".5" rgba="1 1 0 1"/>
    <camera name="eye" pos="0 -3 0" xyaxes="1 0 0 0 0 1" fovy="30"/>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def platform() -> str:
    name = gl.probe()
    if name is None:
        pytest.skip("no OpenGL platform works here")
    return name


@pytest.fixture
def scene() -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


@pytest.fixture(params=["rays", "gl"])
def backend(request: pytest.FixtureRequest) -> str:
    if request.param == "gl":
        request.getfixturevalue("platform")
    return request.param


def test_each_pixel_is_told_by_its_geom(backend: str, scene: tuple[mujoco.MjModel, mujoco.MjData]) -> None:
    model, data = scene
    with Renderer(model, 60, 40, backend=backend) as renderer:  # type: ignore[arg-type]
        before, found = renderer.render(data, "eye"), renderer.segment(data, "eye")
        assert np.array_equal(before, renderer.render(data, "eye")), "pictures are as they were"
    names = {int(geom): model.geom(geom).name if geom >= 0 else "" for geom in np.unique(found)}
    assert found.shape == (40, 60) and set(names.values()) == {"red", "green", ""}
    assert names[int(found[20, 15])] == "red" and names[int(found[20, 45])] == "green" and found[0, 0] == -1


def strongest(picture: np.ndarray, row: int, column: int) -> str:
    """Which of red, green and blue a pixel shows, or "grey"."""
    pixel = picture[row, column].astype(int)
    return "grey" if np.ptp(pixel) < 30 else ("red", "green", "blue")[int(pixel.argmax())]


def test_picture_shows_drawn_things_where_they_are(scene, backend: str) -> None:
    model, data = scene
    with Renderer(model, 96, 64, backend=backend) as renderer:
        assert renderer.backend == backend
        picture = renderer.render(data, "eye")
        by_number = renderer.render(data, 0)
    assert picture.shape == (64, 96, 3) and picture.dtype == np.uint8
    assert (picture == by_number).all()
    # Left red, right green; neither the collider in front of all nor the site hides them.
    assert strongest(picture, 32, 24) == "red" and strongest(picture, 32, 72) == "green"


def test_hidden_and_translucent_things(scene, backend: str) -> None:
    model, data = scene
    with Renderer(model, 96, 64, backend=backend) as renderer:
        assert strongest(renderer.render(data, "eye"), 32, 24) == "red"
        groups = model.geom_group.copy()
        model.geom("pane").rgba[3] = 1.0
        assert strongest(renderer.render(data, "eye"), 32, 24) == "blue"
        model.geom("pane").rgba[3] = 0.5
        mixed = renderer.render(data, "eye")[32, 24].astype(int)
    assert mixed[0] > mixed[1] - 5 and mixed[2] > 60 and mixed[0] > 60
    assert (model.geom_group == groups).all()


def test_both_backends_agree_on_the_view(scene, platform: str) -> None:
    model, data = scene
    outlines = []
    for backend in ("gl", "rays"):
        with Renderer(model, 96, 64, backend=backend) as renderer:
            outlines.append(np.ptp(renderer.render(data, "eye").astype(int), axis=2) > 30)
    assert outlines[0].any() and (outlines[0] != outlines[1]).mean() < 0.02


def test_presets_leave_the_model_as_it_was(scene, platform: str) -> None:
    model, data = scene
    before = (model.vis.quality.shadowsize, model.vis.quality.numslices, model.vis.global_.offwidth)
    with Renderer(model, 1000, 40, quality=BEAUTY) as renderer:
        assert renderer.render(data, "eye").shape == (40, 1000, 3)
    assert before == (model.vis.quality.shadowsize, model.vis.quality.numslices, model.vis.global_.offwidth)
    assert BEAUTY.shadows and not OBSERVATION.shadows


def test_wrong_use_is_named(scene) -> None:
    model, data = scene
    with pytest.raises(UnknownNameError, match="vulkan.*rays"):
        Renderer(model, 8, 8, backend="vulkan")  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="width 0"):
        Renderer(model, 0, 8, backend="rays")
    renderer = Renderer(model, 8, 8, backend="rays")
    with pytest.raises(UnknownNameError, match="nose.*eye"):
        renderer.render(data, "nose")
    with pytest.raises(UnknownNameError):
        renderer.render(data, 7)
    renderer.close()
    renderer.close()
    with pytest.raises(RenderingError, match="close"):
        renderer.render(data, "eye")


@pytest.fixture
def fresh(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A probe that remembers nothing, its file in an empty folder."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(gl, "_answers", {})
    monkeypatch.setattr(gl, "_complaints", {})
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    return tmp_path / "remac_env" / "gl.json"


def trials(monkeypatch: pytest.MonkeyPatch, working: set[str]) -> list[str]:
    """Replace the subprocess by a table; returns the list of platforms that get tried."""
    tried: list[str] = []

    def works(name: str) -> bool:
        tried.append(name)
        return name in working

    monkeypatch.setattr(gl, "_works", works)
    monkeypatch.setattr(gl.platform, "system", lambda: "Linux")
    return tried


def test_first_working_platform_is_found_once(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tried = trials(monkeypatch, {"osmesa", "glfw"})
    assert gl.probe() == gl.probe() == "osmesa"
    assert tried == ["egl", "osmesa"]
    monkeypatch.setattr(gl, "_answers", {})  # a new process
    assert gl.probe() == "osmesa" and len(tried) == 2
    monkeypatch.setattr(gl, "_answers", {})
    monkeypatch.setenv("LD_LIBRARY_PATH", "/elsewhere")  # another environment
    assert gl.probe() == "osmesa" and len(tried) == 4


def test_failure_is_not_remembered_on_disk(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trials(monkeypatch, set())
    assert gl.probe() is None and not fresh.exists()
    monkeypatch.setattr(gl, "_answers", {})
    trials(monkeypatch, {"egl"})
    assert gl.probe() == "egl"


@pytest.mark.parametrize("content", ["", "{", "[]", '"egl"', "KEY:3", "KEY:'rm -rf'", "KEY:'cgl'", "\x00\xff"])
def test_damaged_file_is_ignored(fresh: Path, monkeypatch: pytest.MonkeyPatch, content: str) -> None:
    tried = trials(monkeypatch, {"egl"})
    fresh.parent.mkdir(parents=True)
    if content.startswith("KEY:"):
        content = json.dumps({gl._key(): content[4:].strip("'") if "'" in content else 3})
    fresh.write_text(content, encoding="latin-1")
    assert gl.probe() == "egl" and tried == ["egl"]


def test_unwritable_cache_is_no_matter(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trials(monkeypatch, {"egl"})
    fresh.parent.parent.joinpath("remac_env").write_text("a file where the folder should be")
    assert gl.probe() == "egl"


def test_users_choice_is_honoured_or_refused_with_the_fix(fresh: Path, monkeypatch: pytest.MonkeyPatch, scene) -> None:
    tried = trials(monkeypatch, {"egl", "osmesa"})
    monkeypatch.setenv("MUJOCO_GL", "osmesa")
    assert gl.probe() == "osmesa" and tried == ["osmesa"]
    monkeypatch.setenv("MUJOCO_GL", "disable")
    assert gl.probe() is None and tried == ["osmesa"]
    with Renderer(scene[0], 8, 8) as renderer:
        assert renderer.backend == "rays"
    with pytest.raises(RenderingError, match="MUJOCO_GL forbids"):
        Renderer(scene[0], 8, 8, backend="gl")
    for wrong in ("glfw", "voodoo"):
        monkeypatch.setenv("MUJOCO_GL", wrong)
        with pytest.raises(RenderingError, match=f"MUJOCO_GL='{wrong}'.*egl.*rays"):
            Renderer(scene[0], 8, 8)
        with Renderer(scene[0], 8, 8, backend="rays") as renderer:
            assert renderer.render(scene[1], "eye").shape == (8, 8, 3)


def test_platform_that_fails_in_use_gives_way_to_rays(fresh: Path, monkeypatch: pytest.MonkeyPatch, scene) -> None:
    tried = trials(monkeypatch, {"egl"})
    gl.probe()
    assert fresh.exists()

    def broken(name: str) -> None:
        raise RenderingError(f"{name} is gone")

    monkeypatch.setattr(gl, "activate", broken)
    with Renderer(scene[0], 8, 8) as renderer:
        assert renderer.backend == "rays"
    assert not fresh.exists() and gl.probe() is None and tried == ["egl"]


def test_a_wrong_platform_is_caught_by_the_trial_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gl, "_complaints", {})
    monkeypatch.setattr(gl, "_TRIAL", "raise SystemExit('no such thing')")
    assert not gl._works("egl") and gl._complaints == {"egl": "no such thing"}
    monkeypatch.setattr(gl, "_TRIAL", "import time; time.sleep(60)")
    monkeypatch.setattr(gl, "_TRIAL_SECONDS", 0.2)
    assert not gl._works("osmesa") and "timed out" in gl._complaints["osmesa"]


def test_probing_sets_no_environment_variable_and_imports_no_simulator() -> None:
    code = (
        "import os, sys; before = dict(os.environ); from remac_env.rendering import gl;"
        "gl.probe(); raise SystemExit(dict(os.environ) != before or 'mujoco' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def frames(count: int, size: tuple[int, int] = (48, 64)) -> list[np.ndarray]:
    return [np.full((*size, 3), (200, 20, count and 200 * i // count), np.uint8) for i in range(count)]


def test_video_plays_back(tmp_path: Path) -> None:
    import cv2

    path = tmp_path / "run.webm"
    assert video.write(path, frames(400)) == video.MAX_FRAMES
    assert path.read_bytes()[:4] == b"\x1a\x45\xdf\xa3"
    reader, seen = cv2.VideoCapture(str(path)), []
    while True:
        good, picture = reader.read()
        if not good:
            break
        seen.append(picture[24, 32])
    assert len(seen) == video.MAX_FRAMES
    blue, green, red = seen[-1]
    assert red > 150 and green < 80 and blue > 150 > 60 > seen[0][0]
    assert list(tmp_path.iterdir()) == [path]


def test_video_is_quiet(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    video.write(tmp_path / "run.webm", frames(3))
    out, err = capfd.readouterr()
    assert out == "" and err == ""


def test_bad_video_leaves_nothing_behind(tmp_path: Path) -> None:
    for bad in ([], [np.zeros((4, 4), np.uint8)], [*frames(2), *frames(1, (50, 64))]):
        with pytest.raises(OptionError):
            video.write(tmp_path / "run.webm", bad)
    with pytest.raises(OptionError, match="webm"):
        video.write(tmp_path / "run.mp4", frames(2))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("limit", [2, 7, 8, 150])
@pytest.mark.parametrize("count", [1, 8, 9, 20, 1000])
def test_time_lapse_is_even_and_bounded(limit: int, count: int) -> None:
    sampler, drawn = video.Sampler(limit), 0
    for moment in range(count):
        if sampler.wants():
            drawn += 1
            sampler.add(np.array(moment))  # type: ignore[arg-type]
    kept = [int(frame) for frame in sampler.frames]
    assert kept[0] == 0 and len(kept) <= limit and len(set(np.diff(kept))) <= 1
    assert len(kept) >= min(count, limit // 2)
    assert drawn < 2 * limit + limit * np.log2(count + 1)
