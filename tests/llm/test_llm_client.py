"""The chat client where all is well, and its own bounds."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy
import pytest
from chaos_server import DONE, USAGE, chunk, completion, refuses, says, sends, streams
from llm_kit import ASK, KEY, Kit, open_kit

from remac_agents.llm import KINDS, Budget, ChatClient, ChatError, ChatReply, Picture, plain, resolve
from remac_agents.llm.budget import Cost
from remac_agents.text.thoughts import split_reasoning
from remac_env.errors import OptionError


@pytest.fixture
def kit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kit]:
    with open_kit(tmp_path, monkeypatch) as kit:
        yield kit


def test_plain_and_streamed_answers_are_the_same(kit: Kit) -> None:
    plainly = kit.reply(says("pick up\ncup", reasoning_content="first\nthen", id="a"), stream=False)
    assert "stream" not in kit.server.asked[0].body
    pieces = [chunk(reasoning_content="first"), chunk(reasoning_content="\nthen"), chunk("pick up"), chunk("\ncup")]
    ids = chunk("", finish="stop").replace(b'"id": ""', b'"id": "a"')
    streamed = kit.reply(streams(*pieces, ids, USAGE, DONE))
    assert kit.server.asked[0].body["stream"] is True
    assert replace(streamed, seconds=0.0) == replace(plainly, seconds=0.0)
    assert (plainly.text, plainly.reasoning) == ("pick up\ncup", "first\nthen")
    assert (plainly.tokens_in, plainly.tokens_out, plainly.finish_reason) == (10, 5, "stop")


def test_a_plain_answer_to_a_streamed_question_is_read_and_the_other_way_round(kit: Kit) -> None:
    assert kit.reply(says("whole"), stream=True).text == "whole"
    pieces = [chunk("in pieces"), chunk("", finish="stop"), DONE]
    assert kit.reply(streams(*pieces), stream=False).text == "in pieces"


@pytest.mark.parametrize(
    ("text", "answer", "reasoning"),
    [
        ("yes", "yes", ""),
        ("<think>a\nb</think>\n\nyes", "yes", "a\nb"),
        ("<THINK>a</Think>yes<thinking>b</thinking> no", "yes no", "a\nb"),
        ("the tag was in the prompt</think>yes", "yes", "the tag was in the prompt"),
        ("<think>a<think>b</think>c</think>yes", "yes", "a\nb\nc"),
        ("yes <think>unclosed: no", "yes", "unclosed: no"),
        ("<think>", "", ""),
        ("", "", ""),
        ("1 < 2 <thinker>", "1 < 2 <thinker>", ""),
    ],
)
def test_reasoning_apart(text: str, answer: str, reasoning: str) -> None:
    assert split_reasoning(text) == (answer, reasoning)


def test_reasoning_fields_and_blocks_add_up(kit: Kit) -> None:
    reply = kit.reply(says("<think>two</think>yes", reasoning="one"))
    assert (reply.text, reply.reasoning) == ("yes", "one\ntwo")
    body = [chunk(reasoning="on"), chunk("<thi"), chunk("nk>two</think>yes"), chunk(reasoning="e", finish="stop"), DONE]
    assert kit.reply(streams(*body), stream=True).reasoning == "one\ntwo"


def test_what_is_sent(kit: Kit) -> None:
    form = {"type": "json_object"}
    asks = {"max_tokens": 77, "temperature": 0.5, "seed": 3, "response_format": form}
    kit.reply(says(), ask=asks, stream=False)
    asked = kit.server.asked[0]
    assert asked.path == "/v1/chat/completions"
    assert asked.headers["authorization"] == f"Bearer {KEY}"
    sent = {"model": "test-model", "max_tokens": 77, "temperature": 0.5, "seed": 3, "response_format": form}
    assert asked.body == {**sent, "messages": ASK}
    kit.reply(says(), ask=asks)
    in_pieces = {"stream": True, "stream_options": {"include_usage": True}}
    assert kit.server.asked[0].body == {**sent, **in_pieces, "messages": ASK}
    kit.reply(says(), key="", ask={"temperature": None})
    assert "authorization" not in kit.server.asked[0].headers and "temperature" not in kit.server.asked[0].body


def test_a_model_is_sent_only_what_it_takes(kit: Kit) -> None:
    openai = resolve("openai:o3")
    endpoint = replace(openai, base_url=kit.server.url)
    kit.server.plays(says())
    with ChatClient(endpoint, environ={"OPENAI_API_KEY": KEY}) as client:
        reply = client.complete(ASK, temperature=0.0)
    assert isinstance(reply, ChatReply)
    assert kit.server.asked[0].body["max_completion_tokens"] == 32768
    assert not {"temperature", "max_tokens"} & set(kit.server.asked[0].body)
    assert reply.money == pytest.approx((10 * 2.0 + 5 * 8.0) / 1e6)
    blind = replace(endpoint, model=replace(endpoint.model, images=False, response_format=()))
    picture = Picture.of(numpy.zeros((4, 4, 3), dtype=numpy.uint8))
    with ChatClient(blind, environ={"OPENAI_API_KEY": KEY}) as client:
        assert client.complete(ASK, images=[picture]) == ChatError(
            "unsupported", "openai:o3 takes no images (option images)", key=client.complete(ASK, images=[picture]).key
        )
        formless = client.complete(ASK, response_format={"type": "json_object"})
    assert isinstance(formless, ChatReply) and "response_format_not_offered" in formless.flags
    assert "response_format" not in kit.server.asked[-1].body


def test_pictures_go_with_the_last_message_of_the_user(kit: Kit) -> None:
    pixels = numpy.arange(48, dtype=numpy.uint8).reshape(4, 4, 3)
    kit.reply(says(), ask={"images": [Picture.of(pixels)]})
    text, image = kit.server.asked[0].body["messages"][1]["content"]
    assert text == {"type": "text", "text": "Is it done?"}
    assert image["image_url"]["url"].startswith("data:image/png;base64,iVBOR")
    assert Picture.of(pixels).digest != Picture.of(pixels[::-1]).digest
    with pytest.raises(OptionError, match="uint8"):
        Picture.of(pixels.astype(float))


def test_no_key_no_call(kit: Kit) -> None:
    with ChatClient(replace(resolve("xai:grok-3"), base_url=kit.server.url), environ={}) as client:
        error = client.complete(ASK)
    assert isinstance(error, ChatError)
    assert (error.kind, error.detail, error.attempts) == ("unauthorised", "set XAI_API_KEY to your key of xAI", 0)
    assert kit.server.asked == []


def test_a_prompt_that_cannot_fit_is_not_sent(kit: Kit) -> None:
    endpoint = replace(resolve("xai:grok-3"), base_url=kit.server.url)
    with ChatClient(endpoint, environ={"XAI_API_KEY": KEY}) as client:
        error = client.complete([{"role": "user", "content": "x" * 1_000_000}])
    assert isinstance(error, ChatError) and error.kind == "context_too_long" and kit.server.asked == []


@pytest.mark.parametrize(
    ("messages", "options"),
    [
        ([], {}),
        ([{"role": "robot", "content": "x"}], {}),
        ([{"role": "user", "content": None}], {}),
        (ASK[:1], {"images": [Picture(b"", "")]}),
        (ASK, {"max_tokens": 0}),
        (ASK, {"deadline": 0}),
        (ASK, {"deadline": float("nan")}),
        (ASK, {"temperature": float("nan")}),
    ],
)
def test_wrong_arguments_are_refused(kit: Kit, messages: Any, options: dict[str, Any]) -> None:
    with kit.client() as client, pytest.raises(OptionError, match="valid|hold no message"):
        client.complete(messages, **options)


def test_text_that_cannot_be_encoded_is_made_sound(kit: Kit) -> None:
    reply = kit.reply(sends(b'{"choices": [{"message": {"content": "a\\ud800b"}, "finish_reason": "stop"}]}'))
    assert reply.text == "a?b"


def test_bodies_of_a_strange_form_are_malformed(kit: Kit) -> None:
    odd: list[Any] = [
        [],
        3,
        None,
        {},
        {"choices": []},
        {"choices": [3]},
        {"choices": {}},
        {"choices": [{"message": 3}]},
    ]
    odd += [completion(3), completion([3]), completion(finish=3), completion(tool_calls=3)]  # type: ignore[arg-type]
    for body in [*(json.dumps(value).encode() for value in odd), b"[" * 100_000, b"\xff\xfe", b"1" * 5000]:
        assert kit.error(sends(body)).kind == "malformed", body[:60]
    parts = [{"type": "text", "text": "a"}, {"type": "text", "text": "b"}]
    assert kit.reply(says(parts)).text == "ab"  # type: ignore[arg-type]


def test_different_faults_together_are_bounded_too(kit: Kit) -> None:
    acts = [refuses(500), says(""), refuses(429), sends(b"no"), says(""), refuses(502), says("too late")]
    error = kit.error(*acts)
    assert (error.kind, error.attempts) == ("server_error", 6)
    rests = [wait for wait in kit.time.slept if wait]
    assert rests == sorted(rests), "each wait is longer"
    assert kit.time.slept.count(0.0) == 2, "an endpoint that is well is asked again at once"


def test_budget_of_calls_tokens_and_money(kit: Kit) -> None:
    budget = Budget(calls=3)
    error = kit.error(refuses(500), budget=budget)
    assert (error.kind, error.attempts, budget.spent.calls) == ("over_budget", 3, 3)
    assert error.detail == "calls: 4 would be spent at most, 3 allowed" and not error.infrastructure
    tokens = Budget(tokens=100)
    assert kit.outcome(says(), budget=tokens).attempts == 1
    assert tokens.spent.tokens == 15
    assert kit.error(says(), budget=Budget(tokens=50)).kind == "over_budget", "50 of the answer, and the prompt"
    assert kit.server.asked == []
    endpoint = replace(resolve("openai:gpt-4o"), base_url=kit.server.url)
    money = Budget(money=0.0013)
    with ChatClient(endpoint, environ={"OPENAI_API_KEY": KEY}, budget=money) as client:
        first, second = client.complete(ASK, max_tokens=100), client.complete(ASK, max_tokens=150)
    assert isinstance(first, ChatReply) and isinstance(second, ChatError) and "money" in second.detail
    assert money.spent.money == first.money == pytest.approx(75e-6)


def test_requests_under_way_count_with_their_worst_case() -> None:
    budget = Budget(calls=2, tokens=100)
    assert budget.refuse(Cost(60, None)) == ""
    assert budget.refuse(Cost(60, None)) == "tokens: 120 would be spent at most, 100 allowed"
    budget.book(Cost(60, None), Cost(10, None))
    assert budget.refuse(Cost(60, None)) == ""
    assert "calls: 3" in budget.refuse(Cost(0, None))


def test_budget_of_seconds(kit: Kit) -> None:
    budget = Budget(seconds=40)
    kit.error(refuses(429, "slow", "retry-after: 30"), budget=budget)
    assert 29 < budget.spent.seconds < 40, "30 s fit once"
    left = budget.seconds_left()
    assert left is not None and left < 11
    kit.time.skipped += 1000
    error = kit.error(refuses(429, "slow", "retry-after: 30"), budget=budget)
    assert (error.kind, error.attempts) == ("rate_limited", 1)
    spent = Budget(seconds=0)
    assert kit.error(says(), budget=spent).kind in ("over_budget", "timeout")
    with pytest.raises(OptionError, match="seconds"):
        Budget(seconds=-1)


def test_the_kinds_are_one_closed_list(kit: Kit) -> None:
    assert len(KINDS) == 21
    assert {kind for kind in KINDS if KINDS[kind].tries > 1 and not KINDS[kind].infrastructure} == {"empty"}
    with pytest.raises(KeyError):
        _ = ChatError("invented").retriable
    assert all(plain(kind.meaning) == kind.meaning for kind in KINDS.values())
