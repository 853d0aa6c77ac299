"""Whatever someone else's code hands over, as text that can be shown and written: asking it may fail, this does not."""

from __future__ import annotations

from collections.abc import Callable

SHOWN = 80
"""Characters of a value that an error quotes."""


PATH = 1_000
"""The same of a path: its end says most."""


def printable(text: str) -> str:
    """The text with halves of surrogate pairs, which no file takes, as escapes; an own copy of a subclass's text."""
    return str.__str__(text).encode("utf-8", "backslashreplace").decode()


def is_printable(text: str) -> bool:
    """Whether a text can be written as it is."""
    return printable(text) == str.__str__(text)


def words(value: object) -> str:
    """What a value says of itself; <unprintable Name> where that fails."""
    return _asked(str, value)


def quoted(value: object, longest: int = SHOWN) -> str:
    """A value as errors quote it: on one line, cut short."""
    text = _asked(repr, value)
    text = text if text.isprintable() else " ".join(text.split())
    return text if len(text) <= longest else f"{text[: longest - 3]}..."


def type_name(value: object) -> str:
    """The name of a value's class; of a class, its own."""
    kind = value if isinstance(value, type) else type(value)
    return printable(type.__getattribute__(kind, "__name__"))


def _asked(how: Callable[[object], str], value: object) -> str:
    try:
        return printable(how(value))
    except (KeyboardInterrupt, GeneratorExit):
        raise
    except BaseException:  # noqa: BLE001 - what a stranger's __str__ raises says nothing
        return f"<unprintable {type_name(value)}>"
