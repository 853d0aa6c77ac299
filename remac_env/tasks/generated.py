"""The task that is another one with every seed: `remac_env.generator` says which. Not in the list of tasks."""

from __future__ import annotations

from remac_env.tasks.goals import All
from remac_env.tasks.spec import TaskSpec

SPEC = TaskSpec(
    name="Generated",
    wordings=("what each episode says", "what each episode says", "what each episode says"),
    goal=All(),
    roles=(),
    fixtures=(),
)
