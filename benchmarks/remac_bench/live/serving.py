"""A server of one application on loopback, until somebody stops it."""

from __future__ import annotations

import socket
from typing import Any

from remac_bench.errors import UsageError
from remac_bench.live.guard import HOSTS, Guard, new_token


class Server:
    """Listens from the start, so that its address is known; serves while `run` lasts."""

    def __init__(self, app: Any, *, port: int = 0) -> None:
        """Args: port: on which to listen; 0: one that is free.

        Raises:
            UsageError: where the port cannot be had, or the packages of the server are missing.
        """
        try:
            import uvicorn
        except ImportError as error:
            raise UsageError("uvicorn is not installed; install remac-kitchen again: pip install -e .") from error
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self._socket.bind((HOSTS[0], port))
        except OSError as error:
            self._socket.close()
            raise UsageError(f"port {port} cannot be had ({error.strerror}); give another --port, or none") from error
        self.port, token = self._socket.getsockname()[1], new_token()
        self.address = f"http://{HOSTS[0]}:{self.port}/?token={token}"
        guarded = Guard(app, token=token, port=self.port)
        config = uvicorn.Config(
            guarded, log_level="warning", access_log=False, lifespan="off", ws="none", server_header=False,
            proxy_headers=False, timeout_graceful_shutdown=1,
        )  # fmt: skip
        self._server = uvicorn.Server(config)

    def run(self) -> None:
        """Serve until Ctrl-C, SIGTERM or `stop`."""
        try:
            self._server.run(sockets=[self._socket])
        except KeyboardInterrupt:
            pass  # how a person ends it
        finally:
            self._socket.close()

    def stop(self) -> None:
        """End `run`, from any thread."""
        self._server.should_exit = True
