"""Pictures as the network takes them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_agents.vision.network import SIZE
from remac_env.simulator import load_opencv


def fitted(picture: Any) -> NDArray[np.uint8]:
    """A picture, uint8 (height, width, 3), as one of (SIZE, SIZE, 3): averaged, or drawn out where it is smaller."""
    given = np.asarray(picture)
    if given.shape == (SIZE, SIZE, 3):
        return given.astype(np.uint8, copy=False)
    cv2 = load_opencv()
    shrinks = min(given.shape[:2]) >= SIZE
    return np.asarray(
        cv2.resize(given, (SIZE, SIZE), interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR), np.uint8
    )
