"""Roles that are code from outside, in processes of their own: what the jobs of one process share of it."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from remac_bench.errors import UsageError

if TYPE_CHECKING:
    from remac_agents.isolation.remote import ForkServer
    from remac_bench.playing.deadline import Deadline


def plugins(agent: Mapping[str, Any], *, providers: str | None = None) -> dict[str, Any]:
    """Role -> who fills it, for the roles of an agent with these options that are code from outside.

    Args:
        providers: see `agents.Access`.
    """
    from remac_agents.wiring.catalogue import ROLES, is_plugin

    return {name: agent[name] for name in ROLES if name in agent and is_plugin(name, agent[name], providers=providers)}


def facts_of(role: str, given: object) -> dict[str, Any]:
    """What a role that is code from outside says of itself (`needs_images` ...), without it being imported here.

    Raises:
        UnknownNameError, OptionError: for one that cannot be imported or made; what else it raises too.
    """
    return dict(_facts(role, json.dumps(given)))


@contextmanager
def usable() -> Iterator[None]:
    """Before anything is played: whatever code from outside raises is a role that cannot be used.

    Raises:
        UsageError: naming what it raised, and where.
    """
    from remac_agents.isolation.remote import RemoteError, RoleDiedError

    try:
        yield
    except (RemoteError, RoleDiedError) as error:
        where = error.where[-1:] if isinstance(error, RemoteError) else []
        told = ", ".join([f"{type(error).__name__}: {error}", *where])
        raise UsageError(f"a role that is code from outside cannot be made: {told}") from error


@lru_cache(maxsize=64)
def _facts(role: str, given: str) -> Mapping[str, Any]:
    from remac_bench.playing.deadline import JOB_SECONDS, Deadline

    servers = Servers()
    try:
        with usable(), servers.roles({role: json.loads(given)}, Deadline.within(JOB_SECONDS)) as roles:
            made = roles[role]
            return {name: getattr(made, name) for name in ("needs_truth", "needs_rules", "needs_images")}
    finally:
        servers.close()


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
