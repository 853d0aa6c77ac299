"""README as package indexes show it: hatchling runs this whenever the package is built or installed.

In the repository README's links and pictures are relative, and an index shows neither. The address of the repository
is not known here: whoever publishes gives it, `make wheel REPOSITORY=https://example.org/team/remac-kitchen`, and links
then become absolute and the project's URLs are set. Without it links become plain text and pictures go.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

ADDRESS = "REMAC_REPOSITORY"
"""The environment variable with the repository's address."""

_PICTURE = re.compile(r"!\[([^\]]*)\]\((?!https?:)([^)\s]+)\)\n?")
_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!https?:|#)([^)\s]+)\)")


class ReadmeHook(MetadataHookInterface):
    """Fills in `readme` and `urls`."""

    def update(self, metadata: dict[str, Any]) -> None:
        """See hatchling."""
        address = os.environ.get(ADDRESS, "").rstrip("/")
        text = (Path(self.root) / "README.md").read_text("utf-8")
        metadata["readme"] = {"content-type": "text/markdown", "text": absolute(text, address)}
        metadata["urls"] = urls(address)


def absolute(text: str, address: str) -> str:
    """README with links that lead somewhere from anywhere; "": with none that lead into the repository."""
    if not address:
        return _LINK.sub(lambda m: m[1], _PICTURE.sub("", text))
    text = _PICTURE.sub(lambda m: f"![{m[1]}]({address}/raw/main/{m[2]})\n", text)
    return _LINK.sub(lambda m: f"[{m[1]}]({address}/blob/main/{m[2]})", text)


def urls(address: str) -> dict[str, str]:
    """The project's URLs."""
    if not address:
        return {}
    pages = {"Documentation": "docs/start.md", "Changelog": "CHANGELOG.md"}
    more = {name: f"{address}/blob/main/{path}" for name, path in pages.items()}
    return {"Repository": address, **more, "Issues": f"{address}/issues"}
