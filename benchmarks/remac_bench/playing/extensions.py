"""Code from outside that a command names: modules and Python files that register tasks, and bodies at an address."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from remac_bench.errors import UsageError
from remac_env.plugins import load_file
from remac_env.quoting import quoted
from remac_env.robots import bodies


def load_named(extensions: Iterable[str] | None, addresses: Iterable[str] | None = None) -> None:
    """Import what a command names: modules and files (--import), and bodies (--body) that records may then name too.

    Raises:
        UsageError: for a module or file that does not exist.
        UnknownNameError, OptionError: for a body that cannot be imported, or is none.
    """
    _find_local_modules()
    load_extensions(extensions or ())
    for address in addresses or ():
        bodies.get(address)


def load_extensions(names: Iterable[str]) -> None:
    """Import each module or .py file once; what it registers is then known in this process.

    Raises:
        UsageError: for a module or file that does not exist.
    """
    for name in names:
        if name.endswith(".py"):
            _load_file(Path(name))
        else:
            _load_module(name)


def check_body(kitchen: Mapping[str, Any]) -> None:
    """Refuse a kitchen whose body would have to be imported: a record is no reason to run what lies at an address.

    Args:
        kitchen: options of a kitchen, as a record tells them.

    Raises:
        UsageError: for a body that neither this process nor an installed package knows.
    """
    known, given = bodies.every_name(), kitchen.get("body", bodies.STANDARD)
    if given not in known:
        valid = f"valid: {', '.join(known)}, or one that you name too (--body), as that runs its code"
        raise UsageError(f"body {quoted(given)} is not known here; {valid}")


def _find_local_modules() -> None:
    """Let modules of the working folder be imported, as `python` itself does; installed ones come first."""
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.append(here)


def _load_module(name: str) -> None:
    try:
        if not all(part.isidentifier() for part in name.split(".")):
            raise ModuleNotFoundError(name=name)
        importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name is None or not name.startswith(error.name):
            raise
        raise UsageError(
            f"there is no module {quoted(name)}; give an importable module or a file that ends in .py"
        ) from error


def _load_file(path: Path) -> None:
    if not path.is_file():
        raise UsageError(f"there is no file {str(path)!r}; give an importable module or a file that ends in .py")
    load_file(str(path))
