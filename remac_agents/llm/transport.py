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
from dataclasses import dataclass
from functools import lru_cache
from typing import Any
from urllib.parse import urlsplit

import httpx

from remac_agents.llm.clock import Clock
from remac_agents.llm.message import Raw
from remac_agents.llm.outcomes import ChatError
from remac_agents.llm.refusals import refusal
from remac_agents.llm.request import ChatRequest
from remac_agents.llm.retry import asked_wait
from remac_agents.llm.wire import Caps, StreamReader, are_events, error_text, read_body

CONNECT_S, WRITE_S = 10.0, 30.0
"""How long a connection and one write may take. The answer is waited for until the deadline of the call, however silent
the endpoint is: models that reason think for minutes."""

INFLATED = 1 << 16
"""Bytes to which a packed body is inflated at a time."""

NO_CONNECTION = "no connection"
"""With this begins the detail of an error where nobody was there to talk to."""


class Transport:
    """Sends requests. Thread-safe; each request has a connection of its own, so that its deadline can cut it."""

    def __init__(self, key: str, *, clock: Clock | None = None, caps: Caps | None = None) -> None:
        """Args: key: sent as a bearer token, if not empty."""
        self._clock = clock or Clock()
        self._caps = caps or Caps()
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

    def send(self, request: ChatRequest, *, deadline: float) -> Raw | ChatError:
        """One try. `deadline`: by the monotonic clock; nothing is read after it."""
        left = deadline - self._clock.monotonic()
        if left <= 0:
            return ChatError("timeout", "no time was left to send the request", tokens_in=0, tokens_out=0, money=0.0)
        pulse = _Pulse(self._clock.monotonic())
        with _Watchdog(left) as watchdog:
            try:
                answer = self._exchange(request, deadline, watchdog, pulse)
            except (httpx.HTTPError, httpx.InvalidURL, httpx.StreamError, OSError) as error:
                now = self._clock.monotonic()
                if isinstance(error, httpx.ConnectError | httpx.ConnectTimeout):
                    return _fault(error, request.endpoint.base_url, watchdog.sent, pulse.status)
                if watchdog.fired or now >= deadline:
                    return ChatError("timeout", pulse.told(now), pulse.status)
                return _fault(error, request.endpoint.base_url, watchdog.sent, pulse.status)
        if isinstance(answer, ChatError) and watchdog.fired:
            # A body without a length that was cut looks as if it had ended.
            return ChatError("timeout", pulse.told(self._clock.monotonic()), answer.status)
        return answer

    def _exchange(
        self, request: ChatRequest, deadline: float, watchdog: _Watchdog, pulse: _Pulse
    ) -> Raw | ChatError:
        left = deadline - self._clock.monotonic()
        timeout = httpx.Timeout(connect=min(CONNECT_S, left), read=left, write=min(WRITE_S, left), pool=left)
        sent = self._client.build_request(
            "POST",
            request.endpoint.base_url + "/chat/completions",
            json=request.body(),
            timeout=timeout,
            extensions={"trace": watchdog.trace},
        )
        response = self._client.send(sent, stream=True)
        try:
            pulse.status = response.status_code
            return self._read(response, deadline, pulse)
        finally:
            response.close()

    def _read(self, response: httpx.Response, deadline: float, pulse: _Pulse) -> Raw | ChatError:
        status = response.status_code
        events: bool | None = False if status != 200 else None
        reader = StreamReader(self._caps)
        body = bytearray()
        total = 0
        for data in _pieces(response):
            pulse.beat(self._clock.monotonic())
            if self._clock.monotonic() >= deadline:
                return ChatError("timeout", f"the answer was still coming: {pulse.told(deadline)}", status)
            if data is None:
                encoding = response.headers.get("content-encoding")
                body = bytearray(f"encoding {encoding!r} was not asked for", "utf-8")
                break
            total += len(data)
            cap = self._cap(status, events)
            if total > cap and status == 200:
                return ChatError("oversized", f"more than {total - len(data)} bytes", status)
            body += data
            if events is None and body.strip():
                events = are_events(bytes(body), response.headers.get("content-type", ""))
            if events:
                read = reader.feed(bytes(body))
                body.clear()
                if isinstance(read, ChatError):
                    return read
                if read:
                    break
            elif len(body) > cap:
                break
        if status != 200:
            return _refused(response, bytes(body[: self._caps.error_bytes]), self._clock.wall())
        if events is None:
            events = are_events(b"", response.headers.get("content-type", ""))
        arrived = not {"content-length", "transfer-encoding"}.isdisjoint(response.headers)
        return reader.result(arrived=arrived) if events else read_body(bytes(body), self._caps)

    def _cap(self, status: int, events: bool | None) -> int:
        if status != 200:
            return self._caps.error_bytes
        return self._caps.stream_bytes if events else self._caps.body_bytes


@lru_cache(maxsize=1)
def _certificates() -> ssl.SSLContext:
    """The authorities that are trusted; reading them takes longer than a request on one machine."""
    return httpx.create_ssl_context(trust_env=False)


def _pieces(response: httpx.Response) -> Iterator[bytes | None]:
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
                data = inflater.decompress(packed, INFLATED)
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
            target = "an invalid address"
        return ChatError("redirected", f"to {target}", response.status_code)
    return refusal(response.status_code, error_text(body), asked_wait(response.headers, wall))


def _fault(error: Exception, address: str, sent: bool, status: int | None) -> ChatError:
    """A failure of the connection as a value. httpx's messages name addresses, never headers.

    Args:
        sent: whether anything of the request was; if not, it cost nothing.
        status: of the answer, if it had begun.
    """
    told = f"{address}: {type(error).__name__}: {error}".rstrip(": ")
    if isinstance(error, httpx.ConnectError | httpx.ConnectTimeout):
        told = f"{NO_CONNECTION}: {told}"
    free: dict[str, Any] = {} if sent else {"tokens_in": 0, "tokens_out": 0, "money": 0.0}
    if isinstance(error, (httpx.UnsupportedProtocol, httpx.LocalProtocolError, httpx.InvalidURL)):
        return ChatError("bad_request", told, **free)
    if status is not None and status != 200:
        return refusal(status, told, None)
    return ChatError("endpoint_unavailable" if status is None else "truncated", told, **free)


@dataclass
class _Pulse:
    """Signs of life of an endpoint: headers, pieces of an answer, comments that keep a connection open."""

    begun: float
    status: int | None = None
    beats: int = 0
    last: float = 0.0

    def beat(self, now: float) -> None:
        """Bytes came."""
        self.beats, self.last = self.beats + 1, now

    def told(self, now: float) -> str:
        """What there was until the deadline."""
        if not self.beats:
            return f"silent for {now - self.begun:.3g} s, until the deadline (option seconds)"
        since = f"{self.beats} signs of life, the last {now - self.last:.3g} s before"
        return f"no whole answer in {now - self.begun:.3g} s ({since}), until the deadline (option seconds)"


class _Watchdog:
    """Cuts a connection at the deadline, whatever it is waiting for.

    httpx bounds each wait, not their sum: an endpoint that sends a byte of its headers now and then would hold a
    call for ever. A second handle on the socket is shut down by a timer, which ends every wait on the first.
    """

    def __init__(self, seconds: float) -> None:
        self.fired = self.sent = False
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
        self.sent |= event.endswith("send_request_headers.started")
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
