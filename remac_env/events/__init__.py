"""The event clock: each robot is asked again when what it does has ended."""
