"""Which endpoint a name stands for, and by which provider a model is reached."""

from __future__ import annotations

import difflib
import ipaddress
from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from urllib.parse import urlsplit

from remac_agents.llm.provider_files import read_catalogue
from remac_agents.llm.providers import AUTO, OWN_MACHINE, Catalogue, Endpoint, Model, Provider
from remac_env.errors import OptionError, UnknownNameError


def resolve(
    name: str, *, base_url: str | None = None, file: Path | str | None = None, via: str | None = None
) -> Endpoint:
    """The endpoint that `provider:model`, or a name of the paper's models, stands for.

    Args:
        name: such as "openai:o3", "custom:my-model", "DeepSeek-R1".
        base_url: where the server is, for providers that can be anywhere; elsewhere it must be the provider's own
            and then allows models that are not listed.
        file: a file of providers that adds to the ones built in, or overrides them.
        via: see `route`.

    Raises:
        UnknownNameError: for an unknown provider, model or route; lists the valid ones.
        OptionError: for an address that no request may go to, or a file that is not valid.
    """
    catalogue = load(file)
    name = route(name, via=via, file=file)
    provider_name, colon, model_name = name.partition(":")
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
    address = _address(provider, base_url)
    if model.price_in is None and provider.movable and _own_machine(urlsplit(address).hostname or ""):
        model = replace(model, price_in=0.0, price_out=0.0, priced_on=OWN_MACHINE)
    return Endpoint(provider, model, address)


def route(
    name: str,
    *,
    via: str | None = None,
    file: Path | str | None = None,
    environ: Mapping[str, str] | None = None,
) -> str:
    """The `provider:model` by which a model is reached.

    Args:
        name: `provider:model`, or a name of the paper's models.
        via: a provider, or "auto" for the first route whose key is set; None: the first route, or the name as it is.
        environ: where keys are looked up; None: the environment.

    Raises:
        UnknownNameError: for a provider that does not exist, or by which there is no route; lists the routes.
        OptionError: for "auto" where no key is set; lists the keys.
    """
    catalogue = load(file)
    routes = catalogue.routes(name)
    if via is None:
        return name if name in routes else routes[0]
    catalogue.check_via(via)
    if via == AUTO:
        ready = [each for each in routes if catalogue.ready(each, environ)]
        if ready or len(routes) == 1:
            return name if name in ready else (ready or routes)[0]
        keys = ", ".join(f"{_key(catalogue, each)} ({each})" for each in routes)
        raise OptionError(f"no key is set for {name[:80]!r}; set one of {keys}")
    for each in routes:
        if each.partition(":")[0] == via:
            return each
    raise UnknownNameError(f"{name[:80]!r} has no route via {via!r}; valid: {', '.join(routes)}")


def is_model(name: str, *, file: Path | str | None = None) -> bool:
    """Whether a name speaks of a provider that is known, or of one of the paper's models; it may still not resolve."""
    catalogue = load(file)
    aliases = {alias.casefold() for alias in catalogue.paper}
    return name.casefold() in aliases or name.partition(":")[0] in catalogue.providers and ":" in name


def load(file: Path | str | None = None) -> Catalogue:
    """The providers that are built in, and what a file adds to them.

    Raises:
        OptionError: naming file, provider and key of what is wrong in it.
    """
    return read_catalogue(file)


def _key(catalogue: Catalogue, full: str) -> str:
    return catalogue.providers[full.partition(":")[0]].key


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


def _own_machine(host: str) -> bool:
    """Whether a host is the machine that this runs on, by its loopback address."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost" or host.endswith(".localhost")


def _link_local(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_link_local
    except ValueError:
        return False
