"""What moves robots: each 50 ms a command, from what is sensed."""
