"""Evidence of a density and what leaving data out predicts; knows nothing of friction."""
