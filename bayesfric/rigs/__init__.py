"""The seam between rigs and everything that is inferred from them, a folder a rig."""
