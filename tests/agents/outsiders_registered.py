"""Registers the outsiders' tasks when it is imported, as `remac bench run --import` does."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import outsiders  # noqa: E402

outsiders.register()
