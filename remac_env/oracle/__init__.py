"""The oracle: shortest plans by exact search over rounds of the skill table, and what is proven about them."""

from remac_env.oracle.certificate import Certificate, certify, solvable, solve
from remac_env.oracle.commands import relevant_commands
from remac_env.oracle.distance import FARTHEST, Distances
from remac_env.oracle.moves import LITTER_ROUNDS
from remac_env.oracle.problems import problem_id
from remac_env.oracle.search import Found, OraclePlan, most_states, search, search_plan
from remac_env.oracle.shortest import shortest

__all__ = [
    "FARTHEST",
    "LITTER_ROUNDS",
    "Certificate",
    "Distances",
    "Found",
    "OraclePlan",
    "certify",
    "most_states",
    "problem_id",
    "relevant_commands",
    "search",
    "search_plan",
    "shortest",
    "solvable",
    "solve",
]
