"""The benchmark around the kitchens and the agents: jobs, records, metrics, and the command `remac`."""
