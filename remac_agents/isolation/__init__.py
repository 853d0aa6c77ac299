"""Roles of one's own in processes of their own: no kitchen, no truth and no other job is within their reach."""
