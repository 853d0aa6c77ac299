"""What endpoints refuse: renamed, reduced or left out once, remembered, recorded; and never the model's fault."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy
import pytest
from chaos_server import chunk, event, refuses, says, sends, streams
from endpoints import BOUNDS, CONTEXT, FULL, REFUSALS, Picky, llamacpp, openai
from llm_kit import ASK, Kit, open_kit

from remac_agents.llm import KINDS, Bill, Budget, Cassette, ChatError, ChatReply, Manners, Picture
from remac_agents.llm.adapting import Manner, respond
from remac_agents.llm.cassette import _check
from remac_agents.llm.refusals import refusal
from remac_agents.llm.request import ChatRequest, digest
from remac_agents.llm.wordings import tokens_told

EVERYTHING: dict[str, Any] = {"max_tokens": 8192, "seed": 3, "response_format": {"type": "json_object"}}
WORDS = [(words, field) for words, fields in REFUSALS.items() for field in fields if field != "images"]


@pytest.fixture
def kit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kit]:
    with open_kit(tmp_path, monkeypatch) as kit:
        yield kit


@pytest.mark.parametrize(("words", "field"), WORDS)
def test_a_field_that_is_refused_is_renamed_or_left_out_once(words: str, field: str, kit: Kit) -> None:
    picky = Picky(words, (field,))
    kit.server.plays(picky.act)
    with kit.client(options={"extra.effort": "high"}) as client:
        first, second = (client.complete(ASK, **EVERYTHING) for _ in range(2))
    assert isinstance(first, ChatReply) and isinstance(second, ChatReply), (first, second)
    assert (first.attempts, second.attempts) == (2, 1), "remembered for the model"
    assert (first.bill.requests, second.bill.requests) == (2, 1)
    told = {
        "max_tokens": "max_tokens -> max_completion_tokens",
        "effort": "extra.effort left out",
        "system": "system message -> user message",
    }
    note = told.get(field, f"{field} left out")
    assert first.adaptations == second.adaptations == (note,)
    refused, accepted, _ = (asked.body for asked in kit.server.asked)
    assert picky.decide(accepted) is picky.answer and picky.decide(refused) is not picky.answer
    rest = {name for name in refused if name not in (field, "stream_options" if field == "stream" else field)}
    assert rest <= set(accepted), "nothing else is left out"
    if field == "system":
        assert accepted["messages"] == [{"role": "user", "content": "You plan.\n\nIs it done?"}]


@pytest.mark.parametrize("words", REFUSALS)
def test_all_fields_may_be_refused_one_after_another(words: str, kit: Kit) -> None:
    fields = tuple(field for field in REFUSALS[words] if field != "images")
    kit.server.plays(Picky(words, fields).act)
    reply = kit.reply(options={"extra.effort": "high"}, ask=EVERYTHING)
    assert reply.attempts <= len(fields) + 1 and len(reply.adaptations) >= len(fields) - 1
    budget = Budget(money=1.0)
    error = kit.outcome(options={"extra.effort": "high"}, ask=EVERYTHING, budget=budget)
    assert isinstance(error, ChatReply) and budget.spent.money == 0.0, "refusals are free"


@pytest.mark.parametrize("words", REFUSALS)
def test_pictures_cannot_be_left_out(words: str, kit: Kit) -> None:
    picture = Picture.of(numpy.zeros((4, 4, 3), dtype=numpy.uint8))
    kit.server.plays(Picky(words, ("images",)).act)
    with kit.client() as client:
        errors = [client.complete(ASK, images=[picture]) for _ in range(2)]
        assert isinstance(client.complete(ASK), ChatReply)
    for error in errors:
        assert isinstance(error, ChatError) and (error.kind, error.infrastructure) == ("unsupported", True)
        assert "images=false" in error.detail
    assert len(kit.server.asked) == 2, "pictures are not sent again"


@pytest.mark.parametrize("words", FULL)
def test_an_answer_gets_what_is_left_of_the_context(words: str, kit: Kit) -> None:
    prompt_alone = words == "llama.cpp"  # it counts the prompt only
    kit.server.plays(Picky(full=words).act)
    with kit.client() as client:
        first, second = (client.complete(ASK, max_tokens=CONTEXT) for _ in range(2))
    for reply in (first, second):
        assert isinstance(reply, ChatReply) and reply.text == "yes"
        assert bool(reply.adaptations) != prompt_alone
    sent = [asked.body["max_tokens"] for asked in kit.server.asked]
    if not prompt_alone and "least" not in words:
        assert sent == [CONTEXT, CONTEXT - 708, sent[2], *sent[3:]]
        assert first.adaptations == (f"max_tokens {CONTEXT} -> {CONTEXT - 708}",)


@pytest.mark.parametrize("words", FULL)
def test_a_prompt_that_leaves_no_room_is_nobodys_failure(words: str, kit: Kit) -> None:
    error = kit.error(Picky(full=words, prompt=CONTEXT + 100).act, ask={"max_tokens": CONTEXT})
    assert (error.kind, error.infrastructure, error.status) == ("context_too_long", True, 400)
    assert "option context" in error.detail
    assert error.attempts < 20


@pytest.mark.parametrize("words", BOUNDS)
def test_an_answer_is_bounded_as_the_endpoint_says(words: str, kit: Kit) -> None:
    kit.server.plays(Picky(longest=words).act)
    with kit.client() as client:
        replies = [client.complete(ASK, max_tokens=8192) for _ in range(2)]
    assert [asked.body["max_tokens"] for asked in kit.server.asked] == [8192, 4096, 4096]
    assert all(isinstance(reply, ChatReply) and reply.adaptations == ("max_tokens 8192 -> 4096",) for reply in replies)


@pytest.mark.parametrize(
    ("text", "context", "prompt"),
    [
        ("request (8300 tokens) exceeds the available context size (8192 tokens), try increasing it", 8192, 8300),
        ("requested tokens (2285) exceed context window of 2048", 2048, 2285),
        ("the input token count (1048577) exceeds the maximum number of tokens allowed (1048576)", 1048576, 1048577),
        ("prompt contains 40000 tokens and 0 draft tokens, too large for model with 32768 maximum context length",
         32768, 40000),
        ("this model's maximum prompt length is 131072 but the request contains 537812 tokens", 131072, 537812),
        ("maximum context length is 128000 tokens. however, your messages resulted in 204308 tokens", 128000, 204308),
        ("maximum context length is 128,000 tokens ... 732 of tool input, 658 of text input", 128000, 1390),
        ("n_prompt_tokens=1407; n_ctx=256", 256, 1407),
        ("max_model_len=4096 is less than 5000 prompt tokens", 4096, 5000),
    ],
)
def test_numbers_of_tokens_are_read(text: str, context: int, prompt: int) -> None:
    told = tokens_told(text, 8192)
    assert (told.context, told.prompt) == (context, prompt)


@pytest.mark.parametrize(
    ("status", "text", "found"),
    [
        (400, "`max_tokens` is not supported here; please use `max_completion_tokens`", "max_completion_tokens"),
        (400, "max_tokens: Extra inputs are not permitted", "max_completion_tokens"),
        (400, "Invalid value for max_tokens: 8192. Must be <= 4096", 4096),
        (400, "max_tokens must be between 1 and 4096", 4096),
        (400, "The maximum tokens you requested exceeds the model limit of 4096. Try a value lower than 4096.", 4096),
        (416, "max_completion_tokens is limited to 4096 for this model", 4096),
        (400, "Requested max_tokens (8192) + prompt tokens (708) > max context (8192)", 7484),
        (400, "The input (708 tokens) plus max_tokens (8192) is longer than the context length (8192 tokens).", 7484),
        (400, "Input length 9000 exceeds the maximum allowed length 8192", "context_too_long"),
        (400, "The decoder prompt (length 9000) is longer than the maximum model length of 8192.", "context_too_long"),
        (400, "Your input exceeds the context window of this model.", 4096),
        (400, "`temperature` must be strictly positive", "temperature"),
        (400, "temperature: range (0, 2], got 0", "temperature"),
        (400, "'messages' must contain the word 'json' in some form, to use 'response_format'", "response_format"),
        (400, "Model does not support JSON mode", "response_format"),
        (400, "JSON mode cannot be combined with streaming", "response_format"),
        (404, "No endpoints found that can handle the requested parameters.", "response_format"),
        (400, "Streaming responses are not available for this model", "stream"),
        (400, 'Invalid JSON payload received. Unknown name "seed": Cannot find field.', "seed"),
        (400, "Unsupported value: 'effort' does not support 'high' with this model.", "effort"),
        (400, "Conversation roles must alternate user/assistant/user/assistant/...", "system"),
        (400, "Developer instruction is not enabled for this model", "system"),
        (500, "context deadline exceeded while reading the message", "server_error"),
        (500, "the stream ended: seed not accepted", "server_error"),
        (400, "The model `m` does not exist", "unknown_model"),
        (400, "API key not valid. Please pass a valid API key.", "unauthorised"),
        (403, "This key is not permitted to use the system", "unauthorised"),
    ],
)
def test_further_wordings(status: int, text: str, found: str | int, kit: Kit) -> None:
    client = kit.client(options={"extra.effort": "high"})
    asked = ChatRequest(client.endpoint, (("system", "s"), ("user", "u")), stream=True, **EVERYTHING)
    change = respond(refusal(status, text, None), asked, asked, Manner(), 0)
    if isinstance(change, ChatError):
        assert change.kind == found
        return
    manner = change.manner
    told = {change.room, manner.field, manner.longest, "stream" if manner.stream is False else None, *manner.left_out}
    assert told - {None} == {found}


def test_the_bound_gets_a_second_name_and_then_none(kit: Kit) -> None:
    def act(connection: Any, asked: Any) -> None:
        name = next((n for n in ("max_tokens", "max_completion_tokens") if n in asked.body), None)
        answer = says() if name is None else refuses(400, f"Unsupported parameter: {name}")
        answer(connection, asked)

    reply = kit.reply(act)
    assert (reply.attempts, reply.adaptations) == (3, ("max_tokens left out",))


def test_an_endpoint_that_only_streams_is_asked_so(kit: Kit) -> None:
    def act(connection: Any, asked: Any) -> None:
        told = "This model only support stream mode, please enable the stream parameter to access the model."
        (says() if asked.body.get("stream") else refuses(400, told))(connection, asked)

    reply = kit.reply(act, stream=False)
    assert (reply.attempts, reply.adaptations) == (2, ("stream -> true",))


def test_errors_under_status_200_are_read_as_what_they_are(kit: Kit) -> None:
    told = openai("Unsupported parameter: 'temperature' is not supported with this model.", "temperature", None)
    coded = llamacpp("Unsupported param: temperature")
    for body in (told, coded):
        for act in (sends(json.dumps(body).encode()), streams(b"data: " + json.dumps(body).encode() + b"\n\n")):
            reply = kit.reply(act, says())
            assert (reply.attempts, reply.adaptations) == (2, ("temperature left out",))
    busy = sends(b'{"error": {"message": "slow down", "code": 429}}')
    assert kit.reply(busy, says()).attempts == 2
    assert kit.error(sends(b'{"error": {"message": "no credits", "code": 402}}')).kind == "quota"
    failing = kit.reply(streams(chunk("ye"), event({"error": {"message": "overloaded", "code": 502}})), says())
    assert (failing.attempts, failing.bill.requests, failing.bill.unpriced) == (2, 2, 2), "it had begun to answer"


@pytest.mark.parametrize(
    "message",
    [
        "Invalid 'messages': the last one must be the user's",
        "The upstream system had to stop the stream",
        "Your prompt was flagged by our system as potentially violating our policy",
        "no",
    ],
)
def test_what_names_no_field_is_refused_once_and_names_the_options(message: str, kit: Kit) -> None:
    error = kit.error(refuses(400, message))
    assert (error.kind, error.attempts <= 2, error.infrastructure) == ("bad_request", True, True)
    assert "max_tokens_field" in error.detail and "extra.NAME" in error.detail


def test_nothing_is_remembered_that_did_not_help(kit: Kit) -> None:
    manners = Manners()
    error = kit.error(refuses(400, "temperature is not supported"), manners=manners)
    assert (error.kind, error.attempts) == ("bad_request", 2)
    assert manners.of(kit.client().endpoint).left_out == frozenset()


def test_clients_of_a_run_share_what_they_learn(kit: Kit) -> None:
    manners = Manners()
    picky = Picky("OpenAI", ("max_tokens", "temperature"))
    assert kit.reply(picky.act, manners=manners).attempts == 3
    assert kit.reply(picky.act, manners=manners).attempts == 1
    assert kit.reply(picky.act, manners=manners, model="another").attempts == 3


def test_an_answer_that_hits_its_bound_is_asked_for_with_more(kit: Kit) -> None:
    def cut_below(tokens: int) -> Any:
        def act(connection: Any, asked: Any) -> None:
            finish = "stop" if asked.body["max_tokens"] >= tokens else "length"
            says("the plan", finish=finish)(connection, asked)

        return act

    for enough, sent in ((100, [50, 200]), (30_000, [50, 200, 32_768])):
        reply = kit.reply(cut_below(enough))
        assert [asked.body["max_tokens"] for asked in kit.server.asked] == sent
        assert reply.bill.requests == len(sent) and reply.bill.tokens_out == 5 * len(sent)
        assert reply.adaptations == (f"max_tokens 50 -> {sent[-1]}",)
    error = kit.error(cut_below(10**9))
    assert (error.kind, error.attempts, error.infrastructure) == ("cut_short", 3, False)
    error = kit.error(cut_below(10**9), options={"max_tokens_bound": 50})
    assert (error.kind, error.attempts, error.infrastructure) == ("cut_short", 1, False), "a bound of the user's"
    error = kit.error(cut_below(10**9), options={"context": 2048}, ask={"max_tokens": 1500})
    assert (error.kind, error.infrastructure) == ("cut_short", False)
    assert max(asked.body["max_tokens"] for asked in kit.server.asked) < 2048, "never more than the context holds"


def test_an_answer_that_was_given_no_room_is_nobodys_failure(kit: Kit) -> None:
    picky = Picky(full="vLLM", prompt=CONTEXT - 100, answer=says("half a pl", finish="length"))
    error = kit.error(picky.act, ask={"max_tokens": CONTEXT})
    assert (error.kind, error.infrastructure) == ("context_too_long", True)
    assert "100 tokens at most" in error.detail


def test_a_longer_answer_that_the_budget_refuses_leaves_the_answer_cut(kit: Kit) -> None:
    error = kit.error(says("half", finish="length"), budget=Budget(calls=1))
    assert (error.kind, error.attempts, error.bill.requests) == ("cut_short", 1, 1)


def test_a_cassette_keeps_the_question_as_it_was_asked(kit: Kit) -> None:
    path = kit.folder / "c.jsonl"
    plain = kit.reply(says(), ask={"max_tokens": 8192})
    picky = Picky("OpenAI", ("max_tokens", "temperature", "stream"), full="OpenAI")
    told = kit.reply(picky.act, ask={"max_tokens": 8192}, cassette=Cassette(path))
    assert told.key == plain.key, "how it was sent is no part of the question"
    kit.server.plays(says("live"))
    played = kit.reply(ask={"max_tokens": 8192}, cassette=Cassette(path, mode="replay"))
    assert kit.server.asked == []
    assert (played.text, played.bill, played.adaptations) == (told.text, told.bill, told.adaptations)
    assert played.bill.requests == 5 and len(played.adaptations) == 4


def test_every_kind_that_our_own_request_may_cause_is_infrastructure() -> None:
    blamed = {kind for kind, told in KINDS.items() if not told.infrastructure}
    assert blamed == {"oversized", "empty", "cut_short", "filtered", "tool_call", "over_budget"}


def test_questions_keep_the_keys_that_they_always_had(kit: Kit) -> None:
    endpoint = kit.client(base_url="http://127.0.0.1:9/v1", model="m").endpoint
    asked = ChatRequest(endpoint, (("system", "You plan."), ("user", "Is it done?")), max_tokens=50, seed=3, label="x")
    asked = replace(asked, response_format={"type": "json_object"}, versions={"a": "1"}, stream=True)
    assert digest(asked.canonical()) == "f1f70f4e5d96e12da12ae0cb763bfeefb95ce2a53341fa6fb21c1a95ae4373c8"


def test_cassettes_of_before_are_played(kit: Kit) -> None:
    path = kit.folder / "c.jsonl"
    told = kit.reply(says("yes"), cassette=Cassette(path))
    entry = json.loads(path.read_text())
    entry["value"] = {name: value for name, value in entry["value"].items() if name not in ("bill", "adaptations")}
    entry["check"] = _check(entry)
    path.write_text(json.dumps(entry) + "\n")
    played = kit.reply(cassette=Cassette(path, mode="replay"))
    assert (played.text, played.tokens_in, played.adaptations) == (told.text, told.tokens_in, ())
    assert played.bill == Bill(requests=1, tokens_in=10, tokens_out=5, money=0.0, unpriced=1)
