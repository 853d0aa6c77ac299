"""What a refused request means: which kind of error a status and its message are."""

from __future__ import annotations

import re

from remac_agents.llm.outcomes import ChatError

_CONTEXT = re.compile(r"context[_ ](?:length|window|size|limit)|maximum context|max_model_len|n_ctx|exceed_context")
_TOO_LONG = re.compile(
    r"maximum (?:model length|prompt length|number of tokens)|too many tokens|token limit|input length|got -\d"
    r"|inputs?`? tokens \+|inputs`? must have|input token count|max_seq_len|max_num_tokens|request too large"
    r"|exceed\w* [^.;]{0,20}\blimit of \d"
    r"|(?:prompt|input|messages?)\b[^.;]{0,60}?(?:exceed|too long|too large|(?:longer|greater|larger) than)"
)
_NO_MODEL = re.compile(
    r"model_not_found|(?:unknown|no such|invalid) model|model\b.{0,80}?(?:not found|does not exist|decommissioned)"
    r"|not a valid model"
)
_NO_KEY = re.compile(r"api[ _-]?key.{0,20}(?:invalid|not valid|incorrect)|(?:invalid|incorrect) api[ _-]?key")
_NO_MONEY = (
    *("insufficient_quota", "exceeded your current quota", "billing", "insufficient balance", "credit balance"),
    "insufficient credit",
)
_NEVER = "request too large"
"""So limits on tokens a minute are told where waiting cannot help: the request alone is beyond them."""
_CUT = "model output limit was reached"


def refusal(status: int, detail: str, retry_after: float | None) -> ChatError:
    """What an HTTP status other than 200 means. Only what may succeed later is of a kind that is retried."""
    text = detail.casefold()
    error = ChatError(_kind(status, text), detail, status)
    if error.kind in ("rate_limited", "server_error") and retry_after is not None:
        return ChatError(error.kind, detail, status, retry_after)
    return error


def is_too_long(text: str) -> bool:
    """Whether a text, in small letters, is about a prompt that is too long, alone or with the answer asked for."""
    return _CONTEXT.search(text) is not None or _TOO_LONG.search(text) is not None


def _kind(status: int, text: str) -> str:
    if status == 402 or (status in (400, 403, 429) and any(word in text for word in _NO_MONEY)):
        return "quota"
    if status == 400 and _CUT in text:
        return "cut_short"
    if status == 429 and _NEVER not in text:
        return "rate_limited"
    if status in (401, 403) or (status == 400 and _NO_KEY.search(text)):
        return "unauthorised"
    if status == 404 or (status == 400 and _NO_MODEL.search(text)):
        return "unknown_model"
    too_long = (status in (400, 422) and is_too_long(text)) or (status == 500 and _CONTEXT.search(text))
    if status in (413, 429) or too_long:
        return "context_too_long"
    if status in (408, 409, 425) or (status >= 500 and status not in (501, 505)):
        return "server_error"
    return "redirected" if 300 <= status < 400 else "bad_request"
