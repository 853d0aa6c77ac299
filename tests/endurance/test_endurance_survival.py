"""Copies, child processes, threads, crowds, and thousands of resets: environments go on and go on alike."""

from __future__ import annotations

import copy
import multiprocessing
import os
import pickle
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import endurance_children as children
import endurance_survival as survival
import pytest

linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="fork and /proc are Linux's")
both = pytest.mark.parametrize("backend", ["symbolic", "physics"])

COPIERS: dict[str, Callable[[Any], Any]] = {
    "pickle": lambda env: pickle.loads(pickle.dumps(env)),
    "deepcopy": copy.deepcopy,
}


# -- copies -----------------------------------------------------------------------------------------------------------


@both
@pytest.mark.parametrize("how", COPIERS)
def test_a_copy_in_mid_episode_goes_on_bit_by_bit(backend: str, how: str) -> None:
    """Each by itself: what the one does, the other does not feel."""
    env = survival.make(backend, starts="mixed")
    survival.begin(env, 21)
    survival.walk(env, rounds=1, salt=1)
    other = COPIERS[how](env)
    assert survival.fingerprint(other) == survival.fingerprint(env)
    here = survival.walk(env, rounds=2, salt=2)
    assert survival.walk(other, rounds=2, salt=2) == here and len(set(here)) > 1
    env.close()
    assert len(survival.walk(other, rounds=1, salt=3)) == 1


@both
@pytest.mark.parametrize("how", COPIERS)
@pytest.mark.parametrize("moment", ["fresh", "ended", "closed"])
def test_copies_at_other_moments(backend: str, how: str, moment: str) -> None:
    env = survival.make(backend)
    if moment == "ended":
        survival.begin(env, 4)
        env.step(dict.fromkeys(env.agents, env.vocabulary.encode("done")))
    if moment == "closed":
        env.close()
    other = COPIERS[how](env)
    assert other.agents == env.agents == []
    if moment == "closed":
        with pytest.raises(RuntimeError, match="closed"):
            survival.begin(other, 4)
    else:
        assert survival.begin(other, 5) == survival.begin(env, 5)


def test_a_copy_that_shares_its_world_would_be_seen() -> None:
    """`copy.copy` shares the backend: the walks of original and copy get mixed up."""
    env = survival.make("symbolic")
    survival.begin(env, 21)
    other = copy.copy(env)
    here = survival.walk(env, rounds=6, salt=2)
    assert survival.walk(other, rounds=6, salt=2) != here


# -- processes --------------------------------------------------------------------------------------------------------


def _in_child(method: str, target: Callable[..., None], *args: Any) -> Any:
    """What a child process sends, or a failure after ten minutes."""
    context = multiprocessing.get_context(method)
    ours, theirs = context.Pipe(duplex=False)
    child = context.Process(target=target, args=(theirs, *args))
    child.start()
    theirs.close()
    try:
        assert ours.poll(600), "the child process says nothing"
        status, told = ours.recv()
    finally:
        child.join(10)
        if child.is_alive():
            child.kill()
    assert status == "done", told
    return told


@pytest.fixture
def _children_find_this_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    root = Path(__file__).parents[2]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(root), str(Path(__file__).parent)]))


@pytest.mark.parametrize("backend", ["symbolic", pytest.param("physics", marks=pytest.mark.long)])
@pytest.mark.usefixtures("_children_find_this_folder")
def test_a_spawned_process_plays_the_same_episode(backend: str) -> None:
    env = survival.make(backend)
    expected = [survival.begin(env, 33), *survival.walk(env, **children.WALK)]
    assert _in_child("spawn", children.spawned, backend, 33) == expected
    assert _in_child("spawn", children.spawned, backend, 34) != expected


@both
@pytest.mark.parametrize("method", ["spawn", pytest.param("fork", marks=linux)])
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.usefixtures("_children_find_this_folder")
def test_a_child_goes_on_with_its_environment_as_the_parent_does(backend: str, method: str) -> None:
    """The child first; the parent does not notice. A walk of another salt is another one."""
    env = survival.make(backend)
    survival.begin(env, 33)
    survival.walk(env, rounds=1, salt=1)
    told = _in_child(method, children.inherited, env)
    twin = copy.deepcopy(env)
    assert survival.walk(env, **children.WALK) == told
    assert survival.walk(twin, rounds=3, salt=6) != told


@linux
def test_a_failing_child_is_heard() -> None:
    with pytest.raises(AssertionError, match="no episode has begun|_episode|terms"):
        _in_child("fork", children.inherited, survival.make("symbolic"))


# -- threads and crowds -----------------------------------------------------------------------------------------------


def _threaded(backend: str, rounds: int) -> tuple[list[Any], list[Any]]:
    """What eight environments told, played at the same time and one after the other."""

    def play(number: int, told: list[Any]) -> None:
        try:
            env = survival.make(backend)
            told[number] = [survival.begin(env, 50 + number), *survival.walk(env, rounds=rounds, salt=number)]
        except Exception as error:  # noqa: BLE001 - threads must not fail in silence
            told[number] = repr(error)

    together: list[Any] = [None] * 8
    threads = [threading.Thread(target=play, args=(number, together)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    serial: list[Any] = [None] * 8
    for number in range(8):
        play(number, serial)
    return together, serial


@pytest.mark.parametrize(("backend", "rounds"), [("symbolic", 20), ("physics", 1)])
def test_eight_threads_do_not_disturb_one_another(backend: str, rounds: int) -> None:
    together, serial = _threaded(backend, rounds)
    assert together == serial
    assert all(isinstance(told, list) for told in serial) and len({str(told) for told in serial}) == 8


def _crowd(backend: str, count: int, rounds: int) -> None:
    """Many environments, stepped in turns, play what each would play alone."""
    envs = [survival.make(backend) for _ in range(count)]
    digests = [survival.begin(env, 60 + number % 4) for number, env in enumerate(envs)]
    told: list[list[str]] = [[] for _ in envs]
    for turn in range(rounds):
        for number, env in enumerate(envs):
            told[number] += survival.walk(env, rounds=1, salt=turn)
    for first in range(4):
        assert len(set(digests[first::4])) == 1 and len({tuple(t) for t in told[first::4]}) == 1
    assert len(set(digests)) == 4 and len({tuple(t) for t in told}) == 4
    for env in envs:
        env.close()


@pytest.mark.parametrize(
    ("backend", "count", "rounds"),
    [("symbolic", 100, 5), ("physics", 10, 1), pytest.param("physics", 40, 1, marks=pytest.mark.long)],
)
def test_many_environments_at_once(backend: str, count: int, rounds: int) -> None:
    _crowd(backend, count, rounds)


@pytest.mark.long
def test_two_hundred_physical_environments_at_once() -> None:
    _crowd("physics", 200, 2)


# -- memory -----------------------------------------------------------------------------------------------------------

MOST = {"symbolic": 500.0, "physics": 5000.0}
"""Bytes a reset up to which memory counts as not growing: a small part of what one kept episode takes."""


def _grown(backend: str, what: str, *, warm: int, times: int) -> float:
    return float(_in_child("spawn", children.measured, backend, what, warm, times))


@linux
@pytest.mark.long
@pytest.mark.parametrize(("backend", "times"), [("symbolic", 5000), ("physics", 500)])
@pytest.mark.usefixtures("_children_find_this_folder")
def test_resets_do_not_take_more_and_more_memory(backend: str, times: int) -> None:
    assert _grown(backend, "reset", warm=times // 5, times=times) < MOST[backend]


@linux
@pytest.mark.long
@both
@pytest.mark.usefixtures("_children_find_this_folder")
def test_environments_that_are_closed_give_their_memory_back(backend: str) -> None:
    assert _grown(backend, "open_and_close", warm=120, times=120) < 10 * MOST[backend]


@linux
@pytest.mark.parametrize(
    ("backend", "what", "factor"),
    [("symbolic", "keep_what_is_told", 2), pytest.param("physics", "never_close", 20, marks=pytest.mark.long)],
)
@pytest.mark.usefixtures("_children_find_this_folder")
def test_a_planted_leak_is_seen(backend: str, what: str, factor: int) -> None:
    """Keeping what each reset told, or environments that are never closed, is well above what is allowed."""
    assert _grown(backend, what, warm=20, times=40) > factor * MOST[backend]
