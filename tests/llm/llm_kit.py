"""What the tests of the chat client share: a clock that need not be waited for, clients, and the table of faults."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest
from chaos_server import Act, ChaosServer

from remac_agents.llm import ChatClient, ChatError, ChatReply, read_settings, resolve
from remac_agents.llm.clock import Clock

KEY = "sk-canary-0123456789abcdef"
ASK = [{"role": "system", "content": "You plan."}, {"role": "user", "content": "Is it done?"}]


@dataclass
class FakeTime:
    """Real time, but sleeping takes none of it."""

    slept: list[float] = field(default_factory=list)
    skipped: float = 0.0
    wall: float = 1_800_000_000.0

    def sleep(self, seconds: float) -> None:
        self.slept.append(seconds)
        self.skipped += seconds

    @property
    def clock(self) -> Clock:
        return Clock(monotonic=lambda: time.monotonic() + self.skipped, wall=lambda: self.wall, sleep=self.sleep)


@dataclass
class Kit:
    """A server, time, a folder, and clients for them."""

    server: ChaosServer
    time: FakeTime
    folder: Path
    monkeypatch: pytest.MonkeyPatch

    def client(
        self,
        *,
        base_url: str | None = None,
        key: str = KEY,
        model: str = "test-model",
        stream: bool | None = None,
        options: dict[str, Any] | None = None,
        **more: Any,
    ) -> ChatClient:
        endpoint = resolve(f"custom:{model}", base_url=base_url or self.server.url)
        # The server stands for one that is far away: nobody knows what it costs.
        endpoint = replace(endpoint, model=replace(endpoint.model, price_in=None, price_out=None, priced_on=""))
        more = {"clock": self.time.clock, "jitter": lambda: 0.5, "environ": {"CUSTOM_API_KEY": key}} | more
        return ChatClient(endpoint, settings=read_settings({"stream": stream, **(options or {})}), **more)

    def outcome(self, *acts: Act, ask: dict[str, Any] | None = None, **more: Any) -> ChatReply | ChatError:
        """What comes of one call when the server plays these acts."""
        if acts:
            self.server.plays(*acts)
        with self.client(**more) as client:
            return client.complete(ASK, **{"max_tokens": 50, **(ask or {})})

    def reply(self, *acts: Act, **more: Any) -> ChatReply:
        outcome = self.outcome(*acts, **more)
        assert isinstance(outcome, ChatReply), outcome
        return outcome

    def error(self, *acts: Act, **more: Any) -> ChatError:
        outcome = self.outcome(*acts, **more)
        assert isinstance(outcome, ChatError), outcome
        assert KEY not in repr(outcome)
        return outcome


@contextmanager
def open_kit(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kit]:
    with ChaosServer() as server:
        yield Kit(server, FakeTime(), folder, monkeypatch)


Fault = Callable[[Kit], None]
FAULTS: dict[int, list[tuple[str, Fault]]] = {}


def fault(row: int) -> Callable[[Fault], Fault]:
    """The check belongs to this row of the fault table."""

    def note(check: Fault) -> Fault:
        FAULTS.setdefault(row, []).append((check.__name__, check))
        return check

    return note
