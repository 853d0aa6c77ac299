"""A kitchen as a robosuite arena: its description without robots, as robosuite reads, colours and groups it."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from robosuite.models.arenas import Arena

from remac_env.integrations.robosuite.episode import Episode
from remac_env.integrations.robosuite.textures import write_textures
from remac_env.kitchen import style as styles
from remac_env.kitchen.builder import build_spec
from remac_env.kitchen.canvas import COARSE_GROUP, COLLIDER_GROUP, DRAWN_GROUP, FINE_GROUP
from remac_env.rendering.cameras import FRONT, WIDE, add_cameras

_GROUPS = {COLLIDER_GROUP: 0, DRAWN_GROUP: 1, FINE_GROUP: 1}
"""Ours -> robosuite's, which weighs and hides group 0 and draws and tells apart group 1."""

CAMERAS = {"frontview": WIDE, "agentview": FRONT}
"""robosuite's usual cameras -> ours that stand there for them."""

_OWN_PARTS = ("option", "visual", "statistic")
"""Parts of a description that robosuite does not merge: the solver's settings, light and size of the scene."""

_FACTS = "remac"
"""What the text in a model is called from which its episode is drawn again: recorded models are read without more."""

_MEMORY = "64M"  # of a model's arena; robosuite's limits of contacts are no longer MuJoCo's way


class KitchenArena(Arena):  # type: ignore[misc]
    """An episode's kitchen with its objects; colliders only without `visual`."""

    def __init__(self, episode: Episode, *, visual: bool) -> None:
        root = ET.fromstring(_description(episode, visual=visual))
        _regroup(root)
        _name_cameras(root)
        with TemporaryDirectory() as folder:
            file = Path(folder, "kitchen.xml")  # robosuite reads arenas from files only
            ET.ElementTree(root).write(file)
            super().__init__(str(file))
        self._facts = json.dumps(episode.facts)

    def rule(self, model: Any, timestep: float) -> None:
        """Give a task's model our solver, light and memory, steps of `timestep` (s), and the facts of its episode."""
        for tag in (*_OWN_PARTS, "size"):
            for theirs in model.root.findall(tag):
                model.root.remove(theirs)
        model.root.extend(part for tag in _OWN_PARTS for part in self.root.findall(tag))
        model.root.find("option").set("timestep", repr(timestep))
        ET.SubElement(model.root, "size", memory=_MEMORY)
        ET.SubElement(ET.SubElement(model.root, "custom"), "text", name=_FACTS, data=self._facts)


def recorded_facts(text: str) -> dict[str, Any]:
    """The facts of a model's episode, empty where it has none."""
    root = ET.fromstring(text)
    found = root.find(f"custom/text[@name='{_FACTS}']")
    return {} if found is None else dict(json.loads(found.get("data", "{}")))


def _description(episode: Episode, *, visual: bool) -> str:
    """The kitchen as MJCF text."""
    style = styles.load(episode.start.style)
    spec = build_spec(episode.layout, robots=(), objects=episode.objects, style=style, visual=visual)
    add_cameras(spec, episode.layout, ())
    spec.compiler.degree = False
    write_textures(spec)
    # Each shadow and each mirror draws the kitchen once more: with them a picture takes eight times as long.
    for light in spec.lights:
        light.castshadow = False
    for material in spec.materials:
        material.reflectance = 0.0
    text: str = spec.to_xml()
    return text


def _regroup(root: ET.Element) -> None:
    """Put geoms into robosuite's groups, and leave out what is there for small pictures only."""
    coarse = str(COARSE_GROUP)
    for parent in [*root.iter("worldbody"), *root.iter("body")]:
        for geom in parent.findall("geom"):
            group = geom.get("group", "0")
            if group == coarse:
                parent.remove(geom)
            else:
                geom.set("group", str(_GROUPS.get(int(group), 1)))
    used = {geom.get("mesh") for geom in root.iter("geom")}
    for asset in root.iter("asset"):
        for mesh in asset.findall("mesh"):
            if mesh.get("name") not in used:
                asset.remove(mesh)


def _name_cameras(root: ET.Element) -> None:
    """Add robosuite's usual cameras, beside ours."""
    for parent in [*root.iter("worldbody")]:
        for camera in parent.findall("camera"):
            for theirs, ours in CAMERAS.items():
                if camera.get("name") == ours:
                    ET.SubElement(parent, "camera", {**camera.attrib, "name": theirs})
