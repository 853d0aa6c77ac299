"""A language model's endpoint that misbehaves as told: real sockets on 127.0.0.1, one thread a connection."""

from __future__ import annotations

import json
import socket
import threading
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, Protocol


@dataclass
class Asked:
    """A request as it came."""

    path: str
    headers: dict[str, str]
    body: dict[str, Any]


Act = Callable[[socket.socket, Asked], None]
"""Answers one request; the connection is closed afterwards."""


@dataclass
class ChaosServer:
    """Plays its script, one act a request; the last act is repeated."""

    script: list[Act] = field(default_factory=list)
    asked: list[Asked] = field(default_factory=list)

    def __enter__(self) -> ChaosServer:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._listener.getsockname()[1])
        self._lock = threading.Lock()
        self._open: set[socket.socket] = set()
        threading.Thread(target=self._listen, daemon=True).start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._listener.shutdown(socket.SHUT_RDWR)  # wakes the thread that listens
        self._listener.close()
        with self._lock:
            for connection in self._open:
                with suppress(OSError):
                    connection.shutdown(socket.SHUT_RDWR)

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}/v1"

    def plays(self, *acts: Act) -> None:
        """A new script."""
        self.script = list(acts)
        self.asked.clear()

    def _listen(self) -> None:
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            threading.Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection: socket.socket) -> None:
        with connection, suppress(OSError):
            with self._lock:
                self._open.add(connection)
            asked = _read(connection)
            if asked is not None:
                with self._lock:
                    act = self.script[min(len(self.asked), len(self.script) - 1)]
                    self.asked.append(asked)
                act(connection, asked)
                connection.shutdown(socket.SHUT_WR)
                connection.settimeout(0.5)
                while connection.recv(65536):
                    pass
        with self._lock:
            self._open.discard(connection)


def _read(connection: socket.socket) -> Asked | None:
    connection.settimeout(10)
    data = b""
    while b"\r\n\r\n" not in data:
        more = connection.recv(65536)
        if not more:
            return None
        data += more
        if not data.startswith(b"POST "[: len(data)]):
            return None  # TLS, or a proxy's CONNECT: hang up
    head, _, body = data.partition(b"\r\n\r\n")
    first, *lines = head.decode("latin-1").split("\r\n")
    headers = {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
    while len(body) < int(headers.get("content-length", 0)):
        body += connection.recv(65536)
    return Asked(first.split(" ")[1], headers, json.loads(body))


def completion(text: str | None = "yes", *, finish: str | None = "stop", **more: Any) -> dict[str, Any]:
    """The body of an answer. `more` goes into the message, but for id, model and usage."""
    top = {name: more.pop(name) for name in ("id", "model", "usage") if name in more}
    usage = {"prompt_tokens": 10, "completion_tokens": 5, "total_tokens": 15}
    choice = {"index": 0, "message": {"role": "assistant", "content": text, **more}, "finish_reason": finish}
    return {"id": "", "model": "test-model", "usage": usage, "choices": [choice], **top}


def says(text: str | None = "yes", **more: Any) -> Act:
    """A well-formed answer."""
    return sends(json.dumps(completion(text, **more)).encode())


def sends(
    body: bytes,
    *,
    status: int = 200,
    kind: str = "application/json",
    headers: Iterable[str] = (),
    length: int | None = None,
) -> Act:
    """Any body with any status; `length` lies about its length."""
    lines = [
        f"HTTP/1.1 {status} Any",
        f"content-type: {kind}",
        f"content-length: {len(body) if length is None else length}",
    ]
    head = "\r\n".join([*lines, *headers]) + "\r\n\r\n"
    return lambda connection, _: connection.sendall(head.encode() + body)


def refuses(status: int, message: str = "no", *headers: str, **more: str) -> Act:
    """An error as the protocol has it."""
    return sends(json.dumps({"error": {"message": message, **more}}).encode(), status=status, headers=headers)


def chunk(text: str | None = None, *, finish: str | None = None, index: int = 0, **delta: Any) -> bytes:
    """One event of a streamed answer."""
    content = {} if text is None else {"content": text}
    choice = {"index": index, "delta": {**content, **delta}, "finish_reason": finish}
    return event({"id": "", "model": "test-model", "choices": [choice]})


def event(value: Any) -> bytes:
    """Any event."""
    return b"data: " + json.dumps(value, ensure_ascii=False).encode() + b"\n\n"


DONE = b"data: [DONE]\n\n"
USAGE = event({"choices": [], "usage": {"prompt_tokens": 10, "completion_tokens": 5}})


def streams(*pieces: bytes, pause: float = 0.0, hang: float = 0.0) -> Act:
    """Events, or parts of events, each sent by itself; without a length, so that the end of the connection ends it.
    `hang`: seconds that the connection then stays open in silence."""
    head = b"HTTP/1.1 200 OK\r\ncontent-type: text/event-stream\r\nconnection: close\r\n\r\n"
    sending = drips(head, *pieces, pause=pause)
    return then(sending, hangs(hang)) if hang else sending


def then(*acts: Act) -> Act:
    """One act after another, on the same connection."""

    def act(connection: socket.socket, asked: Asked) -> None:
        for each in acts:
            each(connection, asked)

    return act


def drips(*pieces: bytes, pause: float = 0.0, times: int = 1) -> Act:
    """Raw bytes, piece by piece; the last piece `times` times."""

    def act(connection: socket.socket, _: Asked) -> None:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for piece in [*pieces, *[pieces[-1]] * (times - 1)]:
            connection.sendall(piece)
            if pause:
                time.sleep(pause)

    return act


class Skips(Protocol):
    """Time that can be skipped."""

    skipped: float


def thinks(time: Skips, seconds: float, answer: Act) -> Act:
    """An answer after so many seconds of silence, which nobody has to wait for."""

    def act(connection: socket.socket, asked: Asked) -> None:
        time.skipped += seconds
        answer(connection, asked)

    return act


def hangs(seconds: float = 5.0) -> Act:
    """No answer, until the client goes away."""

    def act(connection: socket.socket, _: Asked) -> None:
        connection.settimeout(seconds)
        connection.recv(1)

    return act
