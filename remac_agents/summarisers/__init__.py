"""Summarisers: who tells what happened in an episode, and why it failed."""
