"""Evidence of a density and leave-one-group-out densities; independent of friction."""
