"""The protocol's answers, read with suspicion: one JSON body, or server-sent events that arrive in any pieces."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from remac_agents.llm.message import Raw, StrangeError, add, first_choice, message_of
from remac_agents.llm.outcomes import ChatError
from remac_agents.llm.refusals import refusal

EXCERPT = 500
"""Characters of a strange answer that go into an error's detail."""


BOM = b"\xef\xbb\xbf"
"""The mark that some programs put before UTF-8."""

UNDRESSED = ("message", "detail", "errors")
"""Where an answer without choices may tell of an error besides `error`."""

IN_STREAM = "in the stream: "
"""Stands before an error that came in a stream."""

FIELDS = (b"data", b"event", b"id", b"retry", b"error", b"")
"""Names of lines of a stream; without one it is a comment. `error` is llama.cpp's own."""


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


def read_body(data: bytes, caps: Caps) -> Raw | ChatError:
    """An answer in one piece."""
    try:
        body = _json(data)
        raw = Raw()
        _note_origin(raw, body)
        choice = first_choice(body.get("choices"))
        if choice is not None and choice.get("error"):
            return _error_inside(choice, "in the answer: ")
        message = None if choice is None else message_of(choice)
        if choice is not None and message is not None:
            add(raw, choice, message)
        if not raw.content and (body.get("error") or any(body.get(name) for name in UNDRESSED)):
            return _error_inside(body, "in the answer: ")
        if message is None:
            raise StrangeError("it holds no choice with a message")
    except StrangeError as error:
        return ChatError("malformed", f"{error}: {data[:EXCERPT].decode('utf-8', 'replace')}")
    return raw if _length(raw) <= caps.text else _oversized(caps)


def are_events(beginning: bytes, kind: str) -> bool:
    """Whether an answer that begins so is a stream of events; where that does not say, its content type does."""
    start = beginning.lstrip().removeprefix(BOM).lstrip()
    if start.startswith((b"{", b"[")):
        return False
    named = re.match(rb"(?:data|event|id|retry)?:", start)
    return named is not None or "text/event-stream" in kind.casefold()


class StreamReader:
    """Server-sent events -> an answer. `feed` it bytes until it returns True or an error; then `result`."""

    def __init__(self, caps: Caps) -> None:
        self._caps = caps
        self._raw = Raw()
        self._pending = b""
        self._data: list[bytes] = []
        self._texts: dict[str, list[str]] = {"content": [], "reasoning": []}
        self._length = 0
        self._done = self._begun = self._failed = False

    def feed(self, data: bytes) -> bool | ChatError:
        """Read on. True: the terminator came."""
        try:
            for line in self._lines(data):
                if line:
                    self._field(*line.partition(b":")[::2])
                    continue
                event, self._data = b"\n".join(self._data), []
                if event.strip() == b"[DONE]":
                    self._done = True
                    return True
                error = self._event(event) if event.strip() else None
                if error is not None:
                    return error
        except StrangeError as strange:
            return ChatError("malformed", str(strange))
        size = len(self._pending) + sum(len(part) for part in self._data)
        if size > self._caps.line_bytes or self._length > self._caps.text:
            return _oversized(self._caps)
        return False

    def result(self, *, arrived: bool = False) -> Raw | ChatError:
        """The answer, once nothing more comes.

        Args:
            arrived: whether the transfer says itself that all of it came. If not, there is no answer without the
                terminator, however whole it looks.
        """
        fault = False if self._done else self.feed(b"\n\n")  # a last line may lack its end
        if isinstance(fault, ChatError) and fault.kind != "malformed":
            return fault  # it told of one; what is no event is a piece of one
        if not self._done and not (arrived and self._raw.finish):
            return ChatError("truncated", "the stream ended before [DONE] (stream=false asks for it in one piece)")
        self._raw.content = "".join(self._texts["content"])
        self._raw.reasoning = "".join(self._texts["reasoning"])
        self._raw.done = True
        return self._raw

    def _field(self, name: bytes, value: bytes) -> None:
        """One line of an event. What is not named as one may be a piece of the answer that came damaged."""
        if name not in FIELDS and not (name.isalpha() and name.isascii()):
            raise StrangeError(f"a line of the stream begins with {name[:40]!r}")
        if name in (b"data", b"error"):
            self._data.append(value.removeprefix(b" "))
        self._failed |= name == b"error" or (name == b"event" and value.strip() == b"error")

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
        if self._failed:
            return _error_inside(_told(event), IN_STREAM)
        chunk = _json(event)
        choice = first_choice(chunk.get("choices"))
        for holder in (chunk, choice or {}):
            if holder.get("error"):
                return _error_inside(holder, IN_STREAM)
        _note_origin(self._raw, chunk)
        if choice is not None:
            piece = Raw(finish=self._raw.finish)
            # A whole message after its pieces only says them again.
            add(piece, choice, choice.get("delta") if self._length else message_of(choice))
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
    except StrangeError:
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
    return ("; ".join(told) or data.decode("utf-8", "replace"))[: 2 * EXCERPT]


def _error_inside(body: dict[str, Any], where: str) -> ChatError:
    """An error under status 200: a refusal where it names the status of one, else a failure of the endpoint, which may
    have cost something."""
    error = body.get("error") or body
    codes = [error.get(name) for name in ("code", "status")] if isinstance(error, dict) else []
    status = next((int(code) for code in map(str, codes) if re.fullmatch("4[0-9][0-9]", code)), None)
    told = where + error_text(json.dumps(body if "error" in body else {"error": error}).encode())
    if status is None and re.search(r"invalid_request|unsupported|context_length|badrequest", told, re.IGNORECASE):
        status = 400  # a request that was refused, by an endpoint that had begun to answer it
    return ChatError("server_error", told) if status is None else refusal(status, told, None)


def _told(event: bytes) -> dict[str, Any]:
    """What an event tells of an error, in whatever form."""
    try:
        return _json(event)
    except StrangeError:
        return {"error": event.decode("utf-8", "replace")}


def _json(data: bytes) -> dict[str, Any]:
    try:
        value = json.loads(data.removeprefix(BOM))
    except (ValueError, RecursionError) as error:
        raise StrangeError(f"no JSON ({type(error).__name__})") from None
    if isinstance(value, list) and len(value) == 1 and isinstance(value[0], dict) and "error" in value[0]:
        value = value[0]  # Google's way to tell of an error
    if not isinstance(value, dict):
        raise StrangeError("no JSON object")
    return value


def _note_origin(raw: Raw, body: dict[str, Any]) -> None:
    for name, key in (("model", "model"), ("response_id", "id"), ("fingerprint", "system_fingerprint")):
        value = body.get(key)
        if isinstance(value, str) and value:
            setattr(raw, name, value[:200])
    if body.get("usage") is not None:
        raw.usage = body["usage"]


def _length(raw: Raw) -> int:
    return len(raw.content) + len(raw.reasoning)


def _oversized(caps: Caps) -> ChatError:
    return ChatError("oversized", f"more than {caps.text} characters of text, or {caps.line_bytes} bytes in a line")
