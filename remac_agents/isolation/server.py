"""The fork server: imports roles of one's own once, and forks a fresh process for each job.

    python -m remac_agents.isolation.server NUMBER ROLES
NUMBER: the file descriptor of the control socket. ROLES: JSON, role -> who fills it, as `catalogue.make_role` takes it.
Over the control socket it is sent the socket of each process that is wanted, and answers with the process's number;
sent a number, it waits for that process and answers with how it ended. It ends when nobody is there any more.
"""

from __future__ import annotations

import ctypes
import gc
import json
import os
import signal
import socket
import sys
from contextlib import suppress
from typing import Any

from remac_agents.isolation.codec import classes
from remac_agents.isolation.host import serve, told_error
from remac_agents.isolation.lines import Ended, Lines
from remac_agents.wiring.catalogue import find_plugin

_DIE_WITH_PARENT = 1
"""PR_SET_PDEATHSIG of Linux."""


def main(number: int, roles: dict[str, Any]) -> None:
    """Serve until the other side is gone."""
    control = socket.socket(fileno=number)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides when to stop
    try:
        for role, given in roles.items():
            find_plugin(role, given)
        ready: dict[str, Any] = {"ready": True}
    except BaseException as error:  # noqa: BLE001 - whatever a stranger's module raises; it is told
        ready = {"raised": told_error(error)}
    classes()  # imported here, once
    gc.collect()
    gc.freeze()  # so that the garbage collector of a child leaves shared pages alone
    with suppress(OSError):  # whoever asked may be gone at any time
        control.sendall(json.dumps(ready).encode() + b"\n")
        _fork(control, roles)


def _fork(control: socket.socket, roles: dict[str, Any]) -> None:
    """Do what is asked for over the control socket."""
    while True:
        message, descriptors, _, _ = socket.recv_fds(control, 64, 1)
        if not message:
            return
        if not descriptors:
            _, status = os.waitpid(int(message), 0)
            control.sendall(f"{os.waitstatus_to_exitcode(status)}\n".encode())
            continue
        child = os.fork()
        if child == 0:
            control.close()
            os.setpgid(0, 0)  # here and below: whoever comes first
            _play(socket.socket(fileno=descriptors[0]), roles)
        with suppress(OSError):  # it may have ended
            os.setpgid(child, child)
        os.close(descriptors[0])
        control.sendall(f"{child}\n".encode())


def _play(end: socket.socket, roles: dict[str, Any]) -> None:
    """In the child: serve, and end without whatever the modules want to do at the end."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
    quiet = os.open(os.devnull, os.O_RDONLY)
    os.dup2(quiet, 0)
    try:
        with suppress(Ended):
            serve(Lines(end), roles)
    finally:
        os._exit(0)


if __name__ == "__main__":
    main(int(sys.argv[1]), json.loads(sys.argv[2]))
