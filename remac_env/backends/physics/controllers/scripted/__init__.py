"""The controllers of the kitchen itself: motions planned by hand-written rules, one file a skill."""
