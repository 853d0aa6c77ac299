"""The message of a choice, whole or a piece of a streamed one: answer, reasoning, tools, and how it ended."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

THINKING = ("thinking", "reasoning", "reasoning_text", "thought", "redacted_thinking")
"""Types of parts of a content that are no answer."""

LOOSE = ("text", "thinking", "reasoning", "summary", "content")
LOOSE_DEPTH = 4
"""Where the text of reasoning stands in an object, and how deep objects may be nested."""


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


class StrangeError(ValueError):
    """An answer that is not what the protocol says."""


def first_choice(choices: Any) -> dict[str, Any] | None:
    """The first choice with index 0 (one was asked for); None if there is none, as in a chunk with usage only."""
    if choices is None:
        return None
    if not isinstance(choices, list) or not all(isinstance(choice, dict) for choice in choices):
        raise StrangeError("its choices are no list of objects")
    return next((choice for choice in choices if choice.get("index") in (0, None)), None)


def message_of(choice: dict[str, Any]) -> Any:
    """What a choice says: a piece, the whole (which some servers stream in one) or bare text; None: nothing."""
    for name in ("delta", "message"):
        if choice.get(name):
            return choice[name]
    return {"content": choice["text"]} if choice.get("text") is not None else choice.get("message")


def add(raw: Raw, choice: dict[str, Any], message: Any) -> None:
    """Take in what a choice says."""
    if message is None:
        message = {}
    if not isinstance(message, dict):
        raise StrangeError("its message is no object")
    raw.content += _text(message.get("content"))
    raw.reasoning += _reasoning(message)
    content = message.get("content")
    parts = content if isinstance(content, list) else []
    raw.refused |= any(part.get("refusal") for part in (message, *parts))
    raw.tools += _tools(message)
    finish = choice.get("finish_reason")
    if isinstance(finish, dict):
        finish = finish.get("type")  # SGLang's own form
    if finish is not None and not isinstance(finish, str):
        raise StrangeError("its finish_reason is no text")
    raw.finish = raw.finish or finish


def _text(value: Any) -> str:
    """Text given as such, or as a list of parts."""
    if value is None:
        return ""
    if isinstance(value, list) and all(isinstance(part, dict) for part in value):
        if value and not any({"text", "refusal"} & part.keys() or part.get("type") in THINKING for part in value):
            raise StrangeError("its content has no part of a known form")
        return "".join(_text(part.get("text")) for part in value if part.get("type") not in THINKING)
    if not isinstance(value, str):
        raise StrangeError("its content is no text")
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
        raise StrangeError("its tool_calls are no list")
    named = [call.get("function", call) if isinstance(call, dict) else {} for call in calls[:16]]
    return [str(call.get("name", "?"))[:80] if isinstance(call, dict) else "?" for call in named]
