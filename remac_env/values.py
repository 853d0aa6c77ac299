"""NumPy's texts, numbers and booleans, taken wherever Python's are: turned into Python's where they come in."""

from __future__ import annotations

from dataclasses import fields
from typing import Any


def python_value(value: Any) -> Any:
    """A text, number or boolean of NumPy (or an array of no dimensions) as Python's own; anything else as it is.

    A number of single or half precision becomes the shortest decimal that names it: 0.1 stays 0.1. Texts of a subclass,
    such as members of a StrEnum, become plain ones.
    """
    if type(value).__module__ == "numpy" and getattr(value, "shape", None) == ():
        if type(value).__name__ == "ndarray":
            value = value[()]  # of no dimensions: what is in it
        kind = getattr(getattr(value, "dtype", None), "kind", "")
        if kind == "f":
            return float(str(value))
        return value.item() if kind in tuple("biuU") else value
    if isinstance(value, str) and type(value) is not str:
        return str.__str__(value)
    return value


def python_values(value: Any) -> Any:
    """The same for everything in tuples, lists, mappings and arrays; an array becomes a tuple."""
    if type(value).__module__ == "numpy" and getattr(value, "shape", None):
        return tuple(python_values(part) for part in value)
    if type(value) in (tuple, list):
        return type(value)(python_values(part) for part in value)
    if type(value) is dict:
        return {python_value(key): python_values(part) for key, part in value.items()}
    return python_value(value)


def python_fields(made: Any) -> None:
    """Turn the fields of a frozen dataclass that is being made; to be called by its __post_init__."""
    for field in fields(made):
        object.__setattr__(made, field.name, python_values(getattr(made, field.name)))

