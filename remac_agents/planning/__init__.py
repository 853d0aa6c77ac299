"""What rules work out about plans: who stands where, what is superfluous, what can be shared, what was learnt."""
