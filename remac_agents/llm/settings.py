"""How one model is asked: every property that can be set where a model is named, `provider:model,option=value,...`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

from remac_agents.llm.providers import Endpoint
from remac_agents.text.options import check_number, join_options, read_value, split_options
from remac_env.errors import OptionError

LONGEST_S = 86_400.0
MOST_TOKENS = 100_000_000
DEAREST = 1e6
"""Bounds of the options: a day; tokens; US dollars per million tokens. More is a slip of the keyboard."""

NONE = "none"
EXTRA = "extra."
TOKEN_FIELDS = ("max_tokens", "max_completion_tokens", NONE)
FORMATS = ("json_object", "json_schema", NONE)

_SENT = (
    *("model", "messages", "max_tokens", "max_completion_tokens", "temperature", "seed", "response_format"),
    *("stream", "stream_options"),
)
"""Fields of a request that `extra.` cannot set: they have options of their own, or none."""


@dataclass(frozen=True, kw_only=True)
class ModelSettings:
    """Options of one model. None: what the provider's data say, unless told otherwise.

    Attributes:
        seconds: how long one question may take, all in all; a silent answer is waited for until then.
        max_tokens: the bound on an answer, reasoning included, that is asked for first.
        max_tokens_bound: the bound to which it is raised when an answer hits it.
        max_tokens_field: how the endpoint calls that bound; "none": it is not sent.
        temperature: 0..2; None: not sent, so that the model's own holds.
        seed: for endpoints that take one.
        stream: whether answers are asked for in pieces.
        stream_usage: whether stream_options.include_usage is sent.
        images: whether the model takes pictures.
        response_format: "json_object" or "json_schema" is sent where a role wants it; "none": never.
        context: tokens of prompt and answer together.
        price_in, price_out: US dollars per million tokens.
        base_url: where the server is.
        extra: further fields of the request's body.
    """

    seconds: float | None = None
    max_tokens: int | None = None
    max_tokens_bound: int | None = None
    max_tokens_field: str | None = None
    temperature: float | None = 0.0
    seed: int | None = None
    stream: bool | None = None
    stream_usage: bool | None = None
    images: bool | None = None
    response_format: str | None = None
    context: int | None = None
    price_in: float | None = None
    price_out: float | None = None
    base_url: str | None = None
    extra: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse values out of their range.

        Raises:
            OptionError: naming the option, the value and what is valid.
        """
        for name, (least, most, whole) in _NUMBERS.items():
            value = getattr(self, name)
            if value is not None:
                check_number(name, value, least, most, whole=whole, more=f", or {NONE}" * (name == "temperature"))
        for name in ("stream", "stream_usage", "images"):
            if not isinstance(getattr(self, name), bool | None):
                raise OptionError(f"{name} {getattr(self, name)!r} is not valid; valid: true or false")
        for name, valid in (("max_tokens_field", TOKEN_FIELDS), ("response_format", FORMATS)):
            if getattr(self, name) not in (None, *valid):
                raise OptionError(f"{name} {getattr(self, name)!r} is not valid; valid: {', '.join(valid)}")
        if self.base_url is not None and not isinstance(self.base_url, str):
            raise OptionError(f"base_url {self.base_url!r} is not valid; valid: http://host[:port]/path or https://...")
        _check_extra(self.extra)

    @property
    def key(self) -> str:
        """A text that is equal for equal settings."""
        return json.dumps(asdict(self), sort_keys=True)

    def applied(self, endpoint: Endpoint) -> Endpoint:
        """The endpoint with what these settings say of its model."""
        told = {name: getattr(self, name) for name in _OF_MODEL if getattr(self, name) is not None}
        if self.response_format is not None:
            told["response_format"] = () if self.response_format == NONE else (self.response_format,)
        if self.max_tokens_field == NONE:
            told["max_tokens_field"] = ""
        if self.stream is False:
            told["stream_only"] = False
        if {"price_in", "price_out"} & told.keys():
            told["priced_on"] = "given"
        if self.extra:
            told["extra"] = {**endpoint.model.extra, **self.extra}
        return replace(endpoint, model=replace(endpoint.model, **told))


_NUMBERS: dict[str, tuple[float, float, bool]] = {
    "seconds": (0.001, LONGEST_S, False),
    "max_tokens": (1, MOST_TOKENS, True),
    "max_tokens_bound": (1, MOST_TOKENS, True),
    "temperature": (0, 2, False),
    "seed": (0, 2**63 - 1, True),
    "context": (1, MOST_TOKENS, True),
    "price_in": (0, DEAREST, False),
    "price_out": (0, DEAREST, False),
}
"""Option -> least, most, whether whole."""

_OF_MODEL = (
    *("seconds", "max_tokens", "max_tokens_bound", "max_tokens_field", "stream", "stream_usage", "images", "context"),
    *("price_in", "price_out"),
)
"""Options that are fields of `providers.Model` too."""


def read_model_name(text: str) -> tuple[str, ModelSettings]:
    """The name and the settings of `provider:model,option=value,...`.

    Raises:
        OptionError: for an option that does not exist, or a value out of its range.
    """
    name, options = split_options(text, commas=False)
    return name, read_settings(options)


def plain_model_name(text: str) -> str:
    """The same text for the same name and options, in whatever order and with whatever spaces they were written.

    Raises:
        OptionError: see `read_model_name`.
    """
    name, options = split_options(text, commas=False)
    read_settings(options)
    return join_options(name, options)


def read_settings(given: Mapping[str, Any]) -> ModelSettings:
    """Settings from option -> value, a text as on the command line or a Python value.

    Raises:
        OptionError: for an option that does not exist, or a value out of its range.
    """
    extra: dict[str, Any] = {}
    told: dict[str, Any] = {}
    valid = [f.name for f in fields(ModelSettings) if f.name != "extra"]
    for option, value in given.items():
        read = _value(option, value)
        if option.startswith(EXTRA):
            _nest(extra, option, read)
        elif option == "extra" and isinstance(value, Mapping):
            for name, each in value.items():
                _nest(extra, f"{EXTRA}{name}", each)
        elif option in valid:
            told[option] = read
        else:
            listed = ", ".join([*valid, f"{EXTRA}NAME"])
            raise OptionError(f"unknown option {option!r} of a model; valid: {listed}")
    return ModelSettings(**told, extra=extra)


def check_bounds(*, max_tokens: object, temperature: object, deadline: object) -> None:
    """Refuse invalid bounds of a call.

    Raises:
        OptionError: naming the bound and what is valid.
    """
    if max_tokens is not None:
        check_number("max_tokens", max_tokens, 1, MOST_TOKENS, whole=True)
    if temperature is not None:
        check_number("temperature", temperature, 0, 2, more=", or None")
    check_number("deadline", deadline, 1e-6, LONGEST_S, more=" seconds")


def _value(option: str, value: Any) -> Any:
    if not isinstance(value, str) or option in ("base_url", "max_tokens_field", "response_format"):
        return value
    if value.casefold() == NONE and not option.startswith(EXTRA):
        return None
    if value.casefold() in ("true", "false"):
        return value.casefold() == "true"
    return read_value(value)


def _nest(extra: dict[str, Any], option: str, value: Any) -> None:
    """Put a value at the place that a name with dots says."""
    names = option.removeprefix(EXTRA).split(".")
    place = extra
    for name in names[:-1]:
        inner = place.setdefault(name, {})
        if not isinstance(inner, dict):
            raise OptionError(f"{option}: {name!r} is given a value and fields of its own; valid: one of them")
        place = inner
    if not all(names) or names[-1] in place:
        raise OptionError(f"{option} is not valid; valid: {EXTRA}NAME or {EXTRA}NAME.FIELD, each once")
    place[names[-1]] = value


def _check_extra(extra: object) -> None:
    if not isinstance(extra, Mapping):
        raise OptionError(f"extra {extra!r} is not valid; valid: {EXTRA}NAME=VALUE, or a mapping")
    for name in extra:
        if name in _SENT:
            raise OptionError(f"{EXTRA}{name} is not valid: the request has that field; valid: its own option, if any")
    try:
        json.dumps(dict(extra), allow_nan=False)
    except (TypeError, ValueError) as error:
        raise OptionError(f"extra {extra!r} is not valid: {error}; valid: values of JSON") from None
