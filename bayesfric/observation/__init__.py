"""What a rig says of its data, and the two engines that are made of it once for all rigs.

The contract is `docs/decisions/observation.md`. :mod:`.exact` makes the density of the raw
data, for fits and claims. No file here knows a rig.
"""
