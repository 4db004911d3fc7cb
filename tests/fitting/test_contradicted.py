"""Data that are far from what was known beforehand are told, as a wrong unit makes them."""

from types import SimpleNamespace

from bayesfric.analysis import HalfNormal, Normal
from bayesfric.attention.fit import contradicted
from bayesfric.inference.priors import Parameter


def test_a_mass_in_another_unit_than_the_log_is_told_and_one_that_fits_is_not():
    mass = Parameter("mass", "kg·m²", Normal(mean=2.0, sd=0.4))
    coulomb = Parameter("coulomb", "N·m", HalfNormal(scale=0.3))
    posterior = {
        "mass": SimpleNamespace(mean=0.035, sd=0.01),
        "coulomb": SimpleNamespace(mean=1.5, sd=0.01),
    }
    (line,) = contradicted([mass, coulomb], posterior)
    assert line.startswith("Parameter mass is 0.035, and 2 ± 0.4 by its prior: 4.9 standard")
    assert "check the units in the recording and of the prior" in line
    posterior["mass"] = SimpleNamespace(mean=0.5, sd=0.01)  # 3.75, and surely so
    (line,) = contradicted([mass, coulomb], posterior)
    assert "from the 2 that is declared" in line
    posterior["mass"] = SimpleNamespace(mean=1.4, sd=0.01)  # 1.5
    assert not list(contradicted([mass, coulomb], posterior))


def test_a_prior_of_a_size_that_pulls_is_told_with_what_it_takes_off():
    """Data say 3 ± 0.1 N, and the prior has a scale of 0.1 N: half of it is left."""
    coulomb = Parameter("c2", "N", HalfNormal(scale=0.1))
    sd = (1 / 0.1**2 + 1 / 0.1**2) ** -0.5
    posterior = {"c2": SimpleNamespace(mean=3.0 * sd**2 / 0.1**2, sd=sd)}
    (line,) = contradicted([coulomb], posterior)
    assert "c2 is 1.5 N, 15 times the scale of its prior" in line
    assert "pulls it down by some 1.5 N" in line
    sharp = {"c2": SimpleNamespace(mean=3.0, sd=5e-4)}  # moved by a sixth of its error
    assert not list(contradicted([coulomb], sharp))
