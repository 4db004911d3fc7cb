"""Densities, their modes, draws and evidences; no file of this folder refers to friction."""
