"""Endpoints that refuse fields, each in its own words, and one with a small context: acts for the chaos server."""

from __future__ import annotations

import json
import socket
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from chaos_server import Act, Asked, says, sends

Body = Mapping[str, Any]


def openai(message: str, param: str | None, code: str | None) -> dict[str, Any]:
    return {"error": {"message": message, "type": "invalid_request_error", "param": param, "code": code}}


def unsupported(name: str) -> dict[str, Any]:
    return openai(f"Unsupported parameter: '{name}' is not supported with this model.", name, "unsupported_parameter")


def passed_on(body: Body, company: str = "OpenAI") -> dict[str, Any]:
    """As OpenRouter hands on what the company said that serves the model."""
    metadata = {"raw": json.dumps(body), "provider_name": company}
    return {"error": {"message": "Provider returned error", "code": 400, "metadata": metadata}}


def vllm(message: str) -> dict[str, Any]:
    return {"object": "error", "message": message, "type": "BadRequestError", "param": None, "code": 400}


def vllm_new(message: str, param: str | None = None) -> dict[str, Any]:
    return {"error": {"message": message, "type": "BadRequestError", "param": param, "code": 400}}


def extra_forbidden(*place: str) -> dict[str, Any]:
    told = {"type": "extra_forbidden", "loc": ["body", *place], "msg": "Extra inputs are not permitted", "input": 1}
    return {"detail": [told]}


def llamacpp(message: str, code: int = 400, kind: str = "invalid_request_error") -> dict[str, Any]:
    return {"error": {"code": code, "message": message, "type": kind}}


def deepseek(message: str) -> dict[str, Any]:
    return openai(message, None, "invalid_request_error")


RENAME = "Unsupported parameter: 'max_tokens' is not supported with this model. Use 'max_completion_tokens' instead."
TEMPERATURE = (
    "Unsupported value: 'temperature' does not support 0.0 with this model. Only the default (1) value is supported."
)
VERIFIED = "Your organization must be verified to stream this model."
IMAGE_URL = (
    "Failed to deserialize the JSON body into the target type: messages[1]: unknown variant `image_url`, "
    "expected `text` at line 1 column 9"
)

REFUSALS: dict[str, dict[str, tuple[int, Body]]] = {
    "OpenAI": {
        "max_tokens": (400, openai(RENAME, "max_tokens", "unsupported_parameter")),
        "temperature": (400, openai(TEMPERATURE, "temperature", "unsupported_value")),
        "response_format": (
            400,
            openai("Invalid parameter: 'response_format' of type 'json_object' is not supported with this model.",
                   "response_format", None),
        ),
        "stream_options": (400, openai("Unknown parameter: 'stream_options'.", "stream_options", "unknown_parameter")),
        "stream": (400, openai(VERIFIED, "stream", "unsupported_value")),
        "seed": (400, openai("Unrecognized request argument supplied: seed", None, None)),
        "effort": (400, openai("Unrecognized request argument supplied: effort", None, None)),
        "system": (
            400,
            openai("Unsupported value: 'messages[0].role' does not support 'system' with this model.",
                   "messages[0].role", "unsupported_value"),
        ),
        "images": (400, openai("Invalid content type. image_url is only supported by certain models.",
                               "messages.[1].content.[1].type", None)),
    },
    "OpenRouter": {
        "max_tokens": (400, passed_on(openai(RENAME, "max_tokens", "unsupported_parameter"))),
        "temperature": (400, passed_on(unsupported("temperature"))),
        "response_format": (400, passed_on({"message": "response_format is not supported by this model"}, "Novita")),
        "stream_options": (400, passed_on({"detail": "stream_options: extra fields not permitted"}, "Chutes")),
        "stream": (400, passed_on(openai(VERIFIED, "stream", "unsupported_value"))),
        "seed": (400, passed_on({"error": "property 'seed' is unsupported"}, "Groq")),
        "effort": (400, passed_on(extra_forbidden("effort"), "Together")),
        "images": (404, {"error": {"message": "No endpoints found that support image input", "code": 404}}),
    },
    "vLLM": {
        "max_tokens": (400, extra_forbidden("max_tokens")),
        "temperature": (400, vllm("temperature must be non-negative, got 0.0.")),
        "response_format": (400, vllm_new("Guided decoding is not supported with this backend: json_object")),
        "stream_options": (400, extra_forbidden("stream_options")),
        "stream": (400, vllm_new("Streaming is not supported with this configuration", "stream")),
        "seed": (400, extra_forbidden("seed")),
        "effort": (422, extra_forbidden("effort")),
        "system": (400, vllm("System role not supported")),
        "images": (400, vllm_new("m is not a multimodal model")),
    },
    "llama.cpp": {
        "max_tokens": (400, llamacpp("Unsupported param: max_tokens")),
        "temperature": (400, llamacpp("Unsupported param: temperature")),
        "response_format": (400, llamacpp("Failed to parse grammar: response_format type must be one of text")),
        "stream_options": (400, llamacpp("Unsupported param: stream_options")),
        "stream": (400, llamacpp("Cannot use this with stream")),
        "seed": (400, llamacpp("Unsupported param: seed")),
        "effort": (400, llamacpp("Unsupported param: effort")),
        "images": (
            500,
            llamacpp("image input is not supported - hint: if this is unexpected, you may need to provide the mmproj",
                     500, "server_error"),
        ),
    },
    "DeepSeek": {
        "max_tokens": (400, deepseek("max_tokens is deprecated, use max_completion_tokens")),
        "temperature": (400, deepseek("deepseek-reasoner does not support the parameter `temperature`")),
        "response_format": (400, deepseek("This response_format type is unavailable now")),
        "stream_options": (400, deepseek("stream_options is invalid")),
        "stream": (400, deepseek("This model cannot be called with stream")),
        "seed": (422, deepseek("Failed to deserialize the JSON body into the target type: unknown field `seed`")),
        "effort": (422, deepseek("Failed to deserialize the JSON body: unknown field `effort`, expected one of ...")),
        "images": (400, deepseek(IMAGE_URL)),
    },
}
"""Endpoint -> field -> how it refuses that field."""

CONTEXT = 8192


def _openai_sum(prompt: int, asked: int) -> Body:
    message = (
        f"This model's maximum context length is {CONTEXT} tokens. However, you requested {prompt + asked} tokens "
        f"({prompt} in the messages, {asked} in the completion). Please reduce the length of either one."
    )
    return openai(message, "messages", "context_length_exceeded")


def _openrouter_sum(prompt: int, asked: int) -> Body:
    message = (
        f"This endpoint's maximum context length is {CONTEXT} tokens. However, you requested about {prompt + asked} "
        f"tokens ({prompt} of text input, {asked} in the output). Please reduce the length of either one."
    )
    return {"error": {"message": message, "code": 400, "metadata": {"provider_name": None}}}


def _vllm_left(prompt: int, asked: int) -> Body:
    message = (
        f"'max_tokens' or 'max_completion_tokens' is too large: {asked}. This model's maximum context length is "
        f"{CONTEXT} tokens and your request has {prompt} input tokens ({asked} > {CONTEXT} - {prompt})."
    )
    return vllm_new(message, "max_tokens")


def _vllm_at_least(prompt: int, asked: int) -> Body:
    message = (
        f"This model's maximum context length is {CONTEXT} tokens. However, you requested {asked} output tokens and "
        f"your prompt contains at least {max(1, CONTEXT - asked + 1)} input tokens, in all at least {CONTEXT + 1}."
    )
    return vllm_new(message, "input_tokens")


def _llamacpp_context(prompt: int, asked: int) -> Body:
    message = "the request exceeds the available context size, try increasing it"
    told = llamacpp(message, 400, "exceed_context_size_error")
    told["error"] |= {"n_prompt_tokens": prompt, "n_ctx": CONTEXT}
    return told


def _tgi_sum(prompt: int, asked: int) -> Body:
    message = (
        f"Input validation error: `inputs` tokens + `max_new_tokens` must be <= {CONTEXT}. "
        f"Given: {prompt} `inputs` tokens and {asked} `max_new_tokens`"
    )
    return {"error": message, "error_type": "validation"}


def _plus(prompt: int, asked: int) -> Body:
    message = f"input length and `max_tokens` exceed context limit: {prompt} + {asked} > {CONTEXT}, decrease either"
    return passed_on(openai(message, None, None), "Anthropic")


FULL = {
    "OpenAI": _openai_sum,
    "OpenRouter": _openrouter_sum,
    "vLLM": _vllm_left,
    "vLLM, at least": _vllm_at_least,
    "llama.cpp": _llamacpp_context,
    "TGI": _tgi_sum,
    "Anthropic": _plus,
}
"""Endpoint -> what it says of (prompt, answer asked for) that do not fit its context."""

BOUNDS: dict[str, Body] = {
    "OpenAI": openai("max_tokens is too large: 8192. This model supports at most 4096 completion tokens, whereas you "
                     "provided 8192.", "max_tokens", "invalid_value"),
    "DeepSeek": deepseek("Invalid max_tokens value, the valid range of max_tokens is [1, 4096]"),
    "Groq": openai("`max_tokens` must be less than or equal to `4096`, the maximum value for `max_tokens` is less than "
                   "the `context_window` for this model", "max_tokens", None),
    "Anthropic": openai("max_tokens: 8192 > 4096, which is the maximum allowed number of output tokens for claude-3",
                        None, None),
    "DashScope": openai("InternalError.Algo.InvalidParameter: Range of max_tokens should be [1, 4096]", None, None),
    "OpenRouter": passed_on(deepseek("Invalid max_tokens value, the valid range of max_tokens is [1, 4096]")),
    "another": {"message": "max_tokens may not exceed 4,096"},
}
"""Endpoint -> what it says of an answer longer than 4096 tokens."""


@dataclass
class Picky:
    """An endpoint that refuses some fields in the words of one endpoint, and answers otherwise.

    `prompt`: tokens that it counts in every prompt; its context is CONTEXT where `full` says what it then says.
    """

    words: str = "OpenAI"
    refused: tuple[str, ...] = ()
    full: str = ""
    prompt: int = 708
    longest: str = ""
    answer: Act = field(default_factory=lambda: says())

    def act(self, connection: socket.socket, asked: Asked) -> None:
        """Answer a request."""
        self.decide(asked.body)(connection, asked)

    def decide(self, body: dict[str, Any]) -> Act:
        """What the request comes to."""
        tokens = int(body.get("max_tokens", body.get("max_completion_tokens", 16)))
        for name in self.refused:
            if _holds(body, name):
                status, told = REFUSALS[self.words][name]
                return sends(json.dumps(told).encode(), status=status)
        prompt_alone = self.full == "llama.cpp"
        if self.full and self.prompt + (0 if prompt_alone else tokens) > CONTEXT:
            return sends(json.dumps(FULL[self.full](self.prompt, tokens)).encode(), status=400)
        if self.longest and tokens > 4096:
            return sends(json.dumps(BOUNDS[self.longest]).encode(), status=400)
        return self.answer


def _holds(body: dict[str, Any], name: str) -> bool:
    if name == "system":
        return any(message["role"] == "system" for message in body["messages"])
    if name == "images":
        return any(isinstance(message["content"], list) for message in body["messages"])
    return name in body
