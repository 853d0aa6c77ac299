"""Roles that are code from outside, in processes of their own: what the jobs of one process share of it."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from remac_agents.isolation.remote import ForkServer
    from remac_bench.watch import Deadline


class Servers:
    """A fork server for each set of roles that is played; see `remac_agents.isolation`."""

    def __init__(self) -> None:
        self._servers: dict[str, ForkServer] = {}
        self._lock = threading.Lock()

    @contextmanager
    def roles(self, given: Mapping[str, Any], deadline: Deadline) -> Iterator[dict[str, Any]]:
        """Role -> who fills it, in one fresh process that ends with the block; nothing where nothing is given.

        Raises:
            UnknownNameError, OptionError: for roles that cannot be imported or made; what else they raise too.
            JobTimeoutError: when the job's time is up.
        """
        if not given:
            yield {}
            return
        from remac_agents.isolation.remote import Host

        try:
            server = self._server(given, deadline)
        except TimeoutError:
            deadline.check()
            raise
        host = Host(server, lambda: deadline.left, deadline.check)
        try:
            yield host.roles()
        finally:
            host.end()

    def close(self) -> None:
        """End them all."""
        with self._lock:
            for server in self._servers.values():
                server.close()
            self._servers.clear()

    def _server(self, given: Mapping[str, Any], deadline: Deadline) -> ForkServer:
        from remac_agents.isolation.remote import ForkServer

        name = json.dumps(dict(given), sort_keys=True)
        with self._lock:
            server = self._servers.get(name)
            if server is None or server.process.poll() is not None:
                server = self._servers[name] = ForkServer(given, lambda: deadline.left)
            return server
