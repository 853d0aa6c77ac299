"""Who serves language models, and what they offer and cost: providers.toml, and `resolve` to pick from it."""

from __future__ import annotations

import difflib
import ipaddress
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import lru_cache
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from remac_env.errors import OptionError, UnknownNameError

FILE = Path(__file__).with_name("providers.toml")


@dataclass(frozen=True)
class Model:
    """A model at a provider. Prices are US dollars per million tokens; None: unknown. `context` 0: unknown."""

    name: str
    images: bool = True
    response_format: tuple[str, ...] = ()
    stream: bool = True
    stream_only: bool = False
    stream_usage: bool = True
    temperature: bool = True
    max_tokens_field: str = "max_tokens"
    context: int = 0
    max_tokens: int = 8192
    price_in: float | None = None
    price_out: float | None = None
    priced_on: str = ""
    note: str = ""

    def money(self, tokens_in: int | None, tokens_out: int | None) -> float | None:
        """US dollars for so many tokens; None where tokens or price are unknown."""
        if tokens_in is None or tokens_out is None or self.price_in is None or self.price_out is None:
            return None
        return (tokens_in * self.price_in + tokens_out * self.price_out) / 1e6


@dataclass(frozen=True)
class Provider:
    """An OpenAI-compatible endpoint. `default` is what holds for models that are not in `models`."""

    name: str
    title: str
    base_url: str
    key: str
    default: Model
    key_required: bool = True
    movable: bool = False
    any_model: bool = False
    models: Mapping[str, Model] = field(default_factory=dict)


@dataclass(frozen=True)
class Endpoint:
    """A model ready to be called."""

    provider: Provider
    model: Model
    base_url: str

    @property
    def name(self) -> str:
        """`provider:model`."""
        return f"{self.provider.name}:{self.model.name}"


@dataclass(frozen=True)
class Catalogue:
    """All providers, and the names that stand for a provider and model."""

    providers: Mapping[str, Provider]
    paper: Mapping[str, str]

    def names(self) -> list[str]:
        """Every name that can be resolved without further ado."""
        listed = [f"{p.name}:{model}" for p in self.providers.values() for model in p.models]
        return [*self.paper, *listed, *(f"{p.name}:<model>" for p in self.providers.values() if p.any_model)]


def resolve(name: str, *, base_url: str | None = None, file: Path | str | None = None) -> Endpoint:
    """The endpoint that `provider:model`, or a name of the paper's models, stands for.

    Args:
        name: such as "openai:o3", "custom:my-model", "DeepSeek-R1".
        base_url: where the server is, for providers that can be anywhere; elsewhere it must be the provider's own
            and then allows models that are not listed.
        file: another providers.toml.

    Raises:
        UnknownNameError: for an unknown provider or model; lists the valid ones.
        OptionError: for an address that no request may go to.
    """
    catalogue = load(FILE if file is None else file)
    aliases = {alias.casefold(): full for alias, full in catalogue.paper.items()}
    provider_name, colon, model_name = aliases.get(name.casefold(), name).partition(":")
    provider = catalogue.providers.get(provider_name)
    if not colon or provider is None or not model_name.strip():
        raise UnknownNameError(f"unknown model {name[:80]!r}; valid: {', '.join(catalogue.names())}")
    model = provider.models.get(model_name)
    if model is None:
        if not provider.any_model and base_url is None:
            close = difflib.get_close_matches(model_name, provider.models, 1)
            hint = f" (did you mean {close[0]!r}?)" if close else ""
            raise UnknownNameError(
                f"unknown model {model_name[:80]!r} of {provider.title}{hint}; valid: {', '.join(provider.models)}; "
                f"for another one give base_url={provider.base_url!r} too, its price is then unknown"
            )
        model = _renamed(provider.default, model_name, priced=provider.any_model)
    return Endpoint(provider, model, _address(provider, base_url))


def is_model(name: str) -> bool:
    """Whether a name speaks of a provider that is known, or of one of the paper's models; it may still not resolve."""
    catalogue = load()
    aliases = {alias.casefold() for alias in catalogue.paper}
    return name.casefold() in aliases or name.partition(":")[0] in catalogue.providers and ":" in name


def _renamed(model: Model, name: str, *, priced: bool) -> Model:
    values = {field.name: getattr(model, field.name) for field in fields(Model)} | {"name": name}
    if not priced:
        values |= {"price_in": None, "price_out": None, "priced_on": ""}
    return Model(**values)


def _address(provider: Provider, given: str | None) -> str:
    """The address to use, checked: a key goes only where its provider is."""
    if given is not None and not isinstance(given, str):
        raise OptionError(f"base_url {given!r} is not valid; valid: http://host[:port]/path or https://...")
    if given is None and not provider.base_url:
        raise OptionError(f"provider {provider.name!r} needs base_url, such as 'http://127.0.0.1:8000/v1'")
    address = (provider.base_url if given is None else given).rstrip("/")
    try:
        parts = urlsplit(address)
        port = parts.port
    except ValueError as error:
        raise OptionError(f"base_url {address[:80]!r} is not an address: {error}") from None
    if parts.username or parts.password or parts.query or parts.fragment:
        raise OptionError("base_url may hold no user, password, query or fragment; keys belong into the environment")
    if parts.scheme not in ("http", "https") or not parts.hostname or port == 0:
        raise OptionError(f"base_url {address[:80]!r} is not valid; valid: http://host[:port]/path or https://...")
    if _link_local(parts.hostname):
        raise OptionError(f"base_url {address[:80]!r} is not valid: addresses of machine services are not called")
    own = urlsplit(provider.base_url)
    if not provider.movable and (parts.scheme, parts.hostname, port) != (own.scheme, own.hostname, own.port):
        raise OptionError(
            f"base_url {address[:80]!r} is not {provider.title}'s ({provider.base_url}), "
            "and its key goes nowhere else; valid: custom:<model> with this base_url"
        )
    return address


def _link_local(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_link_local
    except ValueError:
        return False


@lru_cache(maxsize=8)
def load(file: Path | str = FILE) -> Catalogue:
    """Read a providers.toml.

    Raises:
        OptionError: naming file, provider and key of what is wrong in it.
    """
    try:
        data = tomllib.loads(Path(file).read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise OptionError(f"{file}: {error}") from error
    providers = {name: _provider(file, name, dict(entry)) for name, entry in data.get("providers", {}).items()}
    return Catalogue(providers, dict(data.get("paper", {})))


def _provider(file: Path | str, name: str, entry: dict[str, Any]) -> Provider:
    models = entry.pop("models", {})
    own = {field.name for field in fields(Provider)} - {"name", "default", "models"}
    shared = {key: value for key, value in entry.items() if key not in own}
    missing = {"title", "base_url", "key"} - set(entry)
    if missing:
        raise OptionError(f"{file}: provider {name}: {', '.join(sorted(missing))} missing")
    default = _model(file, name, "", shared)
    listed = {model: _model(file, f"{name}:{model}", model, shared | dict(more)) for model, more in models.items()}
    return Provider(name=name, default=default, models=listed, **{k: v for k, v in entry.items() if k in own})


def _model(file: Path | str, where: str, name: str, values: dict[str, Any]) -> Model:
    valid = {field.name for field in fields(Model)} - {"name"}
    unknown = set(values) - valid
    if unknown:
        raise OptionError(
            f"{file}: provider {where}: unknown key {sorted(unknown)[0]!r}; valid: {', '.join(sorted(valid))}"
        )
    values = dict(values)
    values["response_format"] = tuple(values.get("response_format", ()))
    return Model(name=name, **values)
