"""The learned controller: a network that was trained on recorded motion, played with NumPy."""
