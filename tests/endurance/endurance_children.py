"""What child processes run. Importable by them, and without pytest."""

from __future__ import annotations

from multiprocessing.connection import Connection
from typing import Any

import endurance_survival as survival

Sent = tuple[str, Any]


def spawned(connection: Connection, backend: str, seed: int) -> None:
    """A whole episode of this process's own."""
    _answer(connection, lambda: [survival.begin(env := survival.make(backend), seed), *survival.walk(env, **WALK)])


def inherited(connection: Connection, env: Any) -> None:
    """Go on with an environment that came from the parent: by fork as it is, by spawn in a pickle."""
    _answer(connection, lambda: survival.walk(env, **WALK))


def measured(connection: Connection, backend: str, what: str, warm: int, times: int) -> None:
    """Bytes by which this process grows a call: memory that other tests have freed is in nobody's way here."""
    env, kept = survival.make(backend), []

    def reset(number: int) -> None:
        survival.begin(env, number % 40)
        survival.walk(env, rounds=1 if backend == "symbolic" else 0, salt=number)

    def open_and_close(number: int) -> None:
        other = survival.make(backend)
        survival.begin(other, number % 40)
        survival.walk(other, rounds=1, salt=0)
        other.close()

    def keep_what_is_told(number: int) -> None:
        kept.append(env.reset(seed=number % 40))

    def never_close(number: int) -> None:
        kept.append(survival.make(backend))
        survival.begin(kept[-1], number % 40)

    calls = {call.__name__: call for call in (reset, open_and_close, keep_what_is_told, never_close)}
    _answer(connection, lambda: survival.growth(calls[what], warm=warm, times=times))


WALK = {"rounds": 3, "salt": 5}
"""How a child goes on."""


def _answer(connection: Connection, work: Any) -> None:
    try:
        connection.send(("done", work()))
    except Exception as error:  # noqa: BLE001 - whatever it is, the parent is to see it
        connection.send(("failed", repr(error)))
    finally:
        connection.close()
