"""Code from outside that registers tasks: modules by name, or Python files."""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import sys
from collections.abc import Iterable
from pathlib import Path

from remac_bench.errors import UsageError


def find_local_modules() -> None:
    """Let modules of the working folder be imported, as `python` itself does; installed ones come first."""
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.append(here)


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


def _load_module(name: str) -> None:
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name is None or not name.startswith(error.name):
            raise
        raise UsageError(
            f"there is no module {name!r}; give an importable module or a file that ends in .py"
        ) from error


def _load_file(path: Path) -> None:
    if not path.is_file():
        raise UsageError(
            f"there is no file {str(path)!r}; give an importable module or a file that ends in .py"
        )
    name = f"remac_extension_{hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:12]}"
    if name in sys.modules:
        return
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise UsageError(f"{str(path)!r} cannot be imported as Python")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
