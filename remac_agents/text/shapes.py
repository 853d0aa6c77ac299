"""What is wrong with the shape of a JSON answer, in words for whoever wrote it: entries count from 1."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from remac_agents.text.printable import SHOWN

WANTED = {
    "bool": "true or false",
    "string": "a text",
    "int": "a whole number",
    "float": "a number",
    "list": "a list in square brackets",
    "model": "a JSON object",
}
"""How a type of error of pydantic begins -> what is wanted there."""


def shape_problems(error: ValidationError, shape: type[BaseModel]) -> list[str]:
    """One line a fault, with what was given and what may stand there."""
    return [_problem(each, shape) for each in error.errors(include_url=False)]


def _problem(each: Mapping[str, Any], shape: type[BaseModel]) -> str:
    where, kind = _place(each["loc"]), str(each["type"])
    if kind == "missing":
        return f"{where} is missing"
    if kind == "too_long":
        return f"{where} has too many entries; valid: at most {each['ctx']['max_length']}"
    wanted = next((words for begin, words in WANTED.items() if kind.startswith(begin)), None)
    if wanted is None:
        return f"{where}: {each['msg']}"
    valid = f"{wanted}, or null" if _may_be_null(each["loc"], shape) else wanted
    return f"{where} is {_short(json.dumps(each['input']))}; valid: {valid}"


def _short(text: str) -> str:
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."


def _place(loc: Sequence[int | str]) -> str:
    """Entry 2 of "steps"."""
    told = ""
    for part in loc:
        told = f"entry {part + 1} of {told}" if isinstance(part, int) else f'"{part}"'
    return told or "the answer"


def _may_be_null(loc: Sequence[int | str], shape: type[BaseModel]) -> bool:
    name, *deeper = loc or ("",)
    field = shape.model_fields.get(str(name))
    kind: Any = None if field is None else field.annotation
    for _ in deeper:
        kind = next(iter(get_args(kind)), None)
    return type(None) in get_args(kind)
