"""Prompts are Markdown files in `prompts/`: a part for the system, a part for the user, and named fields.

    # system
    ...
    # user
    Goal: {{goal}}

A paragraph whose fields are all empty is left out, so that what there is nothing to say about is not spoken of.
Values are put in once and never searched for fields themselves.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

from remac_env.errors import KitchenFileError, OptionError, check_choice

_FIELD = re.compile(r"\{\{([a-z_]+)\}\}")
_PARTS = re.compile(r"\A# system\n(?P<system>.*?)\n# user\n(?P<user>.*)\Z", re.S)

Message = dict[str, str]


@dataclass(frozen=True)
class Prompt:
    """One prompt. `version` is the digest of its file's text; `fields` are the names that it wants filled."""

    name: str
    system: str
    user: str
    version: str

    @property
    def fields(self) -> frozenset[str]:
        """The names in double braces."""
        return frozenset(_FIELD.findall(self.system + self.user))

    def messages(self, fields: Mapping[str, str]) -> list[Message]:
        """The prompt with its fields filled, as messages.

        Raises:
            OptionError: unless exactly the prompt's fields are given.
        """
        if set(fields) != self.fields:
            wrong = sorted(set(fields) ^ self.fields)
            raise OptionError(f"prompt {self.name!r}: fields {wrong} differ; valid: {', '.join(sorted(self.fields))}")
        parts = {"system": self.system, "user": self.user}
        return [{"role": role, "content": _filled(text, fields)} for role, text in parts.items()]


def names() -> tuple[str, ...]:
    """The names of all prompts."""
    files = resources.files("remac_agents").joinpath("prompts").iterdir()
    return tuple(sorted(file.name.removesuffix(".md") for file in files if file.name.endswith(".md")))


def versions() -> dict[str, str]:
    """Prompt -> digest of its text, for records."""
    return {name: load(name).version for name in names()}


@lru_cache(maxsize=64)
def load(name: str) -> Prompt:
    """A prompt by its name.

    Raises:
        UnknownNameError: for an unknown one; lists the valid ones.
        KitchenFileError: for a file without its two parts.
    """
    check_choice("prompt", name, names())
    file = f"{name}.md"
    return read(resources.files("remac_agents").joinpath("prompts", file).read_text("utf-8"), name)


def read(text: str, name: str) -> Prompt:
    """A prompt from the text of its file.

    Raises:
        KitchenFileError: for a text without its two parts.
    """
    match = _PARTS.match(text)
    if match is None:
        raise KitchenFileError(f"{name}.md", "parts", "it needs '# system' and then '# user', each on its line")
    version = hashlib.sha256(text.encode()).hexdigest()[:12]
    return Prompt(name, match["system"].strip(), match["user"].strip(), version)


def _filled(text: str, fields: Mapping[str, str]) -> str:
    told = [paragraph for paragraph in text.split("\n\n") if _has_to_say(paragraph, fields)]
    return _FIELD.sub(lambda match: fields[match[1]], "\n\n".join(told))


def _has_to_say(paragraph: str, fields: Mapping[str, str]) -> bool:
    used = _FIELD.findall(paragraph)
    return not used or any(fields[name] for name in used)
