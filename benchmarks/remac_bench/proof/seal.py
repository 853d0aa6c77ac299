"""A seal under what was accepted here: an acceptance that somebody else wrote does not bear it."""

from __future__ import annotations

import hashlib
import hmac
import os
import secrets
from contextlib import suppress
from pathlib import Path

from remac_bench.errors import UsageError

KEY = "acceptance.key"
"""Random bytes that never leave this account, and no submission holds."""


def seal(text: str) -> str:
    """The seal of this account under a text, which is made on first use.

    Raises:
        UsageError: where nothing can be kept.
    """
    path = _folder() / KEY
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError), os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as f:
            f.write(secrets.token_hex(32))
        return hmac.new(path.read_bytes(), text.encode("utf-8", "surrogatepass"), hashlib.sha256).hexdigest()
    except OSError as error:
        raise UsageError(f"{path} cannot be kept: {error.strerror or error}; set XDG_STATE_HOME to a folder") from error


def is_sealed(text: str, given: object) -> bool:
    """Whether a seal is the one of this account under a text."""
    return isinstance(given, str) and hmac.compare_digest(seal(text).encode(), given.encode("utf-8", "surrogatepass"))


def _folder() -> Path:
    home = os.path.expanduser("~")
    state = os.environ.get("XDG_STATE_HOME") or (os.path.join(home, ".local/state") if os.path.isabs(home) else None)
    if state is None:
        raise UsageError("acceptances are sealed with a key of this account, and it has no home; set XDG_STATE_HOME")
    return Path(state) / "remac_bench"
