"""Geoms that are drawn only while something is so; a mark in their names says what of."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco


def marked(model: mujoco.MjModel, mark: str) -> Iterator[tuple[int, str]]:
    """The geoms with this mark in their names, each with what stands before it."""
    for geom in range(model.ngeom):
        before, found, _ = model.geom(geom).name.partition(mark)
        if found:
            yield geom, before
