"""Modules from Python files that are not on the import path."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

from remac_env.seeding import digest


def load_file(path: str) -> ModuleType:
    """The module of a file. An unchanged file is run once in a process; a changed one anew.

    Raises:
        OSError: if the file cannot be read.
        ImportError: if it is no Python source. Whatever the file itself raises is passed on.
    """
    file = Path(path).resolve()
    facts = file.stat()
    name = f"remac_role_{digest([str(file), facts.st_mtime_ns, facts.st_size])}"
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
