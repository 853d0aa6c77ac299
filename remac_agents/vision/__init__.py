"""Judging conditions by pictures with a small network: what it is asked, the network itself, and its weights."""
