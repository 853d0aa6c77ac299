"""One skill as a Gymnasium environment at 20 Hz, for policies that move robots: docs/learning.md, "Skills"."""
