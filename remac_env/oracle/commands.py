"""Which commands can matter for a goal: the search tries no others, and tests hold it against one that tries all."""

from __future__ import annotations

from collections.abc import Sequence

from remac_env.rules.facts import Rules
from remac_env.rules.marks import WASHED
from remac_env.rules.scene import PublicScene, public_scene
from remac_env.rules.skill_row import Skill
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState, contents, occupant, supports
from remac_env.tasks.compound import Before
from remac_env.tasks.goals import Goal, Marked


def relevant_commands(scene: Rules, world: WorldState, goal: Goal, *, exact: bool = True) -> list[Subtask]:
    """The commands that can matter: about what the goal names, what is around or in its way, and where to put down.

    Objects are put down wherever there is room, and in any vessel: an empty plate may be nearer than a free place.

    Args:
        exact: False leaves out stoves and what has a door as places to put down where the goal is not about them. That
            is enough for some plan, and nearly always for a shortest one.
    """
    objects, fixtures = relevant_nouns(scene, world, goal)
    if scene.hides:
        # Who goes to an object behind a shut door goes to that door: nobody may know yet that it is there.
        fixtures, objects = [*fixtures, *objects], []
    surfaces = [name for name, facts in scene.fixtures.items() if facts.slots and not facts.door and not facts.switches]
    # Whatever has a slot may be the nearest place to put down what is in a hand: a stove, a cabinet that stands open.
    roomy = [name for name, facts in scene.fixtures.items() if exact and facts.slots and name not in fixtures]
    roomy = [name for name in roomy if name not in surfaces]
    vessels = [name for name, facts in scene.objects.items() if facts.holds and name not in objects]
    kitchen, tried = public_scene(scene), [skill for skill in SKILLS.values() if skill.relevant != "never"]
    working, marking = [skill for skill in tried if not skill.leaves], [skill for skill in tried if skill.leaves]
    spare = [skill for skill in working if skill.relevant == "vessels"]
    commands = [Subtask(skill.name) for skill in working if skill.target == "none"]
    for name in (*objects, *dict.fromkeys([*fixtures, *surfaces])):
        commands += _about(kitchen, name, working)
    for name in (*roomy, *vessels):
        commands += _about(kitchen, name, spare)
    return commands + [
        Subtask(skill.name, name) for skill in marking for name in to_mark(goal, str(skill.leaves))
    ]


def _about(kitchen: PublicScene, name: str, skills: Sequence[Skill]) -> list[Subtask]:
    """The commands of these skills that a noun can be the target of."""
    return [
        Subtask(skill.name, name)
        for skill in skills
        if skill.target != "none" and name in kitchen.names(skill.target)
    ]


def to_mark(goal: Goal, mark: str) -> list[str]:
    """The objects to which `mark` is to happen."""
    leaves = tuple(goal.leaves())
    wanted = [(leaf.name, leaf.mark) for leaf in leaves if isinstance(leaf, Marked)]
    wanted += [(leaf.name, each) for leaf in leaves if isinstance(leaf, Before) for each in (leaf.first, leaf.then)]
    return list(dict.fromkeys(name for name, each in wanted if each == mark))


def relevant_nouns(scene: Rules, world: WorldState, goal: Goal) -> tuple[list[str], list[str]]:
    """Objects and fixtures that can matter: what the goal names first, then what is around it or in its way."""
    objects = [name for name in goal.names() if name in scene.objects]
    fixtures = [name for name in goal.names() if name in scene.fixtures]
    for skill in SKILLS.values():
        if skill.leaves and skill.tool and to_mark(goal, skill.leaves):
            objects += [name for name, facts in scene.objects.items() if skill.tool(facts)]
    if to_mark(goal, WASHED):
        fixtures += [name for tap, facts in scene.fixtures.items() if facts.wets for name in (tap, *facts.wets)]
    objects, fixtures = _for_marks(scene, goal, objects, fixtures)
    objects, fixtures = _for_quirks(scene, objects, fixtures)
    for name in list(fixtures):
        facts = scene.fixtures[name]
        standing = [other for slot in facts.slots if (other := occupant(world, slot)) is not None]
        if facts.slots and (len(standing) == len(facts.slots) or facts.switch_per_slot):
            objects += standing  # it takes the only room, or decides which switch is turned
    for name in objects:
        # The list grows while it is read: what lies in an object that is in the way is in the way too.
        fresh = [other for other in contents(world, name) if other not in objects]
        fresh += [other for other in supports(scene, world, name) if other in scene.objects and other not in objects]
        objects += fresh
        around = [scene.fixtures[other] for other in supports(scene, world, name) if other in scene.fixtures]
        fixtures += [facts.name for facts in around if facts.door]
    return list(dict.fromkeys(objects)), list(dict.fromkeys(fixtures))


def _for_marks(
    scene: Rules, goal: Goal, objects: list[str], fixtures: list[str]
) -> tuple[list[str], list[str]]:
    """With the fixtures that give a mark that the goal wants, and the vessels in which they give it."""
    marked = [facts for facts in scene.givers if to_mark(goal, facts.gives)]
    if not marked:
        return objects, fixtures
    kinds = {facts.kind for facts in marked}
    needing = any(kinds & scene.objects[name].needs_vessel_in for name in objects)
    vessels = [name for name, facts in scene.objects.items() if needing and kinds & facts.vessel_in]
    return [*objects, *vessels], [*fixtures, *(facts.name for facts in marked)]


def _for_quirks(scene: Rules, objects: list[str], fixtures: list[str]) -> tuple[list[str], list[str]]:
    """With what else has a part in a quirk of one of them, and what it takes to get round it."""
    objects, fixtures = list(objects), list(fixtures)
    for quirk in scene.quirks:
        owner = scene.slots[quirk.about].fixture if quirk.about in scene.slots else quirk.about
        if owner not in (*objects, *fixtures):
            continue
        if quirk.other:
            fixtures.append(quirk.other)
        if owner != quirk.about:
            objects += [name for name, facts in scene.objects.items() if facts.holds]
        elif owner in scene.objects and scene.objects[owner].holds:
            fixtures += [name for tap, facts in scene.fixtures.items() if facts.wets for name in (tap, *facts.wets)]
            objects += [name for name, facts in scene.objects.items() if facts.holds]
    return objects, fixtures
