"""Who fills the roles: names and options become objects, whose answers are checked before a method sees them."""
