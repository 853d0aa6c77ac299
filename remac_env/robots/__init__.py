"""What robots are made of: the protocol of bodies, the bodies there are, and the mobile Panda as one of them."""
