"""Proof of records: jobs are played again and compared, folders are held against their suite's list, and submissions
are packed, accepted and shown.

What re-execution cannot prove is said where it matters: which model wrote a cassette, how long anything took on the
wall, and, where no cassette lies beside the records, who chose the subtasks.
"""
