"""Jobs, processes, episodes: what is played, where, and by whom."""
