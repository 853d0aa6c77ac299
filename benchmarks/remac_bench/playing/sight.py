"""Who checks, and who looks at pictures: what follows for an entry and its kitchen from the roles that it names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from remac_bench.errors import UsageError
from remac_bench.playing import agents
from remac_bench.playing.outside import facts_of, plugins
from remac_bench.records import Record
from remac_env.options import USUAL_CAMERAS

IMAGE_SIZE = 512
"""Pixels of a side of the pictures that checkers look at, unless another size is asked for: the paper's."""

WITH_PICTURES = "state+images"


def checks(method: str) -> bool:
    """Whether a method asks for conditions and verdicts."""
    from remac_agents.methods import METHODS

    return method in METHODS and METHODS[method].checks


def with_checker(method: str, agent: Mapping[str, Any], access: agents.Access) -> dict[str, Any]:
    """An agent's keywords; where a model that takes no images leaves the checks to another, they say to whom.

    Raises:
        UnknownNameError, OptionError: for a model that does not exist.
    """
    if "model" not in agent or "checker" in agent or not checks(method):
        return dict(agent)
    checker = _fillers(agent, access)["checker"]
    return dict(agent) if checker == agent["model"] else {**agent, "checker": checker}


def viewers(method: str, agent: Mapping[str, Any], access: agents.Access) -> tuple[str, ...]:
    """The roles of an agent that must be shown pictures.

    Raises:
        UnknownNameError, OptionError: for a role or model that does not exist.
    """
    from remac_agents.wiring.catalogue import looks_at_pictures

    filled = {role: who for role, who in _fillers(agent, access).items() if role == "planner" or checks(method)}
    outside = plugins(filled, providers=access.providers) if access.isolated else {}

    def sees(role: str, who: object) -> bool:
        if role in outside:
            return bool(facts_of(role, who)["needs_images"])
        return looks_at_pictures(role, who, providers=access.providers)

    return tuple(role for role, who in filled.items() if sees(role, who))


def pictures_for(viewers: tuple[str, ...], agent: Mapping[str, Any], access: agents.Access) -> dict[str, Any]:
    """The kitchen's options about pictures that these roles of an agent make use of: the size, and which if unusual."""
    from remac_agents.wiring.catalogue import cameras_of, picture_size

    filled = _fillers(agent, access)
    outside = plugins(filled, providers=access.providers) if access.isolated else {}

    def said(ask: Callable[..., Any], otherwise: Any) -> list[Any]:
        found = (None if r in outside else ask(r, filled[r], providers=access.providers) for r in viewers)
        return [otherwise if each is None else each for each in found]

    cameras = {name for names in said(cameras_of, USUAL_CAMERAS) for name in names}
    size = max(said(picture_size, IMAGE_SIZE), default=IMAGE_SIZE)
    return {"image_size": size} | ({} if cameras <= set(USUAL_CAMERAS) else {"cameras": sorted(cameras)})


def kitchen_for(
    viewers: tuple[str, ...], kitchen: Mapping[str, Any], wanted: Mapping[str, Any]
) -> dict[str, Any]:
    """The kitchen's options for these viewers: with pictures, as wanted unless others are given.

    Raises:
        UsageError: where pictures are refused that somebody must see.
    """
    if not viewers:
        return dict(kitchen)
    if kitchen.get("obs", WITH_PICTURES) != WITH_PICTURES:
        raise UsageError(
            f"obs {kitchen['obs']!r} is not valid for a {', '.join(viewers)} that looks at pictures; "
            f"valid: {WITH_PICTURES}, or nothing: it follows from the roles"
        )
    return {**wanted, **kitchen, "obs": WITH_PICTURES}


def checked_by(record: Record) -> str:
    """Who judged an episode's conditions, as the entry named it; "" for a method that asks nobody."""
    from remac_agents.wiring.filling import DEFAULTS

    agent = record.options.get("agent", {})
    if not (checks(record.method) or record.pre_checks or record.post_checks):
        return ""
    if "checker" in agent or "model" not in agent or "checker" in record.truth_readers:
        return str(agent.get("checker", DEFAULTS["checker"]))
    return str(agent["model"])


def _fillers(agent: Mapping[str, Any], access: agents.Access) -> dict[str, Any]:
    from remac_agents.wiring.filling import fillers

    roles = {name: agent[name] for name in agents.ROLES if name in agent}
    if "model" not in agent:
        return fillers(roles)
    return fillers(roles, model=agent["model"], base_url=access.base_url, providers=access.providers)
