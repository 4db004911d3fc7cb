"""Bayesian uncertainty analysis of cable-pulley friction."""
