"""Recordings whose effect is withheld, and the performance of the diagnosis on them."""
