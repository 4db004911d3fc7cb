"""Forward physics, without priors and without noise: the friction law and each rig's motion."""
