"""Adjusters: who changes a plan whose next subtask is not ready."""
