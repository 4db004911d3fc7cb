"""Likelihoods, each the mirror of the simulator, and the model that joins them."""
