"""What stands before a server on loopback: pages of other sites, other users and other names stay outside."""

from __future__ import annotations

import hmac
import re
import secrets
from collections.abc import Mapping
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

HOSTS = ("127.0.0.1", "localhost")
"""Names under which the server answers: a name of another machine that leads here (DNS rebinding) is none of them."""

BODY_MAX = 64 * 1024
"""Bytes of a request at most."""

NUMBER = re.compile(r"[0-9]{1,9}")
"""A whole number in what a browser sends: no longer than any that means something."""
_METHODS = ("GET", "HEAD", "POST")
_HEADERS = (
    (b"cache-control", b"no-store"),
    (b"content-security-policy", b"frame-ancestors 'none'"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"referrer-policy", b"no-referrer"),
    (b"x-content-type-options", b"nosniff"),
)


def new_token() -> str:
    """A secret that the address carries which is printed in the terminal, and nobody else knows."""
    return secrets.token_urlsafe(24)


class Guard:
    """An ASGI application before another: requests without the token, or from elsewhere, get no further.

    The address with `?token=` sets a cookie that scripts cannot read and other sites' pages do not send. A request that
    changes something must come from a page of this very server, as JSON, which a form of another site cannot send.
    """

    def __init__(self, app: Any, *, token: str, port: int) -> None:
        self._app, self._token = app, token
        self._cookie = f"remac-{port}"
        self._hosts = {f"{host}:{port}" for host in HOSTS}

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """See the ASGI specification."""
        if scope["type"] != "http":
            return
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        given = self._given(scope)
        refused = self._refusal(scope["method"], headers, given)
        if refused is not None:
            await _refuse(send, *refused)
            return
        cookie = f"{self._cookie}={self._token}; HttpOnly; SameSite=Strict; Path=/" if given else ""

        async def answer(message: Any) -> None:
            if message["type"] == "http.response.start":
                more = [*_HEADERS, *([(b"set-cookie", cookie.encode())] if cookie else [])]
                message = {**message, "headers": [*message.get("headers", []), *more]}
            await send(message)

        await self._app(scope, receive, answer)

    def _given(self, scope: Any) -> bool:
        """Whether the address carries the token."""
        query = parse_qs(scope.get("query_string", b"").decode("latin-1"))
        return any(self._is_token(text) for text in query.get("token", []))

    def _refusal(self, method: str, headers: Mapping[str, str], given: bool) -> tuple[int, str] | None:
        host = headers.get("host", "")
        if host not in self._hosts:
            return 421, "this server answers on its loopback address alone"
        if method not in _METHODS:
            return 405, "only GET, HEAD and POST"
        origin = headers.get("origin")
        if (origin is not None or method == "POST") and origin != f"http://{host}":
            return 403, "this comes from another site"
        if not given and not self._is_token(self._sent(headers.get("cookie", ""))):
            return 403, "open the whole address that the terminal shows, with its token"
        if method == "POST":
            if headers.get("content-type", "").partition(";")[0].strip() != "application/json":
                return 415, "send JSON"
            size = headers.get("content-length", "")
            if not NUMBER.fullmatch(size) or int(size) > BODY_MAX:
                return 413, f"at most {BODY_MAX} bytes, and say how many"
        return None

    def _sent(self, text: str) -> str:
        try:
            found = SimpleCookie(text).get(self._cookie)
        except CookieError:
            return ""
        return found.value if found else ""

    def _is_token(self, text: str) -> bool:
        return hmac.compare_digest(text.encode("utf-8", "replace"), self._token.encode())


async def _refuse(send: Any, status: int, why: str) -> None:
    headers = [*_HEADERS, (b"content-type", b"text/plain; charset=utf-8")]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": f"{why}\n".encode()})
