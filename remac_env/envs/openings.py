"""What an environment begins with: the space of its observations, and what may be asked of a reset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces

from remac_env.errors import OptionError
from remac_env.options import Options
from remac_env.quoting import quoted
from remac_env.values import python_values


def observation_space(options: Options, *, facts: int, tokens: int) -> spaces.Space[Any]:
    """The space of one robot's observations.

    Args:
        facts: figures of the vector. tokens: of the vocabulary.
    """
    size = options.image_size
    if options.obs_format == "flat":
        return spaces.Box(0.0, 1.0, (facts,), np.float32)
    parts: dict[str, spaces.Space[Any]] = {
        "observation": spaces.Box(0.0, 1.0, (facts,), np.float32),
        "action_mask": spaces.Box(0, 1, (tokens,), np.int8),
    }
    parts |= {camera: spaces.Box(0, 255, (size, size, 3), np.uint8) for camera in options.pictures}
    return spaces.Dict(parts)


def reset_options(options: Mapping[str, Any] | None) -> dict[str, Any]:
    """The options of a reset as Python's values.

    Raises:
        OptionError: unless it is a mapping or None.
    """
    if options is not None and not isinstance(options, Mapping):
        raise OptionError(f"options {quoted(options)} is not valid; valid: a mapping, such as {{'style': 'modern_1'}}")
    return python_values(dict(options or {}))
