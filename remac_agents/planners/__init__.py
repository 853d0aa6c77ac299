"""Planners: who makes the plan of an episode."""
