"""What `remac doctor` says of language models: the keys of all providers, and the routes to the paper's models."""

from __future__ import annotations

import os
from pathlib import Path

from remac_agents.llm import Catalogue, Provider, load
from remac_bench.playing.machine import Finding
from remac_bench.prices import list_price


def examine_models(providers: Path | str | None = None) -> list[Finding]:
    """Keys and routes as the providers' table has them. Nothing is asked; values of keys are never shown.

    Raises:
        OptionError: for a file of providers that is not valid.
    """
    catalogue = load(providers)
    return [*map(_key, catalogue.providers.values()), *_routes(catalogue)]


def _key(provider: Provider) -> Finding:
    here = bool(os.environ.get(provider.key, "").strip())
    served = ", ".join(provider.models) or "any model"
    more = " and any other" if provider.models and provider.any_model else ""
    need = "" if provider.key_required else "; it may do without a key"
    purpose = f"{provider.title}: {served}{more}{need}"
    return Finding("keys", provider.key, "set" if here else "not set", True if here else None, purpose)


def _routes(catalogue: Catalogue) -> list[Finding]:
    found = []
    for name, routes in catalogue.paper.items():
        for number, full in enumerate(routes, start=1):
            named, _, served = full.partition(":")
            provider = catalogue.providers[named]
            model, ready = provider.models.get(served, provider.default), provider.ready()
            needs = f"{provider.key} {'is' if ready else 'is not'} set" if provider.key_required else "no key needed"
            facts = [needs, list_price(model), f"{model.context} tokens of context" if model.context else ""]
            facts += ["pictures" if model.images else "no pictures", model.note]
            told = "; ".join(fact for fact in facts if fact)
            found.append(Finding("models", f"{name}, route {number}", full, True if ready else None, told))
    return found
