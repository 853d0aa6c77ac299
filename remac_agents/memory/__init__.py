"""What runs taught, kept from iteration to iteration: `Memory` is the paper's reflection database."""

from remac_agents.memory.database import MAX_CHARACTERS, MAX_LESSONS, Memory, Run, prune_file

__all__ = ["MAX_CHARACTERS", "MAX_LESSONS", "Memory", "Run", "prune_file"]
