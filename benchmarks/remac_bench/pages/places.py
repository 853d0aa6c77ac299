"""Where pages lie in the folder of their records."""

LEADERBOARD = "leaderboard.html"
EPISODES = "episodes"
TABLES = "tables"
"""What stands beside the records: the first page, and the folders of the others and of tables as pictures."""
