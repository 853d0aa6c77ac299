"""Pictures, and then something else: a copy, a fork, the end of the interpreter."""

from __future__ import annotations

import copy
import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import remac_env
from remac_env.rendering.renderer import Renderer

TASK = "OpenCabinetPnP"

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this platform does not fork")

COPIES: dict[str, Callable[[Any], Any]] = {
    "deepcopy": copy.deepcopy,
    "pickle": lambda env: pickle.loads(pickle.dumps(env)),
}

copied = pytest.mark.parametrize("duplicate", COPIES.values(), ids=COPIES)

# -- copies ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("backend", "duplicate"),
    [
        pytest.param("symbolic", COPIES["deepcopy"], marks=pytest.mark.long),
        pytest.param("physics", COPIES["pickle"], marks=pytest.mark.long),
    ],
)
def test_a_kitchen_that_was_drawn_can_be_copied(backend: str, duplicate: Callable[[Any], Any]) -> None:
    env = remac_env.parallel_env(
        TASK, robots=1, backend=backend, render_mode="rgb_array", obs="state+images", image_size=32
    )
    env.start_recording()
    env.reset(seed=3)
    env.render()
    twin = duplicate(env)
    assert np.array_equal(twin.render(), env.render())
    go = {"robot_0": env.vocabulary.encode("navigate to cabinet")}
    one, other = env.step(go), twin.step(go)
    for key, value in one[0]["robot_0"].items():
        assert np.array_equal(value, other[0]["robot_0"][key]), key
    assert np.array_equal(twin.render(), env.render())
    assert len(twin._pictures._tape.frames) == len(env._pictures._tape.frames) > 1, "the copy goes on filming"
    env.close()
    assert twin.render().std() > 5, "closing the one takes the other's renderer"
    twin.close()


@pytest.mark.long
def test_the_other_views_can_be_copied_too() -> None:
    single = gymnasium.make(f"RemacKitchen-{TASK}-v0", robots=2, backend="symbolic", render_mode="rgb_array")
    single.reset(seed=3)
    cycle = remac_env.env(TASK, backend="symbolic", render_mode="rgb_array")
    cycle.reset(seed=3)
    for env, duplicate in zip((single, cycle), COPIES.values(), strict=True):
        picture = env.render()
        twin = duplicate(env)
        assert np.array_equal(twin.render(), picture)
        twin.close()
        env.close()


@pytest.mark.few(1)
@copied
def test_a_kitchen_in_a_window_can_be_copied(duplicate: Callable[[Any], Any]) -> None:
    env = remac_env.parallel_env(TASK, backend="symbolic", render_mode="human")
    env.reset(seed=3)
    assert env.render() is None
    env._pictures._window._viewer = _Viewer()  # as where there is a display
    twin = duplicate(env)
    assert twin.render() is None and twin._pictures._window is not env._pictures._window


class _Viewer:
    """Like MuJoCo's, it cannot be copied."""

    def __reduce__(self) -> tuple[object, ...]:
        raise TypeError("a window cannot be copied")

    def is_running(self) -> bool:
        return False

    def close(self) -> None:
        """Nothing is open."""


@copied
def test_a_renderer_can_be_copied(duplicate: Callable[[Any], Any]) -> None:
    import mujoco

    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><light pos='0 0 3'/><camera name='eye' pos='0 0 3'/><geom size='.3'/></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with Renderer(model, 32, 32) as renderer, duplicate(renderer) as twin:
        assert np.array_equal(renderer.render(data, "eye"), twin.render(data, "eye"))
        assert twin.backend == renderer.backend
    with pytest.raises(remac_env.errors.RenderingError, match="after close"):
        duplicate(renderer).render(data, "eye")


# -- forks ----------------------------------------------------------------------------------------------------------

_MAKE = f"""
import os, sys, gymnasium, numpy, remac_env
def make():
    return gymnasium.make("RemacKitchen-{TASK}-v0", robots=1, backend="symbolic", obs="state+images", image_size=32,
                          render_mode="rgb_array")
first = make()
first.reset(seed=0)
first.render()
"""

_VECTOR = """
from gymnasium.vector import AsyncVectorEnv
both = AsyncVectorEnv([make, make], context="fork")
both.reset(seed=[0, 1])
seen, *_ = both.step(numpy.zeros(2, int))
assert seen["robot_0_front"].std() > 5
both.close()
assert first.render().std() > 5
"""

_INHERITED = """
child = os.fork()
if child == 0:
    first.step(0)
    first.reset(seed=1)
    assert first.render().std() > 5
    first.close()
    make().reset(seed=3)
    sys.exit(7)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
first.reset(seed=1)
assert first.render().std() > 5
"""

_INSISTS = """
from remac_env.errors import RenderingError
from remac_env.rendering.renderer import Renderer
import mujoco
child = os.fork()
if child == 0:
    try:
        Renderer(mujoco.MjModel.from_xml_string("<mujoco/>"), 16, 16, backend="gl")
    except RenderingError as error:
        os._exit(7 if "spawn" in str(error) else 1)
    os._exit(2)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
"""


@pytest.mark.parametrize(
    "code",
    [
        pytest.param(_VECTOR, id="vector", marks=pytest.mark.long),
        pytest.param(_INHERITED, id="inherited", marks=pytest.mark.long),
        pytest.param(_INSISTS, id="insists", marks=pytest.mark.long),
    ],
)
def test_a_forked_child_draws_by_rays_what_its_parent_drew_by_opengl(code: str) -> None:
    done = _run(_MAKE + code)
    assert done.returncode == 0, done.stderr


@pytest.mark.long
def test_without_notice_of_the_fork_the_child_waits_for_ever() -> None:
    """Or else the tests above would prove nothing."""
    from remac_env.rendering import gl

    if gl.probe() != "egl":
        pytest.skip("this is what EGL's drivers do")
    with pytest.raises(subprocess.TimeoutExpired):
        _run("from remac_env.rendering import contexts\ncontexts._watched = True\n" + _MAKE + _VECTOR, seconds=30)


# -- the interpreter's end ------------------------------------------------------------------------------------------

_ENDS = {
    "a folder before": "import tempfile\nfolder = tempfile.TemporaryDirectory()\n{draw}",
    "a thread": "import tempfile, threading\nfolder = tempfile.TemporaryDirectory()\n{made}\n"
    "thread = threading.Thread(target=draw)\nthread.start()\nthread.join()",
    "drawn once more at the end": "import atexit\natexit.register(lambda: (env.reset(seed=1), env.render()))\n{draw}",
    "a cycle": "import tempfile\nfolder = tempfile.TemporaryDirectory()\n{draw}\nenv.itself = env",
    "a forked child": "import multiprocessing\n{made}\n"
    "child = multiprocessing.get_context('fork').Process(target=draw)\nchild.start()\nchild.join()\n"
    "assert child.exitcode == 0",
    "mujoco before": "import mujoco\n{draw}",
    "an error": "import tempfile\nfolder = tempfile.TemporaryDirectory()\n{draw}\nimport sys\nsys.exit(0)",
}
_DRAWN = f"""
import remac_env
def draw():
    global env
    env = remac_env.parallel_env("{TASK}", backend="symbolic", render_mode="rgb_array")
    env.reset(seed=0)
    env.render()
"""
_SLOW = tuple(case for case in _ENDS if case != "a folder before")


@pytest.mark.parametrize("case", [pytest.param(c, marks=pytest.mark.long) if c in _SLOW else c for c in _ENDS])
def test_the_interpreter_ends_in_silence(case: str) -> None:
    done = _run(_ENDS[case].replace("{draw}", f"{_DRAWN}\ndraw()").replace("{made}", _DRAWN))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.long
def test_a_renderer_that_outlives_its_display_is_heard() -> None:
    """Or else the test above would prove nothing."""
    from remac_env.rendering import gl

    if gl.probe() != "egl":
        pytest.skip("this is what EGL does")
    code = "import weakref\nfrom remac_env.rendering import contexts\n"
    code += "contexts.hold = lambda renderer: weakref.finalize(contexts, renderer.close)\n"
    done = _run("import tempfile\nfolder = tempfile.TemporaryDirectory()\n" + code + _DRAWN + "\ndraw()")
    assert "EGL" in done.stderr


def _run(code: str, *, seconds: float = 120.0) -> subprocess.CompletedProcess[str]:
    """A Python of its own; the timeout is there for children that wait for ever."""
    root = Path(remac_env.__file__).parent.parent
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=root,
        start_new_session=True,
    )  # fmt: skip
    try:
        out, err = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)  # its children, too
        process.communicate()
        raise
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)

