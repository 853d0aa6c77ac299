"""Texts that people and models write, read strictly: plans, reasoning, options, JSON."""
