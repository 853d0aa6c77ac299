"""Servers that keep to the protocol in their own way: what they say is an answer, an error of theirs, or nobody's;
never an empty answer for which the model is blamed."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from chaos_server import DONE, Act, chunk, completion, drips, event, says, sends, streams
from llm_kit import Kit, open_kit

from remac_agents.llm import ChatError, ChatReply
from remac_agents.llm.adapting import Manner, respond
from remac_agents.llm.refusals import refusal
from remac_agents.llm.request import ChatRequest

WHOLE = [chunk("ye"), chunk("s"), chunk("", finish="stop")]
PAIR = [b'data: {"choices":[{"index":0,"delta":{"content":"%s"}}]}\n\n' % half for half in (b"yes \\ud83d", b"\\ude00")]
STOP = {"index": 0, "finish_reason": "stop"}
NO = {"message": "out of memory", "code": 503}


@pytest.fixture
def kit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kit]:
    with open_kit(tmp_path, monkeypatch) as kit:
        yield kit


def body(choice: dict[str, Any], **top: Any) -> bytes:
    return json.dumps({"choices": [STOP | choice], **top}).encode()


def failing(code: str) -> bytes:
    return json.dumps({"error": {"message": "x", "code": code}}).encode()


def chunked(*parts: bytes, end: bytes = b"0\r\n\r\n") -> Act:
    head = b"HTTP/1.1 200 OK\r\ncontent-type: text/event-stream\r\ntransfer-encoding: chunked\r\n\r\n"
    return drips(head, *(b"%x\r\n%s\r\n" % (len(part), part) for part in parts), end)


ANSWERS = {
    "stream called JSON": sends(b"".join(WHOLE) + DONE),
    "stream called text": sends(b"".join(WHOLE) + DONE, kind="text/plain"),
    "stream called nothing": drips(b"HTTP/1.1 200 OK\r\n\r\n", b": hello\n\n", *WHOLE, DONE),
    "JSON called stream": sends(b"\n \n" + json.dumps(completion("yes")).encode(), kind="text/event-stream"),
    "whole message in a stream": streams(event(completion("yes")), DONE),
    "whole message after its pieces": streams(*WHOLE, event(completion("yes")), DONE),
    "bare text": sends(body({"text": "yes"})),
    "bare text in a stream": streams(event({"choices": [STOP | {"text": "yes"}]}), DONE),
    "all came, no terminator": chunked(*WHOLE),
    "length kept, no terminator": sends(b"".join(WHOLE), kind="text/event-stream"),
    "error that is none": sends(body({"message": {"content": "yes"}}, error=None)),
    "pair split in two": streams(*PAIR, *WHOLE[2:], DONE),
}

FAULTS = {
    "error in the choice": (sends(body({"message": {"content": ""}, "error": NO})), "server_error"),
    "error in a streamed choice": (streams(event({"choices": [STOP | {"error": NO}]}), DONE), "server_error"),
    "error beside an empty choice": (sends(body({"message": {"content": ""}}, error=NO)), "server_error"),
    "error as an event": (streams(chunk("y"), b"event: error\ndata: out of memory\n\n"), "server_error"),
    "error as a line": (streams(chunk("y"), b'error: {"code": 429, "message": "slow"}\n\n'), "rate_limited"),
    "error in a list": (sends(b'[{"error": {"code": 429, "message": "exhausted"}}]'), "rate_limited"),
    "error without a frame": (sends(b'{"object": "error", "message": "boom", "code": 402}'), "quota"),
    "code of 5,000 digits": (sends(failing("9" * 5000)), "server_error"),
    "code in other digits": (sends(failing("٤²٠")), "server_error"),
    "parts of no known form": (sends(body({"message": {"content": [{"content": "yes"}]}})), "malformed"),
    "no message": (sends(body({})), "malformed"),
    "damaged line": (streams(b"\0\0", *WHOLE, DONE), "malformed"),
    "cut between chunks": (chunked(*WHOLE, end=b""), "truncated"),
    "all came, no ending": (chunked(*WHOLE[:2]), "truncated"),
    "error page that is a bomb of brackets": (sends(b'{"error":{"message":' + b"[" * 900 + b"]" * 900 + b"}}"), ""),
}


@pytest.mark.parametrize("name", ANSWERS)
def test_an_answer_in_a_form_of_its_own(name: str, kit: Kit) -> None:
    reply = kit.reply(ANSWERS[name])
    assert (reply.text.removesuffix(" \U0001f600"), reply.attempts) == ("yes", 1)


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_the_endpoint_is_not_the_models(name: str, kit: Kit) -> None:
    act, kind = FAULTS[name]
    error = kit.error(act)
    assert error.infrastructure and error.kind == (kind or error.kind), error


def test_a_refusal_in_a_part_is_one(kit: Kit) -> None:
    assert kit.error(sends(body({"message": {"content": [{"type": "refusal", "refusal": "no"}]}}))).kind == "filtered"


def test_an_answer_cut_off_by_status_400_is_asked_for_with_more(kit: Kit) -> None:
    told = "Could not finish the message because max_tokens or model output limit was reached."
    reply = kit.reply(sends(json.dumps({"error": {"message": told}}).encode(), status=400), says())
    assert reply.adaptations == ("max_tokens 50 -> 200",)


@pytest.mark.parametrize(
    ("status", "text", "found"),
    [
        (400, "Failed to generate JSON. Please adjust your prompt.; json_validate_failed", "response_format"),
        (400, "This model does not support response formats", "response_format"),
        (400, "maxOutputTokens value of 8192 but the supported range is from 1 (inclusive) to 4097 (exclusive)", 4096),
        (400, "Malformed input request: #/inferenceConfig/maxTokens: 8192 is not less or equal to 4096", 4096),
        (400, "parameter max_tokens is too big", 4096),
        (400, "`inputs` must have less than 4096 tokens. Given: 5000", 4096),
        (400, "The input token count is 40000 but model only supports up to 32768.", 4096),
        (400, "Prompt length 9000 is greater than max_seq_len 8192", 4096),
        (413, "Request too large on tokens per minute (TPM): Limit 6000, Requested 8900", 5292),
        (429, "Request too large for m on tokens per min (TPM): Limit 6000, Requested 8900", 5292),
        (429, "Rate limit reached on tokens per min (TPM): Limit 6000, Used 5000, Requested 1200", "rate_limited"),
        (400, "max_tokens is too low, must be at least 100", "bad_request"),
        (400, "integer below minimum value. Expected a max_tokens value >= 16, but got 10 instead", "bad_request"),
        (400, "`max_tokens` must be greater than `thinking.budget_tokens` (2000)", "bad_request"),
        (500, "Value error in the template: System role not supported", "system"),
        (400, "Only user and assistant roles are supported!", "system"),
        (400, "Role 'system' is not one of ['user', 'assistant']", "system"),
        (400, "Input should be 'user' or 'assistant'; (param: messages.0.role)", "system"),
        (400, "Your credit balance is too low", "quota"),
        (400, "The model `m` has been decommissioned", "unknown_model"),
    ],
)
def test_wordings_of_further_companies(status: int, text: str, found: str | int, kit: Kit) -> None:
    form = {"type": "json_object"}
    messages = (("system", "s"), ("user", "u"))
    asked = ChatRequest(kit.client().endpoint, messages, max_tokens=8192, seed=3, response_format=form, stream=True)
    change = respond(refusal(status, text, None), asked, asked, Manner(), 0)
    if isinstance(change, ChatError):
        assert change.kind == found and change.infrastructure
    else:
        assert {change.room, change.manner.longest, *change.manner.left_out} - {None} == {found}


def test_both_lists_can_fail(kit: Kit) -> None:
    assert isinstance(kit.outcome(says("no")), ChatReply) and kit.error(says("")).infrastructure is False
