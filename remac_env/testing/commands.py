"""check_commands: the list of commands does not say which vessel, door or switch the task needs."""

from __future__ import annotations

from collections.abc import Iterable

from remac_env.testing.play import EnvMaker, expect, opened

_REMEDY = "leave room for distractors, or take a layout with more to use"


def check_commands(env_fn: EnvMaker, *, seeds: Iterable[int] = (0, 1)) -> None:
    """Commands name more than the task needs, as far as it needs a vessel, a door or a switch.

    Beside each vessel of the task there is another one with a `place to` command; and not everything that holds, opens
    or runs is named by the goal or the task.

    Raises:
        ContractError: with the seed, and what is told by its commands alone.
    """
    with opened(env_fn) as env:
        spec = env.worlds.spec
        for seed in seeds:
            where = f"check_commands, seed {seed}"
            _, infos = env.reset(seed=seed)
            scene = env.start.scene
            legal = {text for info in infos.values() for text in info["commands"]}
            told = [subtask for text in legal if (subtask := env.vocabulary.parse(text)) is not None]
            nouns = (noun for role in spec.roles for noun in role.nouns)
            own = {*env.goal.names(), *spec.fixtures, *(role.at for role in spec.roles), *nouns}
            vessels = {s.target for s in told if s.row.puts and s.target in scene.objects}
            working = {s.target for s in told if s.row.lasting}
            alone = sorted(vessels & own)
            leak = f"{where}: the commands give the answer away: no other vessel than {', '.join(alone)}; {_REMEDY}"
            expect(not alone or bool(vessels - own), leak)
            named = sorted(vessels | working)
            leak = f"{where}: the commands give the answer away: the task needs all of {', '.join(named)}; {_REMEDY}"
            expect(not named or not set(named) <= own, leak)
