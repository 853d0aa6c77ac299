"""One tiny question to each language model before jobs are played: what works, and what the run may cost."""
