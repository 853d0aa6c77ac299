"""Money in words: a price that is not known is never shown as 0."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from remac_agents.llm import Model

UNKNOWN = "unknown"

PRICE_OPTIONS = "to name the price: price_in=...,price_out=... behind the model's name, dollars a million tokens"
"""What helps where a price is not known."""


def dollars(money: float | None, unpriced: int = 0) -> str:
    """US dollars: "$0.42"; "$0.42+" where further calls had no known price; "unknown" where none had one.

    Args:
        money: of the calls whose price is known; None: of none.
        unpriced: calls whose price is not known.
    """
    if money is None or (unpriced and not money):
        return UNKNOWN
    return f"${digits(money)}{'+' if unpriced else ''}"


def digits(money: float) -> str:
    """An amount with cents; small ones keep two digits that count."""
    if not money:
        return "0"
    if money >= 0.1:
        return f"{money:.2f}"
    return f"{money:.2g}" if money >= 1e-4 else f"{money:.7f}".rstrip("0") if money >= 1e-7 else "under 0.0000001"


def list_price(model: Model) -> str:
    """A model's price by the providers' table."""
    if model.price_in is None or model.price_out is None:
        return "price unknown"
    if not model.price_in and not model.price_out:
        return f"free ({model.priced_on})" if model.priced_on else "free"
    dated = f" ({model.priced_on})" if model.priced_on else ""
    return f"${model.price_in:g} in, ${model.price_out:g} out a million tokens{dated}"
