"""Simulation-based calibration: truths from a prior, recordings of them, and their ranks."""
