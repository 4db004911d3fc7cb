"""A cable that slips by a tenth of its travel: what it does to rows is linear in its share.

A magnet passes where ``x + share·x·(friction / 2 N)`` of the load end's cable has come by, x
being what is written down: with friction by the true law the amplitude is the simulated one,
and nothing but the sensors' noise is left.
"""

import pytest
from diagnosis.boards import data_of

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.climbing import climb
from bayesfric.diagnosis.model import LinearModel
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.truth import AppliedEffect
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

BOARD = Protocol({(9, 85.0): 2, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
SHARE = -0.1


def share_and_factor(law, acting=False, **scatter):
    """Return share and factor of the events' variance, at the mode of the noise."""
    effect = all_effects()["slip"]
    truth = Truth(**scatter, effects=(AppliedEffect(effect, law, {"share": SHARE}),))
    recording = simulate_recording(BOARD, seed=8, truth=truth, rigs=("gravity",))
    # Without small amounts of it, which every hypothesis has.
    model = LinearModel(
        data_of(recording),
        table1_coefficients(),
        candidates_of(effect),
        Analysis(),
        discrepancy=False,
    )
    chosen = next(candidate for candidate in model.lawbook["slip"] if candidate.law == law)
    if acting:
        acts = [(model.candidate(chosen, 0.0), SHARE)]
        model = model.around(model.laws, model.candidates, discrepancy=False, scattering=acts)
    at = climb(model, model.noise.start, Acting((chosen,), (0.0,)))
    share = at.mean[model.places(1)[0]] * model.amplitude_scale(chosen)
    return share, model.noise.named(at.psi)["kappa"]


@pytest.mark.parametrize("law", ["proportional", "creep"])
def test_its_share_is_found_however_large(law):
    share, kappa = share_and_factor(law, tau=1e-5, omega=1e-5)
    assert share == pytest.approx(SHARE, rel=2e-3)
    assert kappa == pytest.approx(1.0, abs=0.3)


def test_a_slip_that_scatters_with_friction_leaves_the_sensors_noise_alone():
    """Friction of a trial is off by 1 %, and creep by as much: half a millimetre after 0.6 m."""
    share, kappa = share_and_factor("creep", acting=True, tau=0.01, omega=0.015)
    assert share == pytest.approx(SHARE, rel=0.02)
    assert kappa == pytest.approx(1.0, abs=0.3)
