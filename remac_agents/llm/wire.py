"""The protocol's answers, read with suspicion: one JSON body, or server-sent events that arrive in any pieces."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from remac_agents.llm.outcomes import ChatError
from remac_agents.llm.refusals import refusal

EXCERPT = 500
"""Characters of a strange answer that go into an error's detail."""


BOM = b"\xef\xbb\xbf"
"""The mark that some programs put before UTF-8."""

IN_STREAM = "in the stream: "
"""Stands before an error that came in a stream."""

THINKING = ("thinking", "reasoning", "reasoning_text", "thought", "redacted_thinking")
"""Types of parts of a content that are no answer."""

LOOSE = ("text", "thinking", "reasoning", "summary", "content")
LOOSE_DEPTH = 4
"""Where the text of reasoning stands in an object, and how deep objects may be nested."""


@dataclass(frozen=True)
class Caps:
    """How much of an answer is read.

    Attributes:
        body_bytes: of an answer in one piece, after inflation.
        stream_bytes: of a streamed one; each token comes in a wrapping of some hundred bytes.
        line_bytes: of one line of it.
        text: characters of answer and reasoning together.
        error_bytes: of an error page.
    """

    body_bytes: int = 4 << 20
    stream_bytes: int = 64 << 20
    line_bytes: int = 1 << 20
    text: int = 1 << 20
    error_bytes: int = 64 << 10


@dataclass
class Raw:
    """An answer as it came, not judged yet. `done`: it was streamed, and the stream came to its end."""

    content: str = ""
    reasoning: str = ""
    finish: str | None = None
    refused: bool = False
    tools: list[str] = field(default_factory=list)
    usage: Any = None
    model: str = ""
    response_id: str = ""
    fingerprint: str = ""
    done: bool = False


class _Strange(ValueError):
    """An answer that is not what the protocol says."""


def read_body(data: bytes, caps: Caps) -> Raw | ChatError:
    """An answer in one piece."""
    try:
        body = _json(data)
        raw = Raw()
        _note_origin(raw, body)
        choice = _choice(body.get("choices"))
        if choice is None and body.get("error"):
            return _error_inside(body, data, "in the answer: ")
        if choice is None:
            raise _Strange("it holds no choice")
        _add(raw, choice, choice.get("message"))
    except _Strange as error:
        return ChatError("malformed", f"{error}: {data[:EXCERPT].decode('utf-8', 'replace')}")
    return raw if _length(raw) <= caps.text else _oversized(caps)


class StreamReader:
    """Server-sent events -> an answer. `feed` it bytes until it returns True or an error; then `result`."""

    def __init__(self, caps: Caps) -> None:
        self._caps = caps
        self._raw = Raw()
        self._pending = b""
        self._data: list[bytes] = []
        self._texts: dict[str, list[str]] = {"content": [], "reasoning": []}
        self._length = 0
        self._done = self._begun = False

    def feed(self, data: bytes) -> bool | ChatError:
        """Read on. True: the terminator came."""
        try:
            for line in self._lines(data):
                if line:
                    name, _, value = line.partition(b":")
                    if name == b"data":
                        self._data.append(value.removeprefix(b" "))
                    continue
                event, self._data = b"\n".join(self._data), []
                if event.strip() == b"[DONE]":
                    self._done = True
                    return True
                error = self._event(event) if event.strip() else None
                if error is not None:
                    return error
        except _Strange as strange:
            return ChatError("malformed", str(strange))
        size = len(self._pending) + sum(len(part) for part in self._data)
        if size > self._caps.line_bytes or self._length > self._caps.text:
            return _oversized(self._caps)
        return False

    def result(self) -> Raw | ChatError:
        """The answer, once nothing more comes. Without the terminator there is none, however whole it looks."""
        if not self._done:
            self.feed(b"\n\n")  # a last line may lack its end
        if not self._done:
            return ChatError("truncated", "the stream ended before [DONE]")
        self._raw.content = "".join(self._texts["content"])
        self._raw.reasoning = "".join(self._texts["reasoning"])
        self._raw.done = True
        return self._raw

    def _lines(self, data: bytes) -> Iterator[bytes]:
        """Whole lines; \\r\\n, \\n and \\r end one. A \\r at the very end may be half of a \\r\\n and waits."""
        self._pending += data
        if not self._begun and len(self._pending) >= len(BOM):
            self._begun, self._pending = True, self._pending.removeprefix(BOM)
        held = b"\r" if self._pending.endswith(b"\r") else b""
        text = self._pending[: len(self._pending) - len(held)].replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        *lines, rest = text.split(b"\n")
        self._pending = rest + held
        yield from lines

    def _event(self, event: bytes) -> ChatError | None:
        chunk = _json(event)
        if chunk.get("error"):
            return _error_inside(chunk, event, IN_STREAM)
        _note_origin(self._raw, chunk)
        choice = _choice(chunk.get("choices"))
        if choice is not None:
            piece = Raw(finish=self._raw.finish)
            _add(piece, choice, choice.get("delta"))
            self._texts["content"].append(piece.content)
            self._texts["reasoning"].append(piece.reasoning)
            self._length += _length(piece)
            self._raw.finish = self._raw.finish or piece.finish
            self._raw.refused |= piece.refused
            self._raw.tools += piece.tools[: max(0, 16 - len(self._raw.tools))]
        return None


def error_text(data: bytes) -> str:
    """What an error body says: message, code and type, what the company behind the endpoint said, which parameter it is
    about, and counts of tokens; or the body's beginning."""
    try:
        body = _json(data)
    except _Strange:
        return data[: 2 * EXCERPT].decode("utf-8", "replace")
    error = body.get("error", body if isinstance(body.get("message"), str) else None)
    if not isinstance(error, dict):
        text = data.decode("utf-8", "replace") if error is None else str(error)
        return text[: 2 * EXCERPT]
    told = [str(error[name]) for name in ("message", "code", "type") if error.get(name)]
    metadata = error.get("metadata")
    if isinstance(metadata, dict) and metadata.get("raw"):
        raw = metadata["raw"] if isinstance(metadata["raw"], str) else json.dumps(metadata["raw"])
        told.insert(0, error_text(raw.encode("utf-8", "replace")))
    told += [f"(param: {error['param']})"] if error.get("param") else []
    told += [f"{name}={error[name]}" for name in ("n_prompt_tokens", "n_ctx") if isinstance(error.get(name), int)]
    return "; ".join(told)[: 2 * EXCERPT]


def _error_inside(body: dict[str, Any], data: bytes, where: str) -> ChatError:
    """An error under status 200: a refusal where it names the status of one, else a failure of the endpoint, which may
    have cost something."""
    error = body["error"]
    code = error.get("code", error.get("status")) if isinstance(error, dict) else None
    status = int(code) if str(code).isdecimal() and 400 <= int(code) < 500 else None  # type: ignore[arg-type]
    told = where + error_text(data)
    if status is None and re.search(r"invalid_request|unsupported|context_length", told, re.IGNORECASE):
        status = 400  # a request that was refused, by an endpoint that had begun to answer it
    return ChatError("server_error", told) if status is None else refusal(status, told, None)


def _json(data: bytes) -> dict[str, Any]:
    try:
        value = json.loads(data.removeprefix(BOM))
    except (ValueError, RecursionError) as error:
        raise _Strange(f"no JSON ({type(error).__name__})") from None
    if not isinstance(value, dict):
        raise _Strange("no JSON object")
    return value


def _note_origin(raw: Raw, body: dict[str, Any]) -> None:
    for name, key in (("model", "model"), ("response_id", "id"), ("fingerprint", "system_fingerprint")):
        value = body.get(key)
        if isinstance(value, str) and value:
            setattr(raw, name, value[:200])
    if body.get("usage") is not None:
        raw.usage = body["usage"]


def _choice(choices: Any) -> dict[str, Any] | None:
    """The first choice with index 0 (one was asked for); None if there is none, as in a chunk with usage only."""
    if choices is None:
        return None
    if not isinstance(choices, list) or not all(isinstance(choice, dict) for choice in choices):
        raise _Strange("its choices are no list of objects")
    return next((choice for choice in choices if choice.get("index") in (0, None)), None)


def _add(raw: Raw, choice: dict[str, Any], message: Any) -> None:
    if message is None:
        message = {}
    if not isinstance(message, dict):
        raise _Strange("its message is no object")
    raw.content += _text(message.get("content"))
    raw.reasoning += _reasoning(message)
    raw.refused |= bool(message.get("refusal"))
    raw.tools += _tools(message)
    finish = choice.get("finish_reason")
    if isinstance(finish, dict):
        finish = finish.get("type")  # SGLang's own form
    if finish is not None and not isinstance(finish, str):
        raise _Strange("its finish_reason is no text")
    raw.finish = raw.finish or finish


def _text(value: Any) -> str:
    """Text given as such, or as a list of parts."""
    if value is None:
        return ""
    if isinstance(value, list) and all(isinstance(part, dict) for part in value):
        return "".join(_text(part.get("text")) for part in value if part.get("type") not in THINKING)
    if not isinstance(value, str):
        raise _Strange("its content is no text")
    return value


def _reasoning(message: dict[str, Any]) -> str:
    """Reasoning that comes apart from the answer: in a field of its own, in details, or as parts of the content."""
    for name in ("reasoning_content", "reasoning", "thinking"):
        if told := _loose(message.get(name)):
            return told
    content = message.get("content")
    parts = [part for part in content if isinstance(part, dict)] if isinstance(content, list) else []
    thought = "".join(_loose(part) for part in parts if part.get("type") in THINKING)
    return thought or _loose(message.get("reasoning_details"))


def _loose(value: Any, depth: int = 0) -> str:
    """The text in a value of whatever form; what is none is passed over, for reasoning is not judged."""
    if isinstance(value, str):
        return value
    if isinstance(value, list) and depth < LOOSE_DEPTH:
        return "".join(_loose(part, depth + 1) for part in value)
    if isinstance(value, dict) and depth < LOOSE_DEPTH:
        return next((told for name in LOOSE if (told := _loose(value.get(name), depth + 1))), "")
    return ""


def _tools(message: dict[str, Any]) -> list[str]:
    calls = message.get("tool_calls") or ([message["function_call"]] if message.get("function_call") else [])
    if not isinstance(calls, list):
        raise _Strange("its tool_calls are no list")
    named = [call.get("function", call) if isinstance(call, dict) else {} for call in calls[:16]]
    return [str(call.get("name", "?"))[:80] if isinstance(call, dict) else "?" for call in named]


def _length(raw: Raw) -> int:
    return len(raw.content) + len(raw.reasoning)


def _oversized(caps: Caps) -> ChatError:
    return ChatError("oversized", f"more than {caps.text} characters of text, or {caps.line_bytes} bytes in a line")
