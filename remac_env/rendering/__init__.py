"""Pictures of a kitchen: with OpenGL where it works, else with rays."""
