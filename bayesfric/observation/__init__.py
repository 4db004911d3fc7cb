"""Observation models of rigs, and the two engines that are built from them for all rigs.

The contract is `docs/decisions/observation.md`. :mod:`.exact` computes the density of the raw
data, for fits and claims. No file of this folder refers to a particular rig.
"""
