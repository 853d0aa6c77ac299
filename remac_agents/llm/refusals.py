"""What a refused request means: which kind of error a status and its message are."""

from __future__ import annotations

from remac_agents.llm.outcomes import ChatError

TOO_LONG = (
    *("context_length", "context length", "context window", "context size", "maximum context", "max_model_len"),
    *("context limit", "prompt is too long", "input is too long", "prompt too long", "too many tokens", "n_ctx"),
    *("exceed_context", "input length", "input token count", "maximum prompt length", "maximum number of tokens"),
    *("token limit", "got -", "inputs` tokens"),
)
_NO_MODEL = ("model_not_found", "model not found", "unknown model", "no such model")
_NO_MONEY = ("insufficient_quota", "exceeded your current quota", "billing", "insufficient balance", "credit balance")


def refusal(status: int, detail: str, retry_after: float | None) -> ChatError:
    """What an HTTP status other than 200 means. Only what may succeed later is of a kind that is retried."""
    text = detail.casefold()
    error = ChatError(_kind(status, text), detail, status)
    if error.kind in ("rate_limited", "server_error") and retry_after is not None:
        return ChatError(error.kind, detail, status, retry_after)
    return error


def _kind(status: int, text: str) -> str:
    if status == 402 or (status == 429 and any(word in text for word in _NO_MONEY)):
        return "quota"
    if status == 429:
        return "rate_limited"
    if status in (401, 403):
        return "unauthorised"
    if status == 404 or (status == 400 and any(word in text for word in _NO_MODEL)):
        return "unknown_model"
    if status == 413 or (status in (400, 422, 500) and any(word in text for word in TOO_LONG)):
        return "context_too_long"
    if status in (408, 409, 425) or (status >= 500 and status not in (501, 505)):
        return "server_error"
    return "redirected" if 300 <= status < 400 else "bad_request"
