"""Code from outside: what installed packages add by entry points, and what lies at an address.

    [project.entry-points."remac.tasks"]
    my_tasks = "my_package.tasks"              # a module that calls remac_env.register_task
    [project.entry-points."remac.planners"]
    mine = "my_package.planners:MyPlanner"     # also remac.checkers, remac.adjusters, ... : one group a role
    [project.entry-points."remac.bodies"]
    mine = "my_package.bodies:MyBody"
An address is "package.module:Name" or "path/file.py:Name". Nothing is loaded before somebody asks for a name, or for
all of them.
"""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import sys
import warnings
from collections.abc import Mapping, Sequence
from functools import lru_cache
from importlib import metadata
from pathlib import Path
from types import ModuleType
from typing import Any

from remac_env.errors import UnknownNameError
from remac_env.quoting import PATH, quoted, type_name, words

TASKS, BODIES = "remac.tasks", "remac.bodies"

FORMS = ("package.module:Name", "path/file.py:Name")
"""What may stand in place of a name wherever code from outside is taken."""

WORDS_MAX = 300
"""Characters of what a stranger's exception says."""


def group_of(role: str) -> str:
    """The group of a role's names: "remac.planners"."""
    return f"remac.{role.removesuffix('s')}s"


@lru_cache(maxsize=32)
def installed(group: str) -> dict[str, str]:
    """Name -> address ("module:attribute" or "module") of what installed packages add to a group, sorted by name."""
    found = metadata.entry_points(group=group)
    return {entry.name: entry.value for entry in sorted(found, key=lambda entry: (entry.name, entry.value))}


@lru_cache(maxsize=1)
def load_tasks() -> tuple[str, ...]:
    """Import, once, every module that registers tasks. One that cannot be imported spoils none of the others.

    Returns:
        What is wrong with those that add nothing, each with its entry point's name; a warning tells it too.
    """
    problems = []
    for entry in sorted(metadata.entry_points(group=TASKS), key=lambda entry: (entry.name, entry.value)):
        package = entry.dist.name if entry.dist is not None else "an installed package"
        who = f"tasks {entry.name!r} of {package}"
        try:
            found = entry.load()
        except (Exception, SystemExit) as error:  # noqa: BLE001 - a stranger's module may raise anything
            told = f"{type(error).__name__}: {_words(error)}"
            problems.append(f"{who} cannot be imported from {entry.value!r}: {told}")
            continue
        if not isinstance(found, ModuleType):
            problems.append(f"{who}: {entry.value!r} is no module (its type: {type(found).__name__})")
    if problems:
        warnings.warn("; ".join(problems), RuntimeWarning, stacklevel=3)
    return tuple(problems)


def _words(error: BaseException) -> str:
    try:
        return str(error)[:WORDS_MAX]
    except Exception:  # noqa: BLE001 - what a stranger's __str__ raises says nothing
        return "it does not say why"


def find(
    kind: str, name: str, *, own: Mapping[str, str], group: str, forms: Sequence[str] = FORMS, more: str = ""
) -> Any:
    """The class, object or function that a name or an address stands for.

    Args:
        kind: what it is to be, for errors.
        own: name -> address, of those of the project.
        group: of the entry points of those that installed packages add.
        forms: what else is valid, for errors; `more`: what errors end with.

    Raises:
        UnknownNameError: for what is neither a name nor an address, or cannot be imported.
    """
    added = None if name in own else installed(group).get(name)
    address = own.get(name) or added or name
    source, colon, _ = address.rpartition(":")
    is_module = all(part.isidentifier() for part in source.split("."))
    if added is not None and not (colon and is_module):
        raise UnknownNameError(f"{kind} {name!r}: its entry point leads to {address!r}; valid: {FORMS[0]}")
    if not colon or not (is_module or source.endswith(".py")):
        valid = ", ".join((*own, *installed(group), *forms))
        raise UnknownNameError(f"unknown {kind} {quoted(name, PATH)}; valid: {valid}{more}")
    return load(kind, address, name, added=added is not None)


def load(kind: str, address: str, name: str = "", *, added: bool = False) -> Any:
    """What lies at an address.

    Args:
        name: what was asked for, if that was not the address.
        added: whether an installed package says so; what its module raises is then told in one line.

    Raises:
        UnknownNameError: for what cannot be imported. Whatever a user's own file raises is passed on.
    """
    source, _, attribute = address.rpartition(":")
    name = name or address
    try:
        module = load_file(source) if source.endswith(".py") else importlib.import_module(source)
    except (ImportError, OSError, SyntaxError, ValueError) as error:
        raise UnknownNameError(f"{kind} {quoted(name, PATH)} cannot be imported: {error}") from error
    except (Exception, SystemExit) as error:
        if not added:
            raise
        told = f"{type_name(error)}: {words(error)}"
        raise UnknownNameError(f"{kind} {name!r} cannot be imported: {told}") from error
    if not hasattr(module, attribute):
        public = [word for word, value in vars(module).items() if callable(value) and not word.startswith("_")]
        there = ", ".join(public) or "nothing"
        raise UnknownNameError(f"{kind} {name!r}: {source} has no {attribute!r}; it has: {there}")
    return getattr(module, attribute)


def load_file(path: str) -> ModuleType:
    """The module of a file. An unchanged file is run once in a process; a changed one anew.

    Raises:
        OSError: if the file cannot be read.
        ImportError: if it is no Python source. Whatever the file itself raises is passed on.
    """
    file = Path(path).resolve()
    facts = file.stat()
    told = f"{file} {facts.st_mtime_ns} {facts.st_size}".encode(errors="surrogateescape")
    name = f"remac_file_{hashlib.sha256(told).hexdigest()[:12]}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path!r} is no Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # before it runs: dataclasses look their module up here
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module
