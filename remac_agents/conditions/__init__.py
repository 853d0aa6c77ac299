"""Condition makers: what should be true before and after a subtask."""
