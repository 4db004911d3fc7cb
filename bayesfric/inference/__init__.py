"""Densities, their modes, draws and evidence; nothing here knows what friction is."""
