"""Learned skills: recording demonstrations, training networks on them, and measuring what was learnt."""
