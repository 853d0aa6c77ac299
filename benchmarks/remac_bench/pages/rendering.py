"""Templates to pages: autoescaped, with style and script inside, and a policy that allows those two alone."""

from __future__ import annotations

import base64
import hashlib
import json
from functools import cache, partial
from importlib import resources
from typing import Any

import jinja2
from markupsafe import Markup

from remac_bench.pages.text import shown, slug
from remac_bench.prices import dollars

FONT = "system-ui, -apple-system, 'Segoe UI', 'Helvetica Neue', 'DejaVu Sans', sans-serif"

POLICY = (
    "default-src 'none'; style-src 'sha256-{style}'; script-src 'sha256-{script}'; "
    "img-src 'self' file:; media-src 'self' file:; base-uri 'none'; form-action 'none'"
)
"""`file:` is for pages that are opened from a disk, where browsers differ on what 'self' is."""

ASKING = "; connect-src 'self'"
"""What a page may also do that asks the server that it comes from."""

TEXT_MAX = 200_000
"""Characters of one text on a page."""


def render(
    template: str, *, limit: int = TEXT_MAX, scripts: tuple[str, ...] = (), asks: bool = False, **facts: Any
) -> str:
    """A template of this package, filled; every text in it is escaped, made visible, and cut to the limit.

    Args:
        scripts: files of scripts/ that the page has, in this order.
        asks: whether its scripts may ask the server that it comes from.
    """
    environment = _environment(limit)
    style, script = _file("style.css"), "".join(_file(f"scripts/{name}") for name in scripts)
    policy = POLICY.format(style=_hash(style), script=_hash(script)) + (ASKING if asks else "")
    # All are files of this package, and their hashes are what the policy allows.
    own = {"style": Markup(style), "script": Markup(script)}  # noqa: S704
    return environment.get_template(template).render(policy=policy, font=FONT, **own, **facts)


@cache
def _environment(limit: int) -> jinja2.Environment:
    made = jinja2.Environment(
        loader=jinja2.PackageLoader("remac_bench.pages"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        finalize=partial(shown, limit=limit),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["slug"] = slug
    made.filters["dollars"] = dollars
    made.filters["json"] = json.dumps
    return made


@cache
def _file(name: str) -> str:
    return resources.files("remac_bench.pages").joinpath(name).read_text("utf-8")


@cache
def _hash(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
