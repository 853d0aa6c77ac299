"""Rows of the fault table that happen on the way: connections, statuses, bodies, streams."""

from __future__ import annotations

import gzip
import json
import time
from email.utils import formatdate
from typing import Any

import httpx
import pytest
from chaos_server import DONE, USAGE, ChaosServer, chunk, drips, event, hangs, refuses, says, sends, streams, thinks
from llm_kit import KEY, Kit, fault

from remac_agents.llm import Bill, Limiter
from remac_agents.llm.retry import LONGEST_WAIT_S
from remac_agents.llm.wire import Caps

BROKEN = (500, 502, 503, 504, 529)


@fault(1)
def no_connection_is_unavailable(kit: Kit) -> None:
    kit.server.plays(says())
    with ChaosServer() as gone:
        closed = gone.url
    tls = kit.server.url.replace("http:", "https:")
    for url in (closed, "http://nobody.invalid/v1", tls):
        kit.time.slept.clear()
        error = kit.error(base_url=url)
        assert (error.kind, 2 <= error.attempts <= 6, error.infrastructure) == ("endpoint_unavailable", True, True), url
        assert url in error.detail and error.bill == Bill(), "nothing was sent, and nothing paid"
        assert 0 < sum(kit.time.slept) < 10, "a server that is not there is told of at once"
    assert kit.server.asked == []
    limiter = Limiter(start=4, clock=kit.time.clock)
    for _ in range(5):
        kit.time.slept.clear()
        kit.error(base_url=closed, limiter=limiter)
        assert sum(kit.time.slept) < 10, "nor does anyone wait for it to recover"


@fault(2)
def silence_is_waited_for_until_the_deadline_and_not_asked_again(kit: Kit) -> None:
    for act in (hangs(), streams(chunk("a"), b": alive\n\n", pause=0.1, hang=5.0)):
        error = kit.error(act, ask={"deadline": 0.4})
        assert (error.kind, error.attempts, len(kit.server.asked)) == ("timeout", 1, 1)
        assert error.infrastructure and "option seconds" in error.detail
        assert (error.bill.requests, error.bill.unpriced, error.bill.money) == (1, 1, 0.0), "it may have cost something"
    assert "signs of life" in error.detail


@fault(2)
def an_answer_may_take_as_long_as_the_call(kit: Kit) -> None:
    seen: list[dict[str, float]] = []
    send = httpx.Client.send

    def noting(client: httpx.Client, request: httpx.Request, **more: Any) -> httpx.Response:
        seen.append(dict(request.extensions["timeout"]))
        return send(client, request, **more)

    kit.monkeypatch.setattr(httpx.Client, "send", noting)
    for seconds in (90.0, 900.0):
        reply = kit.reply(thinks(kit.time, seconds - 5, says("at last")), options={"seconds": seconds})
        assert (reply.text, reply.attempts) == ("at last", 1) and reply.seconds > seconds - 6
        assert seen[-1]["read"] == pytest.approx(seconds, abs=1), "no silence is too long before the deadline"
        assert seen[-1]["connect"] == 10.0
    error = kit.error(thinks(kit.time, 901, says("too late")), options={"seconds": 900})
    assert (error.kind, error.attempts, len(kit.server.asked)) == ("timeout", 1, 1)


@fault(2)
def a_word_now_and_then_is_a_sign_of_life(kit: Kit) -> None:
    words = [piece for word in ["one", "two", "three"] for piece in (b": keep-alive\n\n", chunk(f"{word} "))]
    reply = kit.reply(streams(*words, chunk("", finish="stop"), USAGE, DONE, pause=0.03))
    assert (reply.text, reply.attempts, reply.bill.requests) == ("one two three", 1, 1)


@fault(2)
def a_slow_loris_is_cut_at_the_deadline(kit: Kit) -> None:
    head = b"HTTP/1.1 200 OK\r\ncontent-type: text/event-stream\r\n\r\n"
    for acts in (
        drips(head, b":\n", pause=0.02, times=500),
        drips(b"HTTP/1.1 200 OK\r\n", b"x: y\r\n", pause=0.02, times=500),
    ):
        started = time.monotonic()
        error = kit.error(acts, ask={"deadline": 0.3})
        assert error.kind == "timeout"
        assert 0.2 < time.monotonic() - started < 1.5


@fault(3)
def retry_after_is_obeyed_within_bounds(kit: Kit) -> None:
    date = formatdate(kit.time.wall + 30, usegmt=True)
    waits = {"2": 2, date: 30, "0": 0, "-5": 0, "99999999": LONGEST_WAIT_S, "1e999": 0.25, "soon": 0.25, "nan": 0.25}
    headers = {f"Retry-After: {value}": wait for value, wait in waits.items()}
    headers |= {"retry-after-ms: 1500": 1.5, "x-ratelimit-reset-tokens: 1m2s": LONGEST_WAIT_S, "x-none: 1": 0.25}
    for header, wait in headers.items():
        limiter = Limiter(start=4, clock=kit.time.clock)
        kit.time.slept.clear()
        reply = kit.reply(refuses(429, "slow down", header), says(), limiter=limiter)
        assert reply.attempts == 2
        assert sum(kit.time.slept) == pytest.approx(wait, abs=0.05), header
        assert limiter.limit == 3, header
    error = kit.error(refuses(429, "slow", "Retry-After: 50"), ask={"deadline": 20})
    assert (error.kind, error.attempts) == ("rate_limited", 1), "waiting would have passed the deadline"
    assert error.retriable and error.infrastructure


@fault(4)
def a_failing_endpoint_is_tried_again(kit: Kit) -> None:
    for status in BROKEN:
        assert kit.reply(refuses(status), says()).attempts == 2
    error = kit.error(refuses(503, "over\x1b[31mloaded\x07"))
    assert (error.kind, error.attempts, error.status, error.detail) == ("server_error", 6, 503, "overloaded")


@fault(4)
def a_page_with_status_200_is_malformed(kit: Kit) -> None:
    error = kit.error(sends(b"<html>\x1b[2J<script>" + b"x" * 5000, kind="text/html"))
    assert (error.kind, error.attempts) == ("malformed", 3)
    assert len(error.detail) <= 500 and "\x1b" not in error.detail and "<html>" in error.detail


@fault(5)
def what_cannot_succeed_is_not_tried_again(kit: Kit) -> None:
    too_long = refuses(400, "This model's maximum context length is 10 tokens", code="context_length_exceeded")
    refusals = {
        "context_too_long": too_long,
        "unauthorised": refuses(401, f"Incorrect API key provided: {KEY}"),
        "unknown_model": refuses(404, "The model `test-model` does not exist"),
        "bad_request": refuses(422, "messages: not a list"),
        "quota": refuses(429, "You exceeded your current quota", code="insufficient_quota"),
    }
    for kind, act in refusals.items():
        error = kit.error(act)
        assert (error.kind, error.attempts, error.retriable) == (kind, 1, False)
        assert len(kit.server.asked) == 1
        assert error.detail
    assert kit.error(refusals["unauthorised"]).detail == "Incorrect API key provided: [key]"
    torn = sends(b"no", status=401, length=500)
    assert kit.error(torn).kind == "unauthorised", "the status counts though the page broke off"


@fault(6)
def a_torn_body_is_no_answer(kit: Kit) -> None:
    whole = b'{"choices": [{"message": {"content": "yes"}, "finish_reason": "stop"}]}'
    assert kit.error(sends(whole[:40])).kind == "malformed"
    for length, kind in ((len(whole) + 100, "truncated"), (20, "malformed")):
        error = kit.error(sends(whole, length=length))
        assert (error.kind, error.attempts) == (kind, 3)
    assert kit.reply(sends(whole, length=len(whole) + 9), sends(whole)).attempts == 2


@fault(6)
def packed_bodies_are_inflated_within_bounds(kit: Kit) -> None:
    packed = "content-encoding: gzip"
    body = json.dumps({"choices": [{"message": {"content": "small"}, "finish_reason": "stop"}]}).encode()
    assert kit.reply(sends(gzip.compress(body), headers=[packed])).text == "small"
    bomb = gzip.compress(b" " * (20 << 20))
    assert len(bomb) < 100_000
    error = kit.error(sends(bomb, headers=[packed]))
    assert (error.kind, error.attempts) == ("oversized", 1)
    assert kit.error(sends(gzip.compress(body)[:-12], headers=[packed])).kind == "truncated"
    assert kit.error(sends(b"\x00\x01", headers=["content-encoding: zstd"])).kind == "malformed"


@fault(7)
def a_cut_stream_is_no_answer(kit: Kit) -> None:
    half = "navig\u00e9".encode()[:-1]
    tool = chunk(tool_calls=[{"index": 0, "function": {"name": "act", "arguments": '{"step": "op'}}])
    for pieces in (
        [chunk("pick"), chunk("", finish="stop")],
        [chunk("pick"), b'data: {"choices": [{"index": 0, "delta": {"content": "' + half],
        [chunk("pick"), tool],
        [b""],
    ):
        error = kit.error(streams(*pieces), stream=True)
        assert (error.kind, error.attempts) == ("truncated", 3)
        assert "pick" not in error.detail
    wrong = b'data: {"choices": [{"index": 0, "delta": {"content": "' + half + b'"}}]}\n\n'
    assert kit.error(streams(wrong, DONE), stream=True).kind == "malformed"


@fault(7)
def characters_may_be_split_between_packets(kit: Kit) -> None:
    whole = b"".join([chunk("na\u00efve \u7d75"), chunk("", finish="stop"), DONE])
    pieces = [whole[i : i + 1] for i in range(len(whole))]
    assert kit.reply(streams(*pieces), stream=True).text == "na\u00efve \u7d75"


@fault(8)
def harmless_oddities_of_streams_are_ignored(kit: Kit) -> None:
    role = event({"id": "x", "choices": [{"index": 0, "delta": {"role": "assistant", "content": None}}]})
    twice = event({"choices": [{"index": 0, "delta": {"content": "b"}}, {"index": 0, "delta": {"content": "B"}}]})
    pieces = [
        b": OPENROUTER PROCESSING\n\n",
        b"event: message\nid: 7\nretry: 10\n",
        role,
        chunk("a"),
        event({"choices": []}),
    ]
    pieces += [
        twice,
        chunk("other", index=1),
        event({"choices": None}),
        chunk("", finish="stop"),
        USAGE,
        DONE,
        b"garbage",
    ]
    for act in (
        streams(*pieces),
        streams(b"".join(pieces).replace(b"\n", b"\r\n")),
        streams(b"".join(pieces).replace(b"\n", b"\r")),
    ):
        reply = kit.reply(act, stream=True)
        assert (reply.text, reply.tokens_in, reply.tokens_out) == ("ab", 10, 5)
    failed = kit.error(streams(chunk("a"), event({"error": {"message": "overloaded"}})), stream=True)
    assert (failed.kind, failed.detail) == ("server_error", "in the stream: overloaded")


@fault(17)
def endless_answers_are_cut_off(kit: Kit) -> None:
    error = kit.error(says("x" * 10_000_000))
    assert (error.kind, error.attempts, error.infrastructure) == ("oversized", 1, False)
    head = b"HTTP/1.1 200 OK\r\ncontent-type: text/event-stream\r\n\r\n"
    nothing = b": nothing\n\n" * 100
    for endless, stream_bytes in ((chunk("x" * 1000), 1 << 30), (b"data: " + b"x" * 1000, 1 << 30), (nothing, 500_000)):
        caps = Caps(text=200_000, line_bytes=200_000, stream_bytes=stream_bytes)
        error = kit.error(drips(head, endless, times=1_000_000), stream=True, caps=caps, ask={"deadline": 5})
        assert (error.kind, error.attempts) == ("oversized", 1)
        assert ("text" in error.detail) == (stream_bytes > 500_000)


@fault(25)
def redirects_and_proxies_are_not_followed(kit: Kit) -> None:
    with ChaosServer() as other:
        other.plays(says("stolen"))
        for status in (301, 302, 303, 307, 308):
            for place in (other.url + "/chat/completions", "//evil.example/x", "http://user:pass@[", ""):
                error = kit.error(sends(b"", status=status, headers=[f"location: {place}"]))
                assert (error.kind, error.attempts, error.status) == ("redirected", 1, status)
                assert "pass" not in error.detail
        for name in ("HTTP_PROXY", "http_proxy", "ALL_PROXY", "all_proxy"):
            kit.monkeypatch.setenv(name, other.url.removesuffix("/v1"))
        kit.monkeypatch.delenv("NO_PROXY", raising=False)
        assert kit.reply(says("mine")).text == "mine"
        assert other.asked == []


@fault(26)
def only_the_monotonic_clock_counts(kit: Kit) -> None:
    def jumps(connection: object, asked: object) -> None:
        kit.time.wall -= 86_400.0
        says("on time")(connection, asked)  # type: ignore[arg-type]

    reply = kit.reply(jumps, ask={"deadline": 5})
    assert reply.text == "on time" and reply.seconds < 5

    def sleeps(connection: object, asked: object) -> None:
        kit.time.skipped += 3600.0
        says("too late")(connection, asked)  # type: ignore[arg-type]

    error = kit.error(sleeps, ask={"deadline": 5})
    assert (error.kind, error.attempts) == ("timeout", 1)
