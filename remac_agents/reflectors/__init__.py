"""Reflectors: who puts into words what a failed pre-check teaches."""
