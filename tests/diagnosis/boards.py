"""Small recordings and the linear models of them."""

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.model import LinearModel
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording, table1_coefficients

SMALL = Protocol({(9, 85.0): 2, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)


def data_of(recording):
    opened = (rig.trials(recording, exclude=False) for rig in all_rigs().values())
    return Data(tuple(rows for rows in opened if rows is not None))


def model_of(names=(), *, seed=5, protocol=SMALL, **options):
    """Return a model of a simulated recording, with some effects as candidates."""
    data = data_of(simulate_recording(protocol, seed=seed, rigs=("gravity", "motor")))
    candidates = [candidate for name in names for candidate in candidates_of(all_effects()[name])]
    return LinearModel(data, table1_coefficients(), candidates, Analysis(), **options)
