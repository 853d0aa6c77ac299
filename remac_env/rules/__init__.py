"""What is possible and right in a kitchen: facts, predicates, skills, claims and rounds, as rows and pure functions."""
