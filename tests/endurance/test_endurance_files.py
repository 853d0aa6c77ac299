"""Every key of every layout, style and object file, missing, of a wrong type, out of range or unknown.

The only error is KitchenFileError, and it names the file, the key and what would be valid.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from endurance_files import STRANGE, At, dotted, dumps, places, replaced, tables, without, wrong_types

from remac_env.errors import KitchenFileError
from remac_env.kitchen import layout, style
from remac_env.kitchen.objects import catalogue

FILE = "odd.toml"

Reader = Callable[[dict[str, Any], Path], object]


@dataclass(frozen=True)
class Kind:
    """A kind of kitchen file: where the shipped ones are, how they are read, and what in them may be otherwise.

    `optional`: what may be missing. `loose`: tables whose entries have names of their own, so that the entry of another
    name, or none, may do. `free`: texts that may be any. `unbounded`: numbers that may be very large, or below zero.
    `share`: one of so many changes is tried in the fast suite.
    """

    folder: Path
    read: Reader
    optional: str
    loose: str
    free: str
    large: str
    negative: str
    share: int


def _read_layout(tree: dict[str, Any], folder: Path) -> object:
    return layout.parse(dumps(tree), name="odd", file=FILE)


def _read_style(tree: dict[str, Any], folder: Path) -> object:
    (folder / FILE).write_text(dumps(tree), encoding="utf-8")
    return style.read(folder / FILE)


def _read_objects(tree: dict[str, Any], folder: Path) -> object:
    return [catalogue.parse(name, table, source=FILE) for name, table in tree.items()]


KINDS = {
    "layout": Kind(
        folder=layout.FOLDER, read=_read_layout,
        optional=r"fixtures\.\w+\.(front|model|slots|doors|part_of)|(fixtures|stations)\.\w+\.wall|room\.ceiling",
        loose=r"(walls|stations|asides|fixtures)\.\w+", free=r".*\.name",
        large=r".*\.(yaw|tiles_[xz])|walls\.\w+\.heading|version|.*\.doors",
        negative=r".*\.(yaw|tiles_[xz])", share=80,
    ),
    "style": Kind(
        folder=style._FOLDER, read=_read_style, optional=".*", loose="", free="title", large="", negative="", share=8,
    ),
    "objects": Kind(
        folder=catalogue._FOLDER, read=_read_objects,
        optional=r"[^.]+\.(roles|attributes|needs_vessel_in|vessel_in|too_(big_for|deep_in)|holds|inside_height|look|color)"
        r"|[^.]+\.grasp\.(lean|any_yaw)|[^.]+\.body\.handle(_\w+)?",
        loose=r"[^.]+", free=r"[^.]+\.(roles|look)",
        large=r"[^.]+\.(mass|friction|rest_height|holds|inside_height)|[^.]+\.grasp\.(height|reach|lean)|[^.]+\.body\..*",
        negative=r"[^.]+\.body\.points", share=4,
    ),
}  # fmt: skip


def _files() -> list[Any]:
    """(kind, name of a shipped file)."""
    return [(name, file.stem) for name, kind in KINDS.items() for file in sorted(kind.folder.glob("*.toml"))]


@dataclass(frozen=True)
class Change:
    """A file with one thing changed. `must`: what the error has to name, or None where the file may be as it is."""

    what: str
    tree: dict[str, Any]
    must: list[str] | None


def changes(kind: Kind, tree: dict[str, Any]) -> Iterator[Callable[[], Change]]:
    """All changes, made when they are called for."""
    for path, value in places(tree):
        name = re.sub(r"(\[\d+\])+$", "", dotted(path))  # an entry of plain values goes by its list
        named = re.sub(r"slots\[\d+\]\.station$", "station", name)  # stations are looked up a fixture at a time
        if isinstance(path[-1], str):
            may = re.fullmatch(f"{kind.optional}|{kind.loose}", name) is not None
            yield partial(_missing, tree, path, None if may else [path[-1]])
        for wrong in wrong_types(value):
            free = re.fullmatch(kind.free, name) is not None and wrong == [STRANGE]
            yield partial(_other, tree, path, wrong, None if free else [name])
        if isinstance(value, str):
            valid = "#rrggbb" if value.startswith("#") else value
            yield partial(_other, tree, path, STRANGE, None if re.fullmatch(kind.free, name) else [named, valid])
        if isinstance(value, int | float) and not isinstance(value, bool):
            for number, pattern in ((1_000_000, kind.large), (-1_000_000, kind.negative)):
                # What is far too large may be told as the thing that it makes too large.
                yield partial(_other, tree, path, number, None if re.fullmatch(pattern, name) else [])
    for path in tables(tree):
        listed = [] if re.fullmatch(f"{kind.loose}|fixtures", dotted((*path, "x"))) else _keys(tree, path)
        yield partial(_other, tree, (*path, STRANGE), 1, [dotted((*path, STRANGE)), *listed])


def _keys(tree: Any, path: At) -> list[str]:
    for key in path:
        tree = tree[key]
    return list(tree)


def _missing(tree: dict[str, Any], path: At, must: list[str] | None) -> Change:
    return Change(f"without {dotted(path)}", without(tree, path), must)


def _other(tree: dict[str, Any], path: At, value: Any, must: list[str] | None) -> Change:
    return Change(f"{dotted(path)} = {str(value)[:40]}", replaced(tree, path, value), must)


def fault(read: Reader, change: Change, folder: Path) -> str | None:
    """What is wrong with how the changed file is received, or None."""
    try:
        read(change.tree, folder)
    except KitchenFileError as error:
        text = str(error)
        lacking = [word for word in [FILE, *(change.must or [])] if word not in text]
        return f"{change.what}: {text!r} does not name {lacking}" if lacking else None
    except Exception as error:  # noqa: BLE001 - whatever else comes is what is looked for
        return f"{change.what}: raised {error!r}"
    return None if change.must is None else f"{change.what}: was accepted"


def _faults(name: str, stem: str, folder: Path, *, share: int) -> tuple[int, list[str]]:
    kind = KINDS[name]
    tree = tomllib.loads((kind.folder / f"{stem}.toml").read_text(encoding="utf-8"))
    assert tomllib.loads(dumps(tree)) == tree
    kind.read(tree, folder)
    # Each file begins somewhere else, so that together they try nearly everything.
    first = sum(map(ord, stem)) % share
    made = [make() for make in list(changes(kind, tree))[first::share]]
    return len(made), [found for change in made if (found := fault(kind.read, change, folder)) is not None]


@pytest.mark.parametrize(("kind", "stem"), _files())
def test_some_of_all_changes(kind: str, stem: str, tmp_path: Path) -> None:
    tried, faults = _faults(kind, stem, tmp_path, share=KINDS[kind].share)
    assert tried >= 20 and not faults, "\n".join(faults)


@pytest.mark.long
@pytest.mark.parametrize(("kind", "stem"), _files())
def test_all_changes(kind: str, stem: str, tmp_path: Path) -> None:
    tried, faults = _faults(kind, stem, tmp_path, share=1)
    assert tried >= 100 and not faults, "\n".join(faults)


BAD_READERS: list[tuple[Callable[[dict[str, Any]], object], str]] = [
    (lambda tree: tree["room"], "was accepted"),
    (lambda tree: tree["room"]["height"] + tree["room"]["front"], "raised TypeError"),
    (lambda tree: _blame("room.height", "is wrong", file="other.toml"), r"does not name \['odd.toml'\]"),
    (lambda tree: _blame("room", "something is wrong"), r"does not name \['room.height'\]"),
]


def _blame(key: str, problem: str, *, file: str = FILE) -> None:
    raise KitchenFileError(file, key, problem)


@pytest.mark.parametrize(("bad", "words"), BAD_READERS)
def test_a_careless_reader_is_found_out(bad: Callable[[dict[str, Any]], object], words: str, tmp_path: Path) -> None:
    tree = {"room": {"height": 2.5, "front": -3.0}}
    change = _other(tree, ("room", "height"), "2.5", ["room.height"])
    found = fault(lambda changed, folder: bad(changed), change, tmp_path)
    assert found is not None and re.search(words, found)


@pytest.mark.parametrize("kind", sorted(KINDS))
@pytest.mark.parametrize(
    "text", [b"\xc3\x28 = 1", b"a = [\n", b"a = 1\na = 2\n", b"a = " + b"9" * 5000, b"a = " + b"[" * 5000, b"\x00"],
    ids=["not UTF-8", "cut off", "a key twice", "too many digits", "too deep", "a null"],
)  # fmt: skip
def test_what_is_not_toml_is_named(kind: str, text: bytes, tmp_path: Path) -> None:
    file = tmp_path / FILE
    file.write_bytes(text)
    readers = {"layout": layout.read, "style": style.read, "objects": catalogue.read}
    with pytest.raises(KitchenFileError, match=r"odd\.toml: file: "):
        readers[kind](file)
    with pytest.raises(KitchenFileError, match="file: "):
        readers[kind](tmp_path)
