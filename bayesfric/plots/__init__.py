"""Figures: a stored result becomes a matplotlib Figure, in the style of `style`."""
