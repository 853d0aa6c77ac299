"""check_lifecycle: calls at the wrong moment raise, closing never does."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from remac_env.testing.play import ContractError, EnvMaker, expect

if TYPE_CHECKING:
    from remac_env.envs.parallel import KitchenParallelEnv


def check_lifecycle(env_fn: EnvMaker, *, seed: int = 0) -> None:
    """Step and render before reset, after the end and after close; end an episode by `done`; reset in mid-episode;
    close twice, and close what was never reset.

    Raises:
        ContractError: naming the call that should have raised, or should not have.
    """
    _check_before_reset(env_fn)
    with _kept(env_fn) as env:
        env.reset(seed=seed)
        wait, done = (dict.fromkeys(env.agents, env.vocabulary.encode(word)) for word in ("wait", "done"))
        env.step(wait)
        _, infos = env.reset(seed=seed)
        expect(env.agents == env.possible_agents, "check_lifecycle: a reset does not bring all robots back")
        untouched = not any(info["outcome"] for info in infos.values())
        expect(untouched, "check_lifecycle: outcomes of the old episode are told after reset")
        _, _, terminations, _, _ = env.step(done)
        expect(all(terminations.values()), "check_lifecycle: the episode continues though every robot has said `done`")
        expect(not env.agents, f"check_lifecycle: robots {env.agents} are alive after the end")
        _must_raise(lambda: env.step(wait), "step() after the end of the episode")
        _must_raise(lambda: env.step({}), "step({}) after the end of the episode")
        env.reset(seed=seed)
        env.step(wait)
        _must_not_raise(env.close, "close()")
        _must_raise(lambda: env.step(wait), "step() after close()")
        _must_raise(lambda: env.reset(seed=seed), "reset() after close()")
        _must_raise(env.render, "render() after close()")
        _must_not_raise(env.close, "close() a second time")


def _check_before_reset(env_fn: EnvMaker) -> None:
    with _kept(env_fn) as env:
        wait = dict.fromkeys(env.possible_agents, env.vocabulary.encode("wait"))
        _must_raise(lambda: env.step(wait), "step() before reset()")
        _must_raise(lambda: env.step({}), "step({}) before reset()")
        _must_raise(env.render, "render() before reset()")
        _must_not_raise(env.close, "close() without reset()")


@contextmanager
def _kept(env_fn: EnvMaker) -> Iterator[KitchenParallelEnv]:
    """A fresh environment; whether it can be closed at all is what is being looked at."""
    env = env_fn()
    try:
        yield env
    finally:
        with suppress(Exception):
            env.close()


def _must_raise(call: Callable[[], Any], what: str) -> None:
    try:
        call()
    except Exception as error:  # noqa: BLE001 - which exception it is, is for the environment to choose
        expect(str(error), f"check_lifecycle: {what} raised {type(error).__name__} without a message")
        return
    raise ContractError(f"check_lifecycle: {what} did not raise")


def _must_not_raise(call: Callable[[], Any], what: str) -> None:
    try:
        call()
    except Exception as error:
        raise ContractError(f"check_lifecycle: {what} raised {error!r}") from error
