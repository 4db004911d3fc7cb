"""Forward physics of each rig: from a friction law and a condition to motion.

One module a rig; no priors and no noise here.
"""
