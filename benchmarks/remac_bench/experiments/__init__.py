"""The paper's plan-only experiments: seconds each, no physics."""
