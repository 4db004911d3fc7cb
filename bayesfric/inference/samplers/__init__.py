"""Samplers, one in each file, which :mod:`bayesfric.inference.sampling` runs in pieces."""

from bayesfric.inference.samplers.base import Sampler, SamplingError
from bayesfric.inference.samplers.ensembles import Ensembles

__all__ = ["Ensembles", "Sampler", "SamplingError"]
