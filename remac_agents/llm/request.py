"""A request to a language model: what is sent, and the canonical form by which a cassette knows it again."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from remac_agents.llm.providers import Endpoint
from remac_env.errors import OptionError
from remac_env.simulator import load_opencv

ROLES = ("system", "user", "assistant")
CHARACTERS_PER_TOKEN = 3.0
"""For estimates on the safe side: English has about four, code and names about three."""

TOKENS_PER_PICTURE = 1500
"""For estimates: a 512 x 512 picture costs 255 to about 1100 tokens at the listed providers."""


@dataclass(frozen=True)
class Picture:
    """An image to be shown to a model.

    Attributes:
        png: the encoded picture.
        digest: of the pixels, not of the encoding, so that another encoder finds the same cassette.
    """

    png: bytes = field(repr=False)
    digest: str

    @classmethod
    def of(cls, pixels: Any) -> Picture:
        """From pixels, shape (height, width, 3), RGB, uint8.

        Raises:
            OptionError: for another shape or type.
        """
        shape, kind = getattr(pixels, "shape", None), str(getattr(pixels, "dtype", None))
        if shape is None or len(shape) != 3 or shape[2] != 3 or kind != "uint8":
            raise OptionError(f"a picture of shape {shape} and type {kind} is not valid; valid: (h, w, 3), uint8")
        cv2 = load_opencv()  # only here: most calls send no picture
        _, encoded = cv2.imencode(".png", pixels[:, :, ::-1])
        return cls(encoded.tobytes(), hashlib.sha256(repr(shape).encode() + pixels.tobytes()).hexdigest())

    @property
    def url(self) -> str:
        """The picture as a data: address."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode()


@dataclass(frozen=True)
class ChatRequest:
    """Everything that one call sends, but for the key.

    Attributes:
        messages: (role, text) in order.
        images: shown with the last message of the user.
        response_format: as the protocol has it, {"type": "json_object"} or {"type": "json_schema", ...}.
        versions: what else an answer hangs on (the prompts' and the kitchen's versions); part of the key only.
        label: which question of which episode this is, so that equal prompts of several episodes are apart; part of
            the key only.
        stream: whether the answer is asked for in pieces; no part of the key.
    """

    endpoint: Endpoint
    messages: tuple[tuple[str, str], ...]
    images: tuple[Picture, ...] = ()
    response_format: Mapping[str, Any] | None = None
    max_tokens: int = 1024
    temperature: float | None = 0.0
    seed: int | None = None
    versions: Mapping[str, str] = field(default_factory=dict)
    label: str = ""
    stream: bool = False

    def canonical(self) -> dict[str, Any]:
        """The request as a value that is equal for equal requests. How it is sent (streamed or not) is no part."""
        return {
            "base_url": self.endpoint.base_url,
            "model": self.endpoint.name,
            "messages": [list(message) for message in self.messages],
            "images": [picture.digest for picture in self.images],
            "response_format": self.response_format,
            "max_tokens": self.max_tokens,
            "temperature": self.temperature,
            "seed": self.seed,
            "versions": dict(self.versions),
            "label": self.label,
            **({"extra": dict(self.endpoint.model.extra)} if self.endpoint.model.extra else {}),
        }

    @property
    def asks_for_form(self) -> bool:
        """Whether a response_format is sent: one is wanted, and the model offers its type."""
        return self.response_format is not None and self.response_format.get("type") in (
            self.endpoint.model.response_format
        )

    def body(self) -> dict[str, Any]:
        """The JSON to send: only what the model takes."""
        model = self.endpoint.model
        body: dict[str, Any] = {
            **model.extra,
            "model": model.name,
            "messages": self._messages(),
            **({model.max_tokens_field: self.max_tokens} if model.max_tokens_field else {}),
        }
        if self.temperature is not None and model.temperature:
            body["temperature"] = self.temperature
        if self.seed is not None:
            body["seed"] = self.seed
        if self.response_format is not None and self.asks_for_form:
            body["response_format"] = dict(self.response_format)
        if self.stream:
            body["stream"] = True
            if model.stream_usage:
                body["stream_options"] = {"include_usage": True}
        return body

    def _messages(self) -> list[dict[str, Any]]:
        sent: list[dict[str, Any]] = [{"role": role, "content": text} for role, text in self.messages]
        if self.images:
            last = max(index for index, (role, _) in enumerate(self.messages) if role == "user")
            shown = [{"type": "image_url", "image_url": {"url": picture.url}} for picture in self.images]
            sent[last]["content"] = [{"type": "text", "text": sent[last]["content"]}, *shown]
        return sent

    def tokens_estimated(self) -> int:
        """About how many tokens the prompt has; rather too many."""
        characters = sum(len(text) for _, text in self.messages)
        return int(characters / CHARACTERS_PER_TOKEN) + 8 * len(self.messages) + TOKENS_PER_PICTURE * len(self.images)


def digest(canonical: Mapping[str, Any]) -> str:
    """The key of a canonical request, 64 hexadecimal digits."""
    text = json.dumps(canonical, sort_keys=True, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def read_messages(messages: Sequence[Mapping[str, str]], *, images: bool) -> tuple[tuple[str, str], ...]:
    """Messages given as {"role": ..., "content": ...}, checked.

    Raises:
        OptionError: for another form, an unknown role, or pictures without a message of the user.
    """
    read: list[tuple[str, str]] = []
    for message in messages:
        role, text = message.get("role"), message.get("content")
        if role not in ROLES or not isinstance(text, str):
            raise OptionError(f"message {message!r:.80} is not valid; valid: role of {', '.join(ROLES)}, content: text")
        # Half a surrogate pair is no text: it cannot be sent, and would be an error in the middle of a call.
        read.append((role, text.encode("utf-8", "replace").decode("utf-8")))
    if not read or (images and all(role != "user" for role, _ in read)):
        raise OptionError("messages hold no message" + (" of the user to show pictures with" if read else ""))
    return tuple(read)
