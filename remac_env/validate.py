"""Refuses a task that could not be played, when it is registered and not when it is reset."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary

from remac_env.errors import OptionError, check_choice
from remac_env.quoting import quoted
from remac_env.tasks.generated import SPEC as GENERATED
from remac_env.tasks.goals import DoorIs, SwitchedOn
from remac_env.tasks.spec import TaskSpec

if TYPE_CHECKING:
    from remac_env.kitchen.floor_plan import Layout


_PLAYABLE: WeakValueDictionary[int, TaskSpec] = WeakValueDictionary()
"""Tasks that were looked at already, by identity."""


def check_playable(spec: TaskSpec) -> None:
    """The same for a task that nobody registered, once: what it speaks of exists.

    What `remac_env.generate` makes is certified, and a start that is stated (`setup`) says itself what there is.
    """
    if spec.generated or spec.setup is not None or spec.annexes or _PLAYABLE.get(id(spec)) is spec:
        return
    validate(spec)
    _PLAYABLE[id(spec)] = spec


def validate(spec: TaskSpec) -> None:
    """Check that a task's parts fit together.

    Raises:
        OptionError: naming the field and what is wrong with it.
        UnknownNameError: for a role, layout, style, fixture or command that does not exist, with the valid names.
        KitchenFileError: for a malformed layout file or category.
    """
    if not isinstance(spec, TaskSpec):
        raise OptionError(f"task {quoted(spec)} is not valid; valid: a TaskSpec")
    if not spec.name.isalnum() or not spec.name[:1].isupper():
        raise OptionError(f"task name {quoted(spec.name)} is not valid; valid: CamelCase letters and digits")
    if spec.name == GENERATED.name:
        raise OptionError(f"task name {spec.name!r} is that of the tasks that `remac_env.generate` makes")
    _check_shape(spec)
    for problem in _problems(spec):
        raise OptionError(f"task {spec.name}: {problem}")
    _check_places(spec)


def _check_shape(spec: TaskSpec) -> None:
    if not all(text.strip() for text in spec.wordings):
        raise OptionError(f"task {spec.name}: wordings {spec.wordings!r} is not valid; valid: three sentences")
    least, most = spec.distractors
    if not 0 <= least <= most:
        raise OptionError(f"task {spec.name}: distractors {spec.distractors!r} is not valid; valid: 0 <= least <= most")
    for kind in ("roles", "styles", "layouts"):
        if not getattr(spec, kind):
            raise OptionError(f"task {spec.name}: {kind} is empty; valid: at least one")


def _problems(spec: TaskSpec) -> Iterator[str]:
    names = [role.name for role in spec.roles]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        yield f"two roles are called {twice[0]!r}; valid: a name of its own for each"
    example = {role.name: role.nouns[0] for role in spec.roles if role.nouns}
    if len(example) < len(spec.roles):
        yield "a role has no nouns; valid: at least one"
    for text in spec.wordings:
        try:
            text.format(**example)
        except (KeyError, IndexError, ValueError) as error:
            yield f"wording {text!r} has a field that is not a role ({error}); valid: {', '.join(names)}"
    try:
        spec.goal.bind(example)
    except (KeyError, IndexError, ValueError) as error:
        yield f"the goal has a field that is not a role ({error}); valid: {', '.join(names)}"


def _check_places(spec: TaskSpec) -> None:
    """Everything that is named exists: in the layouts, the styles and the vocabulary."""
    from remac_env.kitchen import layout as layouts
    from remac_env.kitchen import style as styles
    from remac_env.kitchen.worlds import TaskWorlds

    worlds = TaskWorlds(spec)
    for style in spec.styles:
        check_choice(f"style of task {spec.name}", style, styles.names())
    commands = [worlds.vocabulary.decode(token) for token in range(len(worlds.vocabulary))]
    for verb, implied in spec.verbs.items():
        for command in implied:
            check_choice(f"command of verb {verb!r} of task {spec.name}", command, commands)
    nouns = [noun.name for noun in worlds.vocabulary.nouns]
    for role in spec.roles if spec.setup is None else ():
        for noun in role.nouns:
            check_choice(f"noun of role {role.name!r} of task {spec.name}", noun, nouns)
            options = [c.name for c in worlds.categories.values() if noun == c.name or noun in c.roles]
            if not options:
                raise OptionError(f"task {spec.name}: no category of the catalogue can be the {noun!r}")
    for name in spec.layouts:
        check_choice(f"layout of task {spec.name}", name, (*layouts.names(*layouts.FAMILIES), *spec.layout_files))
        _check_fixtures(spec, worlds.layout(name, spec.styles[0]))


def _check_fixtures(spec: TaskSpec, layout: Layout) -> None:
    usable = list(dict.fromkeys(f.noun for f in layout.fixtures.values() if f.station is not None))
    where = f"of task {spec.name} in layout {layout.name}"
    for name in (*spec.fixtures, *(role.at for role in spec.roles)):
        check_choice(f"fixture {where}", name, usable)
    goal = spec.goal.bind({role.name: role.nouns[0] for role in spec.roles})
    objects = [noun for role in spec.roles for noun in role.nouns]
    for name in goal.names():
        check_choice(f"name in the goal {where}", name, [*usable, *objects])
    for atom in goal.atoms():
        if isinstance(atom, DoorIs) and not layout.fixtures[atom.fixture].door:
            raise OptionError(f"task {spec.name}: the goal speaks of a door of {atom.fixture}, which has none")
        if isinstance(atom, SwitchedOn) and not layout.fixtures[atom.fixture].switches:
            raise OptionError(f"task {spec.name}: the goal switches on {atom.fixture}, which has no switch")
