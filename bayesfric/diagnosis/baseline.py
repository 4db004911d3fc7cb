"""The trials that are diagnosed, and the law fitted to them without effects."""

from collections.abc import Callable, Mapping

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.climbing import climb
from bayesfric.diagnosis.model import LinearModel
from bayesfric.errors import Fault, InputError
from bayesfric.observation.coefficients import coefficient_name, law_of
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import FrictionLaw
from bayesfric.recording.tables import Recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import beside_simulator, diagnosed_law, left_out
from bayesfric.simulators import SimulatorCalls


def data_of(
    recording: Recording, baseline: str, simulator: SimulatorCalls | None
) -> tuple[Data, FrictionLaw]:
    """Return the trials that a diagnosis uses, and the law of the given name.

    Raises
    ------
    InputError
        There is no rig to diagnose, or the law is unknown.
    """
    opened = [rig.trials(recording) for rig in all_rigs().values()]
    there = [rig for rig in opened if rig is not None]
    if simulator is not None:
        there = beside_simulator(there, simulator)
    law = diagnosed_law(baseline, there)
    rigs = tuple(rig.under(law).entering() for rig in there)
    data = Data(tuple(rig for rig in rigs if not rig.table.empty))
    if not data.rigs:
        names = " or ".join(dict.fromkeys(rig.words.trial for rig in all_rigs().values()))
        none = Fault(recording.name, f"a {names} that enters the diagnosis")
        raise InputError([none, *left_out(recording)])
    return data, law


def fitted_baseline(
    data: Data,
    analysis: Analysis,
    fixed: frozenset[str],
    shipped: Mapping[str, Coefficients],
    law: FrictionLaw,
    climb: Callable[..., At] = climb,
) -> tuple[Data, tuple[str, ...], dict[str, Coefficients], Array]:
    """Fit the law, exclude stray trials, and fit again; `climb` finds the mode.

    Returns
    -------
    data : Data
        Trials without strays.
    stray : tuple of str
        Ids of the strays.
    laws : dict of str to Coefficients
        The fitted law of each pulley size.
    psi : ndarray
        Logarithms of the noise parameters.
    """
    laws = _rough_laws(data, analysis, law)
    for size, own in shipped.items():
        if size in laws:
            names = set(Coefficients._fields) - set(law.without)
            kept = [
                f in names and bool({f, coefficient_name(f, size)} & fixed)
                for f in Coefficients._fields
            ]
            laws[size] = Coefficients(
                *(s if k else r for s, r, k in zip(own, laws[size], kept, strict=True))
            )
    stray: tuple[str, ...] = ()
    psi: Array | None = None
    for last in (False, True):
        model = LinearModel(data, laws, (), analysis, fixed | frozenset(law.without))
        at = climb(model, model.noise.start if psi is None else psi, Acting())
        psi, laws = at.psi, model.fitted_laws(at)
        if not last:
            stray = tuple(name for rig in data.rigs for name in rig.linear(laws).strays())
            left = (rig.select(~rig.table["trial"].isin(stray)) for rig in data.rigs)
            data = Data(tuple(rig for rig in left if rig is not None)) if stray else data
    assert psi is not None
    return data, stray, laws, psi


def _rough_laws(data: Data, analysis: Analysis, law: FrictionLaw) -> dict[str, Coefficients]:
    """Return starting values of the laws from the rigs' likelihoods, without effects."""
    start: dict[str, float] = {}
    for rig in reversed(data.rigs):
        start |= rig.likelihood(analysis, law).start()
    none = dict.fromkeys(law.without, 0.0)
    return {size: law_of(start, size)._replace(**none) for size in data.sizes}
