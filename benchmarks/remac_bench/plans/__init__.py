"""One plan: asked of a planner, and judged by the skill table and the certificate."""
