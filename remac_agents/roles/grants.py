"""What a role may see, by what it declares: `needs_rules`, `needs_truth`."""

from __future__ import annotations

from collections.abc import Callable, Mapping


def reads_truth(role: object) -> bool:
    """Whether a role declares that it needs the WorldState."""
    return bool(getattr(role, "needs_truth", False))


def reads_rules(role: object) -> bool:
    """Whether a role is given the Rules: it declares that it needs them, or the truth, which is read by them."""
    return bool(getattr(role, "needs_rules", False)) or reads_truth(role)


def readers(roles: Mapping[str, object], reads: Callable[[object], bool]) -> tuple[str, ...]:
    """The names of the roles that do."""
    return tuple(name for name, role in roles.items() if reads(role))


def declared_seconds(roles: Mapping[str, object]) -> float:
    """What one decision of these roles takes on the kitchen's clock by their own word (`thinking_seconds`), s.

    It is for roles that ask no model; what models write and take is counted.
    """
    return sum(float(getattr(role, "thinking_seconds", 0.0)) for role in roles.values())


def is_ours(role: object) -> bool:
    """Whether a role is one of this package, and not code from outside."""
    return type(role).__module__.startswith("remac_agents.") and not getattr(role, "outside", False)


def weights(roles: Mapping[str, object]) -> dict[str, str]:
    """Role -> the digest of the file of numbers by which it answers (`sha256`), for our own roles that have one."""
    found = {name: getattr(role, "sha256", "") for name, role in roles.items() if is_ours(role)}
    return {name: digest for name, digest in found.items() if isinstance(digest, str) and digest}


def isolation(roles: Mapping[str, object]) -> bool | None:
    """Whether all code from outside runs in processes of its own; None where there is none."""
    outside = [role for role in roles.values() if not is_ours(role)]
    return all(bool(getattr(role, "isolated", False)) for role in outside) if outside else None
