"""Hand-overs: how a plan that one robot has mastered is shared between two or more."""
