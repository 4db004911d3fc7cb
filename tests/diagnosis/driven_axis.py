"""The linear model of a driven axis, with the effects that it can show as candidates."""

from rigs.driven_mass import Machine, simulate, write

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.baseline import data_of, fitted_baseline
from bayesfric.diagnosis.examined import examinable
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.shipped import shipped_of
from bayesfric.recording import read_recording
from bayesfric.rigs.opening import with_own_priors


def fitted_axis(folder):
    """Return what :func:`model_of_axis` is made of: a simulated axis with its law fitted.

    Parameters
    ----------
    folder : Path
        The recording is written there.
    """
    machine = Machine()
    table, samples = simulate(machine, runs=4, seconds=6.0, seed=3)
    recording = read_recording(write(folder / "axis", machine, table, samples))
    data, law = data_of(recording, "paper", None)
    analysis = with_own_priors(Analysis(), data.rigs)
    data, _, laws, psi = fitted_baseline(data, analysis, frozenset(), shipped_of(None, data), law)
    return data, laws, analysis, frozenset(law.without), psi


def model_of_axis(fitted, chosen):
    """Return a model of an axis without any effect, and its noise.

    Parameters
    ----------
    fitted : tuple
        Of :func:`fitted_axis`.
    chosen : callable
        From an effect to its candidates.
    """
    data, laws, analysis, without, psi = fitted
    examined, _ = examinable(data, {})
    candidates = [candidate for effect in examined.values() for candidate in chosen(effect)]
    return LinearModel(data, laws, candidates, analysis, without), psi
