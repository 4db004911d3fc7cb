"""Margins of a cable-driven control loop under the uncertainty of its friction."""
