"""Why an episode failed: it is played again, and labelled with who brought it down and in which round."""
