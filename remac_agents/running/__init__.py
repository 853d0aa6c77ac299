"""A method's run of one episode: the state of its plan, the book that is kept, the questions to its planner."""
