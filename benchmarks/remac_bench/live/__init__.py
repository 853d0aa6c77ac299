"""Pages that a small server on loopback serves: a run as it goes on, and an episode that a person plays."""
