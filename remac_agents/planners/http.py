"""The planner behind an HTTP address: it is sent the request as JSON and answers as any planner may, JSON or text.

Nothing but that address is called: redirects are not followed. Whatever goes wrong once somebody is there is an error
value.
"""

from __future__ import annotations

import asyncio
import json
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from urllib.parse import urlsplit

from remac_agents.plan import PlanError
from remac_agents.roles import PlanRequest, StopEpisode
from remac_agents.roles.request_json import as_json
from remac_agents.text.printable import quoted
from remac_env.errors import OptionError, real_number

LOOPBACK = ("127.0.0.1", "localhost", "::1")


class HttpPlanner:
    """Posts each request and waits for the answer.

    Args:
        url: http or https, with a host.
        seconds: deadline of one answer, all in all.
        most_bytes: a longer answer is refused.

    Raises:
        OptionError: for an address without a host, or a bound that is not positive.
    """

    needs_truth = needs_rules = False

    def __init__(self, url: str, *, seconds: float = 60.0, most_bytes: int = 1_000_000) -> None:
        try:
            address = urlsplit(url)
            port = "" if address.port is None else f":{address.port}"
        except ValueError as error:
            raise OptionError(f"address {quoted(url)} is not valid: {error}; valid: http://HOST:PORT/PATH") from error
        if address.scheme not in ("http", "https") or not address.hostname:
            raise OptionError(f"address {quoted(url)} is not valid; valid: http://HOST:PORT/PATH")
        for name, value in (("seconds", seconds), ("most_bytes", most_bytes)):
            if not real_number(name, value, 0.0):
                raise OptionError(f"{name} {value!r} is not valid; valid: a number above 0")
        self._url, self._seconds, self._most = url, float(seconds), int(most_bytes)
        self._shown = f"{address.scheme}://{address.hostname}{port}{address.path}"
        self._loopback, self._secure = address.hostname in LOOPBACK, address.scheme == "https"
        self._iteration = 0

    def begin_episode(self, seed: int, iteration: int) -> None:
        """Which iteration it is; the request says so."""
        self._iteration = iteration

    def plan(self, request: PlanRequest) -> Any:
        """The answer: a JSON value, or text.

        Raises:
            StopEpisode: where nobody is there to be asked, for which no planner is to blame.
        """
        body = json.dumps(as_json(request, self._iteration)).encode()
        # A loop of its own in a thread of its own: the caller may run in a notebook, which has one already.
        with ThreadPoolExecutor(1) as pool:
            return pool.submit(asyncio.run, self._answer(body)).result()

    async def _answer(self, body: bytes) -> Any:
        import httpx

        try:
            status, content = await asyncio.wait_for(self._post(body), self._seconds)
        except TimeoutError:
            return PlanError(f"no answer from {self._shown} within {self._seconds:g} s")
        except (httpx.ConnectError, httpx.ConnectTimeout) as error:
            told = f"nobody is at {self._shown}: {type(error).__name__}; start the planner's server first"
            raise StopEpisode(told, infrastructure=True) from error
        except (httpx.HTTPError, httpx.InvalidURL) as error:
            return PlanError(f"no answer from {self._shown}: {type(error).__name__}")
        if status != 200:
            return PlanError(f"{self._shown} answered with status {status}; valid: 200")
        if content is None:
            return PlanError(f"the answer from {self._shown} has more than {self._most} bytes")
        text = content.decode("utf-8-sig", errors="replace")
        try:
            value = json.loads(text)
        except (ValueError, RecursionError):
            return text
        # Text that is read as JSON here is read again by the parser, which sees keys that stand twice.
        return value if isinstance(value, str) else text

    async def _post(self, body: bytes) -> tuple[int, bytes | None]:
        """Status and content; None for a content that is too long."""
        import httpx

        content = bytearray()
        headers = {"content-type": "application/json", "accept-encoding": "identity"}
        async with (
            # Certificates are loaded only where they are needed: that takes longer than all the rest.
            httpx.AsyncClient(timeout=self._seconds, trust_env=not self._loopback, verify=self._secure) as client,
            client.stream("POST", self._url, content=body, headers=headers) as response,
        ):
            if response.status_code != 200:
                return response.status_code, b""
            async for part in response.aiter_raw():
                content += part
                if len(content) > self._most:
                    return response.status_code, None
        return response.status_code, bytes(content)
