"""Rows of the fault table about what an endpoint says of its answers, and what is kept of them."""

from __future__ import annotations

import io
import json
import logging
import signal
import threading
import time

import pytest
from chaos_server import DONE, chunk, hangs, refuses, says, sends, streams
from llm_kit import ASK, KEY, Kit, fault

from remac_agents.llm import Budget, Cassette, ChatError, ChatReply, file_name
from remac_agents.llm.redaction import _forms
from remac_env.errors import OptionError


@fault(9)
def no_text_is_asked_for_twice_more(kit: Kit) -> None:
    for nothing in (None, "", " \n\t ", "<think>hm</think>", "<think>never closed: pick up bowl"):
        error = kit.error(says(nothing))
        assert (error.kind, error.attempts, error.infrastructure) == ("empty", 3, False), nothing
    error = kit.error(says(None, reasoning_content="pick up bowl"))
    assert (error.kind, error.detail) == ("empty", "reasoning only")
    assert kit.reply(says(""), says("at last")).attempts == 2


@fault(10)
def endings_are_typed(kit: Kit) -> None:
    for finish, kind, attempts in (
        ("length", "cut_short", 3),
        ("content_filter", "filtered", 1),
        (None, "unfinished", 3),
        ("vanished", "unfinished", 3),
        ("tool_calls", "tool_call", 1),
    ):
        error = kit.error(says("open the door", finish=finish))
        assert (error.kind, error.attempts) == (kind, attempts)
        assert "open the door" not in error.detail, "an answer that is not whole is not handed on"
        assert (error.tokens_in, error.tokens_out) == (10, 5), "but it is paid for"
    assert kit.error(says(None, refusal="I cannot")).kind == "filtered"
    late = [chunk("a"), chunk("", finish="length"), chunk("b"), chunk("", finish="stop"), DONE]
    assert kit.error(streams(*late), stream=True).kind == "cut_short"
    full = kit.reply(says("whole?", usage={"prompt_tokens": 1, "completion_tokens": 50}))
    assert "at_token_limit" in full.flags


@fault(13)
def tools_that_nobody_offered_are_not_called(kit: Kit) -> None:
    calls = [{"id": "1", "function": {"name": "act", "arguments": "{}"}}, {"function": {"name": "robot_9.act"}}, 3]
    for finish in ("tool_calls", "stop"):
        error = kit.error(says("fine", finish=finish, tool_calls=calls))
        assert (error.kind, error.attempts, error.infrastructure) == ("tool_call", 1, False)
        assert "act, robot_9.act, ?" in error.detail
    assert kit.error(says(None, finish="stop", function_call={"name": "act"})).kind == "tool_call"
    assert "tools" not in kit.server.asked[0].body


@fault(24)
def keys_are_never_shown_or_kept(kit: Kit) -> None:
    log = io.StringIO()
    handler = logging.StreamHandler(log)
    logger = logging.getLogger()
    level = logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.DEBUG)
    try:
        cassette = Cassette(kit.folder / "c.jsonl")
        echo = f"your key is {KEY}, or {json.dumps(KEY)}"
        reply = kit.reply(says(echo, reasoning=echo, id=KEY, model=KEY), cassette=cassette)
        half = len(KEY) // 2
        split = streams(chunk(KEY[:half]), chunk(KEY[half:]), chunk("", finish="stop"), DONE)
        assert kit.reply(split, cassette=cassette, stream=True).text == "[key]"
        errors = [kit.error(refuses(status, echo), cassette=cassette) for status in (400, 401, 403, 404, 429, 500)]
        errors.append(kit.error(sends(echo.encode()), cassette=cassette))
        with kit.client(cassette=cassette, versions={KEY: KEY}) as client:
            client.complete([{"role": "user", "content": echo}], label=KEY)
            assert KEY not in repr(client) + repr(vars(client)["_redactor"])
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)
    assert kit.server.asked[0].headers["authorization"] == f"Bearer {KEY}"
    assert reply.text == 'your key is [key], or "[key]"'
    kept = log.getvalue() + cassette.path.read_text("utf-8") + repr(reply) + repr(errors)
    assert len(cassette.path.read_bytes()) > 1000 and log.getvalue()
    assert not [form for form in _forms(KEY) if form in kept]
    wrong = kit.error(key="sk-wrong\nheader: 123456789")
    assert (wrong.kind, wrong.attempts) == ("unauthorised", 0)
    assert "123456789" not in wrong.detail


@fault(27)
def answers_to_other_requests_are_flagged(kit: Kit) -> None:
    kit.server.plays(says(id="one"), says(id="one"), says(id="two", model="a-cheaper-model"))
    with kit.client() as client:
        replies = [client.complete(ASK) for _ in range(3)]
    assert all(isinstance(reply, ChatReply) for reply in replies)
    assert [reply.flags for reply in replies] == [(), ("id_repeated",), ("other_model",)]  # type: ignore[union-attr]
    assert len({reply.key for reply in replies}) == 1


@fault(28)
def changing_answers_are_all_kept_in_order(kit: Kit) -> None:
    path = kit.folder / "c.jsonl"
    told = [kit.reply(says(text), cassette=Cassette(path)).text for text in ("a", "b", "a")]
    assert kit.server.asked[0].body["temperature"] == 0.0
    kit.server.plays(says("live"))
    with kit.client(cassette=Cassette(path, mode="replay")) as client:
        played = [client.complete(ASK, max_tokens=50) for _ in range(4)]
    assert [reply.text for reply in played[:3] if isinstance(reply, ChatReply)] == told == ["a", "b", "a"]
    assert isinstance(played[3], ChatError) and "more often than recorded (3)" in played[3].detail
    assert kit.server.asked == []


@fault(29)
def incredible_usage_is_unknown(kit: Kit) -> None:
    usages = [None, {}, {"prompt_tokens": 3}, {"prompt_tokens": -1, "completion_tokens": 2}, "many", [1]]
    usages += [{"prompt_tokens": 10**30, "completion_tokens": 1}, {"prompt_tokens": True, "completion_tokens": 1}]
    for usage in usages:
        budget = Budget()
        reply = kit.reply(says("yes", usage=usage), budget=budget)
        assert (reply.tokens_in, reply.tokens_out, reply.money) == (None, None, None)
        assert "usage_unknown" in reply.flags
        assert 0 < budget.spent.tokens < 1000 and budget.spent.unpriced == 1, "the budget goes by an estimate"


@fault(30)
def a_cassette_survives_a_kill_at_any_byte(kit: Kit) -> None:
    path = kit.folder / "c.jsonl"
    kit.reply(says("first"), cassette=Cassette(path))
    first = path.read_bytes()
    kit.reply(says("second"), cassette=Cassette(path))
    whole = path.read_bytes()
    for end in range(len(first), len(whole), 7):
        path.write_bytes(whole[:end])
        assert len(Cassette(path, mode="replay")) == 1 + (end >= len(whole) - 1)
    path.write_bytes(whole[:-20])
    kit.reply(says("third"), cassette=Cassette(path))
    again = Cassette(path, mode="replay")
    assert (len(again), again.damaged) == (2, 1)
    path.write_bytes(first.replace(b"first", b"FIRST"))
    edited = Cassette(path, mode="replay")
    assert (len(edited), edited.damaged) == (0, 1)


@fault(30)
def a_cassette_that_cannot_be_written_says_so(kit: Kit) -> None:
    (kit.folder / "file").write_text("")
    with pytest.raises(OptionError, match="cassette"):
        Cassette(kit.folder / "file" / "c.jsonl")
    cassette = Cassette(kit.folder / "gone" / "c.jsonl")
    cassette.path.unlink()
    cassette.path.parent.rmdir()
    assert "not_recorded" in kit.reply(says("paid for"), cassette=cassette).flags


@fault(30)
def two_runners_may_share_a_cassette(kit: Kit) -> None:
    path = kit.folder / "c.jsonl"
    kit.server.plays(says("x" * 3000))

    def run() -> None:
        with kit.client(cassette=Cassette(path)) as client:
            for _ in range(10):
                client.complete(ASK)

    threads = [threading.Thread(target=run) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    cassette = Cassette(path, mode="replay")
    assert (len(cassette), cassette.damaged) == (30, 0)


@fault(31)
def a_cassette_gives_no_wrong_answers(kit: Kit) -> None:
    path = kit.folder / "c.jsonl"
    kit.error(refuses(503), cassette=Cassette(path))
    kit.error(says("not whole", finish="length"), cassette=Cassette(path), ask={"seed": 1})
    kit.reply(says("mine"), cassette=Cassette(path), versions={"prompts": "1"})

    def replayed(**more: object) -> ChatReply | ChatError:
        return kit.outcome(cassette=Cassette(path, mode="replay"), **more)  # type: ignore[arg-type]

    kit.server.plays(says("live"))
    assert replayed(versions={"prompts": "1"}).text == "mine"  # type: ignore[union-attr]
    cut = replayed(ask={"seed": 1})
    assert isinstance(cut, ChatError) and cut.kind == "cut_short", "an answer that was cut stays one"
    misses = [{}, {"versions": {"prompts": "2"}}, {"versions": {"prompts": "1"}, "model": "other"}]
    misses += [
        {"versions": {"prompts": "1"}, "ask": {"temperature": 1.0}},
        {"versions": {"prompts": "1"}, "base_url": "http://127.0.0.1:1/v1"},
    ]
    for miss in misses:
        error = replayed(**miss)
        assert isinstance(error, ChatError) and error.kind == "cassette_miss", miss
    assert kit.server.asked == []


@fault(32)
def an_interrupt_comes_through_and_loses_nothing(kit: Kit) -> None:
    path, budget = kit.folder / "c.jsonl", Budget(calls=10)
    kit.server.plays(says("before"), hangs(), says("after"))
    main = threading.main_thread().ident or 0
    threading.Timer(0.3, lambda: signal.pthread_kill(main, signal.SIGINT)).start()
    started = time.monotonic()
    with kit.client(cassette=Cassette(path), budget=budget) as client:
        client.complete(ASK, label="1")
        with pytest.raises(KeyboardInterrupt):
            client.complete(ASK, label="2")
        assert time.monotonic() - started < 2
        assert budget.spent.calls == 2, "what was under way may have cost something"
    kept = Cassette(path, mode="fill")
    with kit.client(cassette=kept, budget=budget) as client:
        resumed = [client.complete(ASK, label=label) for label in ("1", "2")]
    assert [reply.text for reply in resumed if isinstance(reply, ChatReply)] == ["before", "after"]
    assert len(kit.server.asked) == 3, "the first answer was not asked for again"


@fault(23)
def names_from_outside_make_harmless_files(kit: Kit) -> None:
    names = ["../../etc/passwd", "a\x00b", "x" * 4096, "CON", "nul", "", ".", "..", "~/x", "a/b", "a-b", "\ud800", "é"]
    made = [file_name(name) for name in names]
    assert len(set(made)) == len(names)
    for name in made:
        (kit.folder / name).write_text("")
        assert (kit.folder / name).resolve().parent == kit.folder.resolve()
        assert len(name) < 80 and name.isascii() and name.split("-")[0].lower() != "" and "." not in name
