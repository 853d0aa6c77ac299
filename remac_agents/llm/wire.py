"""The protocol's answers, read with suspicion: one JSON body, or server-sent events that arrive in any pieces."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from remac_agents.llm.outcomes import ChatError

EXCERPT = 500
"""Characters of a strange answer that go into an error's detail."""


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
    """An answer as it came, not judged yet."""

    content: str = ""
    reasoning: str = ""
    finish: str | None = None
    refused: bool = False
    tools: list[str] = field(default_factory=list)
    usage: Any = None
    model: str = ""
    response_id: str = ""
    fingerprint: str = ""


class _Strange(ValueError):
    """An answer that is not what the protocol says."""


def read_body(data: bytes, caps: Caps) -> Raw | ChatError:
    """An answer in one piece."""
    try:
        body = _json(data)
        raw = Raw()
        _note_origin(raw, body)
        choice = _choice(body.get("choices"))
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
        self._done = False

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
        return self._raw

    def _lines(self, data: bytes) -> Iterator[bytes]:
        """Whole lines; \\r\\n, \\n and \\r end one. A \\r at the very end may be half of a \\r\\n and waits."""
        self._pending += data
        held = b"\r" if self._pending.endswith(b"\r") else b""
        text = self._pending[: len(self._pending) - len(held)].replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        *lines, rest = text.split(b"\n")
        self._pending = rest + held
        yield from lines

    def _event(self, event: bytes) -> ChatError | None:
        chunk = _json(event)
        if chunk.get("error"):
            return ChatError("server_error", f"in the stream: {error_text(event)}")
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
    """The message of an error body, or its beginning."""
    try:
        error = _json(data).get("error")
    except _Strange:
        error = None
    if isinstance(error, dict):
        told = [str(error[name]) for name in ("message", "code", "type") if error.get(name)]
        return "; ".join(told)[: 2 * EXCERPT]
    return data[: 2 * EXCERPT].decode("utf-8", "replace") if error is None else str(error)[: 2 * EXCERPT]


def _json(data: bytes) -> dict[str, Any]:
    try:
        value = json.loads(data)
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
    raw.reasoning += _text(message.get("reasoning_content")) or _text(message.get("reasoning"))
    raw.refused |= bool(message.get("refusal"))
    raw.tools += _tools(message)
    finish = choice.get("finish_reason")
    if finish is not None and not isinstance(finish, str):
        raise _Strange("its finish_reason is no text")
    raw.finish = raw.finish or finish


def _text(value: Any) -> str:
    """Text given as such, or as a list of parts."""
    if value is None:
        return ""
    if isinstance(value, list) and all(isinstance(part, dict) for part in value):
        return "".join(_text(part.get("text")) for part in value)
    if not isinstance(value, str):
        raise _Strange("its content is no text")
    return value


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
