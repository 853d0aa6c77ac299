"""The planner whose answers lie in a JSON file: plans that were made elsewhere are played and scored.

    {"TaskA/7/0": [...], "TaskA/7": {...}, "TaskA": "Plan: [...]"}
The key is task/seed/iteration, or its beginning; the longest that fits counts. An answer is whatever a planner may
answer: a list, robot -> list, or text.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from remac_agents.plan import PlanError
from remac_agents.roles import PlanRequest
from remac_env.errors import OptionError
from remac_env.files import decode, read_bytes

MAX_BYTES = 50_000_000


class AnswersPlanner:
    """Looks answers up.

    Args:
        path: the JSON file.

    Raises:
        OptionError: if the file cannot be read, or is no JSON object.
    """

    needs_truth = needs_rules = False

    def __init__(self, path: str) -> None:
        self._path, self._seed, self._iteration = path, 0, 0
        self._answers = _read(Path(path))

    def begin_episode(self, seed: int, iteration: int) -> None:
        """Which seed and iteration it is."""
        self._seed, self._iteration = seed, iteration

    def plan(self, request: PlanRequest) -> Any:
        """The answer for this episode; for a method that plans step by step, what is left of a list."""
        parts = (str(request.episode.get("task", "")), str(self._seed), str(self._iteration))
        keys = ["/".join(parts[:size]) for size in (3, 2, 1)]
        found = next((key for key in keys if key in self._answers), None)
        if found is None:
            return PlanError(f"{self._path} has no answer under {', '.join(map(repr, keys))}")
        answer = self._answers[found]
        if request.single_step and isinstance(answer, list):
            return answer[sum(attempt.ran for attempt in request.history) :]
        return answer


def _read(path: Path) -> dict[str, Any]:
    try:
        answers = json.loads(decode(read_bytes(path, MAX_BYTES)))
    except (OSError, ValueError, RecursionError) as error:
        raise OptionError(f"answers {str(path)!r} cannot be read: {error}") from error
    if not isinstance(answers, dict):
        raise OptionError(f"answers {str(path)!r} is no JSON object; valid: task/seed/iteration -> answer")
    return answers
