"""Files of providers: the one that is built in, and one of one's own that adds to it or overrides it field by field."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from functools import lru_cache
from pathlib import Path
from typing import Any

from remac_agents.llm.providers import Catalogue, Model, Provider
from remac_agents.text.printable import PATH, quoted, words
from remac_env.errors import OptionError
from remac_env.files import read_text

FILE = Path(__file__).with_name("providers.toml")

TOP = ("version", "paper", "providers")
VERSION = 1
FORMATS = ("json_object", "json_schema")

MOST_TOKENS = 100_000_000
"""A context or an answer with more tokens is a slip of the keyboard."""

MOST_SECONDS = 86_400.0
"""A day: the longest that a call may be given."""

MOST_PRICE = 1_000_000.0
"""US dollars per million tokens: a dollar a token."""


def read_catalogue(file: Path | str | None = None) -> Catalogue:
    """The providers that are built in, with those of a file over them.

    Raises:
        OptionError: naming file, provider and key of what is wrong in it.
    """
    if file is not None and not isinstance(file, str | Path):
        raise OptionError(f"providers {quoted(file)} is not valid; valid: a path, or None")
    return _catalogue(_text(FILE), "" if file is None else _text(file), str(FILE if file is None else file))


def digest(file: Path | str) -> str:
    """Twelve hexadecimal digits of a file of providers, for records.

    Raises:
        OptionError: if it cannot be read.
    """
    return hashlib.sha256(_text(file).encode()).hexdigest()[:12]


def _text(file: Path | str) -> str:
    try:
        return read_text(file)
    except (OSError, ValueError) as error:
        told = f"providers {quoted(str(file), PATH)} cannot be read: {words(error)[:200]}"
        raise OptionError(f"{told}; valid: a path of a file of providers") from error


@lru_cache(maxsize=16)
def _catalogue(base: str, own: str, file: str) -> Catalogue:
    """By the texts, not by the file's name: a file that was changed is read again."""
    data: dict[str, Any] = tomllib.loads(base)
    if own:
        data = _merged(data, _tables(own, file))
    _check_keys(file, "", data, TOP)
    if data.get("version", VERSION) != VERSION:
        raise OptionError(f"{file}: version {data['version']!r} is not valid; valid: {VERSION}")
    providers = {
        name: _provider(file, name, _table(file, f"provider {name}", entry))
        for name, entry in _table(file, "providers", data.get("providers", {})).items()
    }
    paper = {
        name: _routes(file, name, given, providers)
        for name, given in _table(file, "paper", data.get("paper", {})).items()
    }
    return Catalogue(providers, paper)


def _tables(text: str, file: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except ValueError as error:
        raise OptionError(f"{file}: {error}") from error


def _merged(under: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Tables field by field; anything else is replaced."""
    merged = dict(under)
    for key, value in over.items():
        both = isinstance(value, Mapping) and isinstance(merged.get(key), Mapping)
        merged[key] = _merged(merged[key], value) if both else value
    return merged


def _provider(file: str, name: str, entry: dict[str, Any]) -> Provider:
    models = _table(file, f"provider {name}: models", entry.pop("models", {}))
    own = {field.name for field in fields(Provider)} - {"name", "default", "models"}
    shared = {key: value for key, value in entry.items() if key not in own}
    missing = {"title", "base_url", "key"} - set(entry)
    if missing:
        raise OptionError(f"{file}: provider {name}: {', '.join(sorted(missing))} missing")
    for key in own & set(entry):
        kind = bool if key in ("key_required", "movable", "any_model") else str
        if not isinstance(entry[key], kind):
            said = {bool: "true or false", str: "a text"}[kind]
            raise OptionError(f"{file}: provider {name}: {key} {entry[key]!r} is not valid; valid: {said}")
    default = _model(file, name, "", shared)
    listed = {
        model: _model(file, f"{name}:{model}", model, _merged(shared, _table(file, f"provider {name}:{model}", more)))
        for model, more in models.items()
    }
    return Provider(name=name, default=default, models=listed, **{k: v for k, v in entry.items() if k in own})


def _model(file: str, where: str, name: str, values: dict[str, Any]) -> Model:
    _check_keys(file, f"provider {where}: ", values, sorted({field.name for field in fields(Model)} - {"name"}))
    values = dict(values)
    for key, value in values.items():
        fits, said = _CHECKS.get(key) or _CHECKS_BY_KIND[type(_DEFAULTS[key])]
        if not fits(value):
            raise OptionError(f"{file}: provider {where}: {key} {value!r} is not valid; valid: {said}")
    if ("price_in" in values) != ("price_out" in values):
        raise OptionError(f"{file}: provider {where}: price_in and price_out go together; one is missing")
    values["response_format"] = tuple(values.get("response_format", ()))
    return Model(name=name, **values)


def _routes(file: str, name: str, given: object, providers: Mapping[str, Provider]) -> tuple[str, ...]:
    """A route, or a list of them; each leads to a model that exists."""
    routes = [given] if isinstance(given, str) else given
    if not isinstance(routes, list) or not routes or not all(isinstance(each, str) for each in routes):
        raise OptionError(f"{file}: paper: {name} = {given!r} is not valid; valid: a list of provider:model")
    for each in routes:
        provider_name, _, model = each.partition(":")
        provider = providers.get(provider_name)
        if provider is None:
            raise OptionError(f"{file}: paper: {name}: {each!r}: no such provider; valid: {', '.join(providers)}")
        if not model or (model not in provider.models and not provider.any_model):
            known = ", ".join(f"{provider_name}:{other}" for other in provider.models)
            raise OptionError(f"{file}: paper: {name}: {each!r}: no such model; valid: {known}")
    return tuple(dict.fromkeys(routes))


def _table(file: str, where: str, value: object) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise OptionError(f"{file}: {where}: {value!r} is not valid; valid: a table")
    return dict(value)


def _check_keys(file: str, where: str, data: Mapping[str, Any], valid: Sequence[str]) -> None:
    for key in data:
        if key not in valid:
            raise OptionError(f"{file}: {where}unknown key {key!r}; valid: {', '.join(valid)}")


def _whole(low: int) -> Callable[[object], bool]:
    return lambda value: type(value) is int and low <= value <= MOST_TOKENS


def _number(low: float, high: float) -> Callable[[object], bool]:
    def fits(value: object) -> bool:
        return isinstance(value, int | float) and type(value) is not bool and low <= value <= high

    return fits


_PRICE = (_number(0.0, MOST_PRICE), f"US dollars per million tokens, 0 to {MOST_PRICE:.0f}")
_CHECKS: dict[str, tuple[Callable[[Any], bool], str]] = {
    "context": (_whole(0), f"a whole number, 0 (unknown) to {MOST_TOKENS}"),
    "max_tokens": (_whole(1), f"a whole number, 1 to {MOST_TOKENS}"),
    "seconds": (_number(1.0, MOST_SECONDS), f"seconds, 1 to {MOST_SECONDS:.0f}"),
    "price_in": _PRICE,
    "price_out": _PRICE,
    "response_format": (
        lambda value: isinstance(value, list) and all(each in FORMATS for each in value),
        f"a list of {', '.join(FORMATS)}",
    ),
    "max_tokens_field": (lambda value: isinstance(value, str) and value.isidentifier(), "a name"),
}
_CHECKS_BY_KIND: dict[type, tuple[Callable[[Any], bool], str]] = {
    bool: (lambda value: isinstance(value, bool), "true or false"),
    int: (_whole(0), f"a whole number, 0 to {MOST_TOKENS}"),
    float: (_number(0.0, MOST_SECONDS), f"a number, 0 to {MOST_SECONDS:.0f}"),
    str: (lambda value: isinstance(value, str), "a text"),
    dict: (lambda value: isinstance(value, Mapping), "a table"),
}
_DEFAULTS: dict[str, Any] = {each.name: getattr(Model(""), each.name) for each in fields(Model)}
"""What a field holds where nothing is said; its kind tells what may be said, where _CHECKS does not."""
