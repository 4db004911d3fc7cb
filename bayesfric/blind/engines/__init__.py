"""Realities of another hand: boards that share no physics with the rest of the package.

They import the recording format, numpy and scipy, and nothing else of ours.
"""
