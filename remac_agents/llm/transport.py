"""One request and its answer over HTTP: bounded in time and size, to one host only, with every fault as a value.

The only file that knows httpx.
"""

from __future__ import annotations

import contextlib
import socket
import ssl
import threading
import zlib
from collections.abc import Iterator
from functools import lru_cache
from typing import Any
from urllib.parse import urlsplit

import httpx

from remac_agents.llm.clock import Clock
from remac_agents.llm.judging import refusal
from remac_agents.llm.outcomes import ChatError
from remac_agents.llm.request import ChatRequest
from remac_agents.llm.retry import asked_wait
from remac_agents.llm.wire import Caps, Raw, StreamReader, error_text, read_body

CONNECT_S, WRITE_S, READ_S = 5.0, 30.0, 60.0
"""How long a connection, one write, and the wait for the next bytes may take."""

NO_CONNECTION = "no connection"
"""With this begins the detail of an error where nobody was there to talk to."""


class Transport:
    """Sends requests. Thread-safe; each request has a connection of its own, so that its deadline can cut it."""

    def __init__(
        self, key: str, *, clock: Clock | None = None, caps: Caps | None = None, read_s: float = READ_S
    ) -> None:
        """Args: key: sent as a bearer token, if not empty; read_s: the wait for the next bytes."""
        self._clock = clock or Clock()
        self._caps = caps or Caps()
        self._read_s = read_s
        self.has_key = bool(key)
        headers = {"accept-encoding": "identity", "user-agent": "remac-kitchen"}
        if key:
            headers["authorization"] = f"Bearer {key}"
        # trust_env: neither proxies nor passwords come from the environment.
        self._client = httpx.Client(
            headers=headers,
            verify=_certificates(),
            follow_redirects=False,
            trust_env=False,
            http2=False,
            limits=httpx.Limits(max_connections=None, max_keepalive_connections=0),
        )

    def close(self) -> None:
        """Release the connections."""
        self._client.close()

    def send(self, request: ChatRequest, *, stream: bool, deadline: float) -> Raw | ChatError:
        """One try. `deadline`: by the monotonic clock; nothing is read after it."""
        left = deadline - self._clock.monotonic()
        if left <= 0:
            return ChatError("timeout", "no time was left to send the request")
        begun: list[int] = []  # the status, once the headers came
        with _Watchdog(left) as watchdog:
            try:
                answer = self._exchange(request, stream, deadline, watchdog, begun)
            except (httpx.HTTPError, httpx.InvalidURL, httpx.StreamError, OSError) as error:
                return _fault(error, watchdog.fired or self._clock.monotonic() >= deadline, begun)
        if isinstance(answer, ChatError) and watchdog.fired:
            # A body without a length that was cut looks as if it had ended.
            return ChatError("timeout", "the deadline passed while the answer came", answer.status)
        return answer

    def _exchange(
        self, request: ChatRequest, stream: bool, deadline: float, watchdog: _Watchdog, begun: list[int]
    ) -> Raw | ChatError:
        left = deadline - self._clock.monotonic()
        timeout = httpx.Timeout(
            connect=min(CONNECT_S, left), read=min(self._read_s, left), write=min(WRITE_S, left), pool=left
        )
        sent = self._client.build_request(
            "POST",
            request.endpoint.base_url + "/chat/completions",
            json=request.body(stream=stream),
            timeout=timeout,
            extensions={"trace": watchdog.trace},
        )
        response = self._client.send(sent, stream=True)
        try:
            begun.append(response.status_code)
            return self._read(response, deadline)
        finally:
            response.close()

    def _read(self, response: httpx.Response, deadline: float) -> Raw | ChatError:
        status = response.status_code
        events = status == 200 and "text/event-stream" in response.headers.get("content-type", "").casefold()
        cap = self._caps.error_bytes if status != 200 else self._caps.body_bytes
        reader = StreamReader(self._caps)
        body = bytearray()
        total = 0
        for data in _pieces(response, self._caps.stream_bytes if events else cap):
            if self._clock.monotonic() >= deadline:
                return ChatError("timeout", "the answer was still coming at the deadline", status)
            if data is None:
                encoding = response.headers.get("content-encoding")
                body = bytearray(f"encoding {encoding!r} was not asked for", "utf-8")
                break
            total += len(data)
            if total > (self._caps.stream_bytes if events else cap) and status == 200:
                return ChatError("oversized", f"more than {total - len(data)} bytes", status)
            if events:
                read = reader.feed(data)
                if isinstance(read, ChatError):
                    return read
                if read:
                    break
            else:
                body += data
                if len(body) > cap:
                    break
        if status != 200:
            return _refused(response, bytes(body[:cap]), self._clock.wall())
        return reader.result() if events else read_body(bytes(body), self._caps)


@lru_cache(maxsize=1)
def _certificates() -> ssl.SSLContext:
    """The authorities that are trusted; reading them takes longer than a request on one machine."""
    return httpx.create_ssl_context(trust_env=False)


def _pieces(response: httpx.Response, cap: int) -> Iterator[bytes | None]:
    """The bytes of a body, inflated where the endpoint packed them unasked; None: packed in an unknown way.

    Inflation is bounded piece by piece, so that a small body which would fill the memory never does.
    """
    encoding = response.headers.get("content-encoding", "identity").strip().casefold()
    if encoding in ("identity", ""):
        yield from response.iter_raw()
        return
    if encoding not in ("gzip", "x-gzip", "deflate"):
        yield None
        return
    inflater = zlib.decompressobj(zlib.MAX_WBITS | 32)
    for packed in response.iter_raw():
        while packed:
            try:
                data = inflater.decompress(packed, min(cap, 1 << 16) + 1)
            except zlib.error as error:
                raise httpx.RemoteProtocolError(f"broken compression: {error}") from None
            packed = inflater.unconsumed_tail
            yield data
    if not inflater.eof:
        raise httpx.RemoteProtocolError("the compressed body broke off")


def _refused(response: httpx.Response, body: bytes, wall: float) -> ChatError:
    if response.has_redirect_location or 300 <= response.status_code < 400:
        # Only the host is told: a whole address may hold what is none of the log's business.
        try:
            target = urlsplit(response.headers.get("location", "")).netloc.rpartition("@")[2] or "the same host"
        except ValueError:
            target = "an address that is none"
        return ChatError("redirected", f"to {target}", response.status_code)
    return refusal(response.status_code, error_text(body), asked_wait(response.headers, wall))


def _fault(error: Exception, late: bool, begun: list[int]) -> ChatError:
    """A failure of the connection as a value. httpx's messages name addresses, never headers."""
    told = f"{type(error).__name__}: {error}"
    if isinstance(error, httpx.ConnectError | httpx.ConnectTimeout):
        return ChatError("endpoint_unavailable", f"{NO_CONNECTION}: {told}")
    if late:
        return ChatError("timeout", "the deadline passed")
    if isinstance(error, httpx.TimeoutException):
        return ChatError("timeout", told)
    if isinstance(error, (httpx.UnsupportedProtocol, httpx.LocalProtocolError, httpx.InvalidURL)):
        return ChatError("bad_request", told)
    if begun and begun[0] != 200:
        return refusal(begun[0], told, None)
    return ChatError("truncated" if begun else "endpoint_unavailable", told)


class _Watchdog:
    """Cuts a connection at the deadline, whatever it is waiting for.

    httpx bounds each wait, not their sum: an endpoint that sends a byte of its headers now and then would hold a
    call for ever. A second handle on the socket is shut down by a timer, which ends every wait on the first.
    """

    def __init__(self, seconds: float) -> None:
        self.fired = False
        self._lock = threading.Lock()
        self._socket: socket.socket | None = None
        self._timer = threading.Timer(min(seconds, threading.TIMEOUT_MAX), self._fire)
        self._timer.daemon = True

    def __enter__(self) -> _Watchdog:
        self._timer.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()
        with self._lock:
            if self._socket is not None:
                self._socket.close()
                self._socket = None

    def trace(self, event: str, info: dict[str, Any]) -> None:
        """Told by httpx of every step of a request."""
        if event == "connection.connect_tcp.complete":
            with self._lock:
                self._socket = info["return_value"].get_extra_info("socket").dup()
                if self.fired:
                    self._shut()

    def _fire(self) -> None:
        with self._lock:
            self.fired = True
            self._shut()

    def _shut(self) -> None:
        if self._socket is not None:
            with contextlib.suppress(OSError):
                self._socket.shutdown(socket.SHUT_RDWR)
