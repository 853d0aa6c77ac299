"""The objects a kitchen holds: what they are, what they collide with and what they look like."""

from __future__ import annotations

from typing import TYPE_CHECKING

from remac_env.kitchen.objects.catalogue import Category, get

if TYPE_CHECKING:
    import mujoco


def add_object(
    spec: mujoco.MjSpec, worldbody: mujoco.MjsBody, noun: str, category: str | Category, *, visual: bool,
    stained: bool = False,
) -> mujoco.MjsBody:
    """Add an object as a body with a free joint, both named by the noun, and return the body.

    Its colliders, which carry all its mass, are there with and without visual geometry. stained: whether there are
    stains on it until it is washed. Raises UnknownNameError for a category that is not in the catalogue.
    """
    from remac_env.kitchen.objects.colliders import add_colliders
    from remac_env.kitchen.objects.drawing import draw

    kind = category if isinstance(category, Category) else get(category)
    body = worldbody.add_body(name=noun, pos=[0.0, 0.0, kind.rest_height])
    body.add_freejoint(name=noun)
    add_colliders(body, kind)
    if visual:
        draw(spec, body, noun, kind, stained=stained)
    return body
