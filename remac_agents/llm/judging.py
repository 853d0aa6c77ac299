"""What an endpoint's answer comes to: a whole reply, or which kind of error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from remac_agents.llm.message import Raw
from remac_agents.llm.outcomes import ChatError, ChatReply
from remac_agents.llm.request import ChatRequest
from remac_agents.text.thoughts import split_reasoning

MOST_TOKENS = 100_000_000
"""A larger count of tokens is not credible."""

MOST_MONEY = 10_000.0
"""Nor is a request that cost more US dollars."""


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


STOPS = _words(
    "stop eos eos_token end end_turn end_of_turn eot eot_id im_end endoftext end_of_text end_of_sequence stop_sequence "
    "stop_string stop_token stop_word complete completed completion finish finished done natural normal success"
)
LENGTHS = _words(
    "length max_tokens max_output_tokens max_completion_tokens max_new_tokens max_length max_tokens_reached "
    "token_limit length_limit length_capped output_limit limit truncated context_length "
    "context_window_exceeded model_length model_context_window_exceeded model_context_length"
)
FILTERED = _words(
    "content_filter content_filtered content_policy filtered filter safety blocked blocklist refusal refused "
    "moderation flagged sensitive guardrail_intervened recitation prohibited_content spii"
)
TOOLS = _words("tool_calls tool_call tool_use function_call function_calls")
"""How endpoints say that an answer came to its own end, hit its bound, was withheld, or calls a tool."""


def judge(raw: Raw, request: ChatRequest) -> ChatReply | ChatError:
    """A reply only if the answer is whole, is text, and came to its own end."""
    tokens_in, tokens_out = tokens(raw.usage)
    money = cost(raw.usage)
    if money is None:
        money = request.endpoint.model.money(tokens_in, tokens_out)
    text, thoughts = split_reasoning(raw.content)
    finish = ending(raw.finish)
    kind, detail = _fault(raw, finish, text)
    if kind:
        return ChatError(kind, detail, 200, tokens_in=tokens_in, tokens_out=tokens_out, money=money)
    reasoning = "\n".join(part for part in (raw.reasoning.strip(), thoughts) if part)
    return ChatReply(
        text=text,
        reasoning=reasoning,
        tokens_in=tokens_in,
        tokens_out=tokens_out,
        money=money,
        finish_reason=(raw.finish or "").casefold(),
        model=raw.model,
        response_id=raw.response_id,
        fingerprint=raw.fingerprint,
        flags=_flags(raw, request, tokens_in, tokens_out),
    )


def _fault(raw: Raw, finish: str, text: str) -> tuple[str, str]:
    if raw.tools or finish in TOOLS:
        return "tool_call", f"finish_reason {finish or None!r}, calls: {', '.join(raw.tools) or 'none'}"
    if finish in LENGTHS:
        return "cut_short", f"after {len(raw.content)} characters of answer"
    if raw.refused or finish in FILTERED:
        return "filtered", f"finish_reason {finish or None!r}"
    whole = not finish and raw.done and text  # nothing was said of the ending, but the stream came to its end
    if finish not in STOPS and not whole:
        return "unfinished", f"finish_reason {raw.finish!r}"
    if not text:
        return "empty", "reasoning only" if raw.reasoning.strip() or raw.content.strip() else "no text"
    return "", ""


def ending(finish: str | None) -> str:
    """A finish_reason without what differs between endpoints: case, dashes and prefixes."""
    word = (finish or "").strip().casefold().replace("-", "_").replace(" ", "_")
    return word.removeprefix("finish_reason_").strip("_<|>")


def tokens(usage: Any) -> tuple[int | None, int | None]:
    """Tokens in and out as an endpoint says; (None, None) unless both are credible."""
    if not isinstance(usage, dict):
        return None, None
    counts = (usage.get("prompt_tokens"), usage.get("completion_tokens"))
    if all(type(count) is int and 0 <= count <= MOST_TOKENS for count in counts):
        return counts  # type: ignore[return-value]
    return None, None


def cost(usage: Any) -> float | None:
    """US dollars that a request did cost, as an endpoint says; None where it does not, or not credibly.

    `usage.cost` is a sum (OpenRouter, LiteLLM) or a table with a total (Perplexity); elsewhere a total stands beside
    it. OpenRouter's sum leaves out what went to an account of the user's own, which `cost_details` then tells.
    """
    if not isinstance(usage, Mapping):
        return None
    details = usage.get("cost_details")
    upstream = _dollars(details.get("upstream_inference_cost")) if isinstance(details, Mapping) else None
    told = usage.get("cost")
    tables = [table for table in (told, usage, details) if isinstance(table, Mapping)]
    sums = [_dollars(told), *(_dollars(table.get("total_cost")) for table in tables)]
    known = next((value for value in sums if value is not None), None)
    if known is None or upstream is None:
        return upstream if known is None else known
    own_key = usage.get("is_byok", upstream > known)
    return known + upstream if own_key is True else known


def _dollars(value: Any) -> float | None:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if number and 0 <= value <= MOST_MONEY else None  # no NaN is, and no infinity


def _flags(raw: Raw, request: ChatRequest, tokens_in: int | None, tokens_out: int | None) -> tuple[str, ...]:
    flags: list[str] = []
    wanted = request.response_format
    if tokens_in is None:
        flags.append("usage_unknown")
    if tokens_out is not None and tokens_out >= request.max_tokens:
        flags.append("at_token_limit")
    if not ending(raw.finish):
        flags.append("ending_unknown")
    if raw.model and request.endpoint.model.name.split("/")[-1].casefold() not in raw.model.casefold():
        flags.append("other_model")
    if wanted is not None and wanted.get("type") not in request.endpoint.model.response_format:
        flags.append("response_format_not_offered")
    return tuple(flags)
