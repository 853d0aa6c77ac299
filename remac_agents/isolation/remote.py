"""This side of roles in other processes: one fork server for a set of roles, one fresh process for each job."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from remac_agents.isolation.codec import dumps, loads
from remac_agents.isolation.host import OPTIONAL
from remac_agents.isolation.lines import LONGEST_ANSWER, Ended, Lines
from remac_agents.roles import StopEpisode
from remac_agents.wiring.catalogue import VERBS
from remac_env import errors

Left = Callable[[], float | None]
"""Seconds that an answer may still take; None: as long as it takes."""


class RemoteError(Exception):
    """An exception that a role raised in its own process; `where`: the places it came through, there."""

    where: list[str] = []


class RoleDiedError(RuntimeError):
    """The process of a role ended in the middle of a question."""


class ForkServer:
    """A process that has imported the roles, and forks.

    Args:
        roles: role -> who fills it, as text or mapping.
        left: how long importing may take.
    """

    def __init__(self, roles: Mapping[str, Any], left: Left = lambda: None) -> None:
        ours, theirs = socket.socketpair()
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path or os.getcwd() for path in sys.path)}
        number = str(theirs.fileno())
        command = [sys.executable, "-m", "remac_agents.isolation.server", number, json.dumps(dict(roles))]
        self.process = subprocess.Popen(
            command, pass_fds=[theirs.fileno()], env=environment, start_new_session=True
        )  # in a session of its own: what a terminal sends to stop the run is not for it
        theirs.close()
        self._control, self._lock = Lines(ours), threading.Lock()
        try:
            told = json.loads(self._control.receive(left))
        except Ended:
            raise RoleDiedError(f"{', '.join(roles)}: the process ended while it was importing") from None
        except TimeoutError:
            self.close()
            raise
        if "raised" in told:
            self.close()
            raise _raised(told["raised"])

    def fork(self) -> tuple[int, Lines]:
        """A fresh process: its number, and the socket to it."""
        ours, theirs = socket.socketpair()
        with self._lock, theirs:
            try:
                socket.send_fds(self._control.socket, [b"fork"], [theirs.fileno()])
                return int(self._control.receive()), Lines(ours, LONGEST_ANSWER)
            except (OSError, Ended) as error:
                raise RoleDiedError("the process that imported the roles has ended") from error

    def status(self, number: int) -> str:
        """How a process that is gone ended."""
        with self._lock:
            try:
                self._control.socket.sendall(str(number).encode())
                return self._control.receive().decode()
            except (OSError, Ended):
                return "unknown"

    def close(self) -> None:
        """End it, and with it every process that it forked."""
        self._control.socket.close()
        self.process.kill()
        self.process.wait()


class Host:
    """The process of one job's roles. One that has died is replaced when the next episode begins.

    Args:
        server: who forks it.
        left: how long an answer may take; when the time is up, `late` is called, which raises.
    """

    def __init__(self, server: ForkServer, left: Left = lambda: None, late: Callable[[], None] = lambda: None) -> None:
        self._server, self._left, self._late = server, left, late
        self._lines: Lines | None = None
        self._number = 0
        self.described: Mapping[str, Any] = {}
        self.begin()

    def begin(self) -> None:
        """Have a living process."""
        if self._lines is not None:
            return
        self._number, self._lines = self._server.fork()
        self.described = self._exchange(None, {})["ready"]

    def roles(self) -> dict[str, Any]:
        """Role -> who fills it here."""
        return {name: _remote(self, name, facts) for name, facts in self.described.items()}

    def ask(self, role: str, verb: str, arguments: list[Any], named: Mapping[str, Any]) -> Any:
        """What the role answers.

        Raises:
            RemoteError: as the role did; StopEpisode too.
            RoleDiedError: when its process ended.
        """
        call = {"role": role, "verb": verb, "arguments": arguments, "named": dict(named)}
        return self._exchange(dumps(call), _callbacks(arguments))["answer"]

    def end(self) -> None:
        """End the process, whatever it is at."""
        if self._lines is not None:
            self._lines.socket.close()
            self._lines = None
            self._kill()
            self._server.status(self._number)

    def _kill(self) -> None:
        """End the process with what it started: none of it is there in the next job."""
        with suppress(ProcessLookupError, PermissionError):  # macOS says the latter where none is left
            os.killpg(self._number, signal.SIGKILL)

    def _exchange(self, line: bytes | None, callbacks: Mapping[str, Callable[..., Any]]) -> dict[str, Any]:
        """Send a line, and answer questions until the answer comes."""
        lines = self._lines
        if lines is None:
            raise RoleDiedError("the process of the roles has ended")
        try:
            if line is not None:
                lines.send(line)
            while True:
                told = loads(lines.receive(self._left))
                if "ask" not in told:
                    break
                lines.send(dumps({"answer": callbacks[told["ask"]](*told["arguments"])}))
        except Ended:
            self._lines = None
            lines.socket.close()
            self._kill()  # it may be there still, and send what is not a line
            status = self._server.status(self._number)
            raise RoleDiedError(f"the process of the roles ended with status {status}") from None
        except TimeoutError:
            self.end()
            self._late()
            raise
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            self.end()
            raise RoleDiedError(f"the process of the roles sent no answer ({type(error).__name__})") from error
        if "raised" in told:
            raise _raised(told["raised"])
        return dict(told)


class RemoteRole:
    """A role in its own process."""

    outside = isolated = True

    def __init__(self, host: Host, name: str, facts: Mapping[str, Any]) -> None:
        self._host, self._name, self._verbs = host, name, tuple(facts["verbs"])
        self.needs_truth, self.needs_rules = bool(facts["needs_truth"]), bool(facts["needs_rules"])
        self.needs_images = bool(facts["needs_images"])
        for verb in (*VERBS[name], *OPTIONAL):
            if verb in self._verbs and verb != "begin_episode":
                setattr(self, verb, self._verb(verb))

    def begin_episode(self, seed: int, iteration: int) -> None:
        """An episode begins, in a living process."""
        self._host.begin()
        if "begin_episode" in self._verbs:
            self._host.ask(self._name, "begin_episode", [seed, iteration], {})

    def _verb(self, verb: str) -> Callable[..., Any]:
        return lambda *arguments, **named: self._host.ask(self._name, verb, list(arguments), named)


def _remote(host: Host, name: str, facts: Mapping[str, Any]) -> RemoteRole:
    """A role whose class is called as the one in the other process is: errors name it."""
    return type(str(facts["class"]), (RemoteRole,), {})(host, name, facts)


def _callbacks(arguments: list[Any]) -> dict[str, Callable[..., Any]]:
    """The callables among the fields of the arguments, by name."""
    parts = [(name, part) for each in arguments for name, part in getattr(each, "__dict__", {}).items()]
    return {name: part for name, part in parts if callable(part)}


def _raised(told: Mapping[str, Any]) -> Exception:
    """An exception like the one that was raised in the other process, with the name of its class."""
    name, message = str(told["type"]), str(told["message"])
    if told["stop"] is not None:
        return StopEpisode(message, infrastructure=bool(told["stop"]))
    ours = getattr(errors, name, None)
    if ours in (errors.UnknownNameError, errors.OptionError):
        return ours(message)
    error: RemoteError = type(name, (RemoteError,), {"__module__": __name__})(message)
    error.where = [str(place) for place in told["where"]]
    return error
