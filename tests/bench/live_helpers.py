"""What the tests of served pages share: a real server on loopback in a thread, and clients of it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
from bench_helpers import wait_for

pytest.importorskip("uvicorn", reason="installed before there was a server: pip install -e .")
pytest.importorskip("starlette", reason="installed before there was a server: pip install -e .")

from remac_bench.live.serving import Server  # noqa: E402 - it needs them


@contextmanager
def serving(app: Any) -> Iterator[Server]:
    """The application on a free port."""
    server = Server(app)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    wait_for(lambda: server._server.started)
    yield server
    server.stop()
    thread.join(30)
    assert not thread.is_alive()


def client(server: Server, *, known: bool = True, **keywords: Any) -> httpx.Client:
    """A browser, as it were: with the cookie, unless it is not `known`."""
    made = httpx.Client(base_url=f"http://127.0.0.1:{server.port}", trust_env=False, timeout=30, **keywords)
    if known:
        assert made.get(server.address).status_code == 200
    return made
