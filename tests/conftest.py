"""Settings that all tests share."""

from __future__ import annotations

import hypothesis

hypothesis.settings.register_profile(
    "kitchen", deadline=None, derandomize=True, database=None, suppress_health_check=list(hypothesis.HealthCheck)
)
hypothesis.settings.load_profile("kitchen")
