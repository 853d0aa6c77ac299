"""Checkers: who judges whether a condition is true."""
