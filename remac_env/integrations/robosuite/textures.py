"""Textures as files, which MJCF text can only point at. They are kept from one kitchen to the next."""

from __future__ import annotations

import hashlib
import os
import xml.etree.ElementTree as ET
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import TYPE_CHECKING

import cv2
import numpy as np

from remac_env.files import prepare_folder

if TYPE_CHECKING:
    import mujoco

FOLDER = "remac-kitchen-textures"
"""In the user's cache. Recorded models are known by it when they are played back elsewhere."""


def cache_folder() -> Path:
    """Where textures are kept: $XDG_CACHE_HOME, or ~/.cache."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home) / FOLDER


def write_textures(spec: mujoco.MjSpec) -> None:
    """Write the images of a description to files named by what is in them, and let it point there.

    Raises:
        OptionError: if the folder cannot be written.
    """
    images = [texture for texture in spec.textures if len(bytes(texture.data))]
    folder = prepare_folder(cache_folder(), "the folder of textures") if images else cache_folder()
    for texture in images:
        shape = (texture.height, texture.width, texture.nchannel)
        texture.file = str(_kept(folder, np.frombuffer(bytes(texture.data), np.uint8).reshape(shape)))
        texture.data = b""
        texture.width = texture.height = 0


def _kept(folder: Path, image: np.ndarray) -> Path:
    """The file of an image (height, width, 3), written unless it is there."""
    file = folder / f"{hashlib.sha256(repr(image.shape).encode() + image.tobytes()).hexdigest()[:24]}.png"
    if not file.exists():
        _, packed = cv2.imencode(".png", image[:, :, ::-1])
        # Written apart and moved: another process may be at the same.
        with NamedTemporaryFile(dir=folder, suffix=".part", delete=False) as part:
            part.write(packed.tobytes())
        os.replace(part.name, file)
    return file


def textures_here(text: str) -> str:
    """A recorded model's text, its textures looked for in this machine's folder."""
    root = ET.fromstring(text)
    for texture in root.iter("texture"):
        file = Path(texture.get("file", ""))
        if file.parent.name == FOLDER:
            texture.set("file", str(cache_folder() / file.name))
    return ET.tostring(root, encoding="unicode")


def missing(text: str) -> bool:
    """Whether a texture that a model points at is not there."""
    files = [Path(texture.get("file", "")) for texture in ET.fromstring(text).iter("texture")]
    return any(file.parent.name == FOLDER and not file.exists() for file in files)
