"""Recordings whose effect is withheld, and how well the diagnosis does on them."""
