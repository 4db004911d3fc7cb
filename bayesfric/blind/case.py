"""One case: made, sealed and diagnosed; after its verdict is written, opened and scored.

The same case is also made without noise and scatter. The residual of a law that is recalibrated by
least squares is then the true systematic gap. The residual beside the named causes gives the true
shrink. :mod:`bayesfric.diagnosis.systematic` draws both.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.blind.design import BlindCase, Catalogue
from bayesfric.blind.envelope import open_envelope, seal
from bayesfric.blind.scoring import score
from bayesfric.diagnosis import diagnose
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals, residuals_of, spread_numbers
from bayesfric.diagnosis.systematic import best_of
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import Candidate, candidates_of
from bayesfric.errors import Fault, InputError, one_of
from bayesfric.files import write_whole
from bayesfric.observation.layout import COEFFICIENTS
from bayesfric.recording.tables import Recording
from bayesfric.results import json_bytes
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data
from bayesfric.schemas import DiagnosisFile
from bayesfric.simulate import table1_coefficients

FALSE_ALARMS = 0.02  # rate of the oracle, the same as promised for the diagnosis
ROUNDS = 2  # rounds of fitting the law and linearising around it


ENGINES = {
    "reference": "bayesfric.blind.engines.reference",
    "mujoco": "bayesfric.blind.engines.mujoco_board",
}
"""Independent simulators of reality, by name."""
VERDICT = "verdict.json"


class CleanCase:
    """A recording without noise, and the baseline that was fitted to it.

    Parameters
    ----------
    recording : Recording
        The recording without noise, with the paper's pulley sizes.
    analysis : Analysis
        Priors.

    Attributes
    ----------
    gap : float
        Rms of the residual friction over rms friction, with equal weight for each condition.
    """

    def __init__(self, recording: Recording, analysis: Analysis) -> None:
        opened = (rig.trials(recording, exclude=False) for rig in all_rigs().values())
        data = Data(tuple(trials for trials in opened if trials is not None))
        laws = {size: table1_coefficients()[size] for size in data.sizes}
        model = LinearModel(data, laws, (), analysis, discrepancy=False)
        # Noise of a usual rig, since these data have none.
        self._psi = np.log([noise.usual for noise in model.noise])
        for _ in range(ROUNDS - 1):
            laws = model.fitted_laws(model.evaluate(self._psi, Acting()))
            model = model.around(laws, (), discrepancy=False)
        self._model = model
        residuals = residuals_of(model, self._psi)
        force = self._systematic(model, residuals, Acting())
        self.gap = _rms(residuals, force) / residuals.friction_rms

    def shrink(self, causes: Sequence[tuple[str, str]]) -> float | None:
        """Return the share of the squared gap that some causes remove.

        Parameters
        ----------
        causes : sequence of (str, str)
            Name and law of each; its shape is the node that fits best.

        Returns
        -------
        float or None
            None if a cause has phases that are not recorded, or is no effect of bayesfric.
        """
        effects = all_effects()
        if not causes or self.gap <= 0.0:
            return None
        if any(name not in effects or effects[name].components for name, _ in causes):
            return None
        by_cause = [_candidates(name, law) for name, law in causes]
        every: list[Candidate] = [candidate for own in by_cause for candidate in own]
        model = self._model.around(self._model.laws, every, discrepancy=False)
        residuals = residuals_of(model, self._psi)
        # Each candidate is a law of its own here: shapes are at the nodes.
        laws = [
            replace(law, places=(place,), nodes=(node,))
            for each_law in model.lawbook.values()
            for law in each_law
            for place, node in zip(law.places, law.nodes, strict=True)
        ]
        ends = np.cumsum([len(own) for own in by_cause])
        own_laws = [
            [law for law in laws if end - len(own) <= law.places[0] < end]
            for own, end in zip(by_cause, ends, strict=True)
        ]
        columns = residuals.columns[:, COEFFICIENTS : COEFFICIENTS + model.layout.candidates]
        shrinks = []
        for choice in product(*own_laws):
            acting = Acting(choice, (0.0,) * len(choice))
            force = self._systematic(model, residuals, acting)
            own = residuals.without_law(columns @ model.mixing(acting))
            left = force - best_of(residuals, own, force)
            shrinks.append(1 - (_rms(residuals, left) / _rms(residuals, force)) ** 2)
        return max(shrinks)

    def oracle_power(self) -> float:
        """Return the power of the best test that knows the true force.

        It is the likelihood ratio test (Neyman and Pearson) at 2 % false alarms. Its
        signal-to-noise ratio is the norm of the residual of the refitted baseline, whitened by
        the measurement error and by the scatter of trials and of assemblies.
        """
        model, residuals = self._model, residuals_of(self._model, self._psi)
        rest = residuals.left(self._fitted(model, Acting()))
        square = 0.0
        for setup in np.unique(residuals.setup):
            rows = np.flatnonzero(residuals.setup == setup)
            trial = residuals.trial[rows]
            same = trial[:, None] == trial
            friction = residuals.friction_n[rows]
            sds = np.sqrt(residuals.scatter[rows])
            spread = np.outer(sds[:, 0], sds[:, 0]) * same + np.outer(sds[:, 1], sds[:, 1])
            covariance = spread * np.outer(friction, friction)
            for number in np.unique(trial):
                own = np.flatnonzero(trial == number)
                covariance[np.ix_(own, own)] += residuals.covariance[number]
            square += float(rest[rows] @ np.linalg.solve(covariance, rest[rows]))
        return float(ndtr(np.sqrt(square) + ndtri(FALSE_ALARMS)))

    def _systematic(self, model: LinearModel, residuals: Residuals, acting: Acting) -> Array:
        """Return the residual of a recalibrated law, without the trials' nuisance parameters."""
        local = self._fitted(model, acting)
        local[:, : COEFFICIENTS + model.layout.candidates] = 0.0
        return residuals.without_law(residuals.left(local))

    def _fitted(self, model: LinearModel, acting: Acting) -> Array:
        at = model.evaluate(self._psi, acting)
        return spread_numbers(model, at.mean, model.mixing(acting))


def engine_of(name: str) -> Any:
    """Return an engine's module.

    Raises
    ------
    InputError
        There is no such engine, or its dependencies are not installed.
    """
    if name not in ENGINES:
        expected = one_of(sorted(ENGINES), name)
        raise InputError([Fault("command line", expected, column="--engine", value=name)])
    if name == "mujoco" and find_spec("mujoco") is None:
        expected = 'an installation with MuJoCo: pip install ".[mujoco]" in a clone'
        raise InputError([Fault("command line", expected, column="--engine", value=name)])
    return import_module(ENGINES[name])


def catalogue_of(engine: str) -> Catalogue:
    """Return the effects that an engine can withhold."""
    module = engine_of(engine)
    effects = {}
    for name in module.effect_names():
        forms = [bool(form.own) for form in module.forms(name)]
        effects[str(name)] = (any(forms), not all(forms))
    return Catalogue(effects, tuple(module.outsider_names()))


def run_case(case: BlindCase, folder: Path, analysis: Analysis) -> dict[str, Any]:
    """Run one case.

    Parameters
    ----------
    case : BlindCase
        The withheld effects, and the seed.
    folder : Path
        Receives a folder with the case's name, with its envelope and its verdict. Workers on
        other machines write to their own folder of this name, if it is not shared.
    analysis : Analysis
        Settings of the diagnosis; the seed is that of the case.

    Returns
    -------
    dict
        A :class:`~bayesfric.schemas.scorecard.ScoredCase` as plain JSON types.
    """
    engine = engine_of(case.engine)
    withheld = engine.Withheld(case.kind, case.effects, case.form)
    made = engine.make(withheld, case.seed, design=case.design)
    # The diagnosis gets none of the engine's metadata on its recording.
    recording = replace(made.recording, name=case.name, title="A blind case", metadata={})
    public = {
        "name": case.name,
        "seed": case.seed,
        "engine": case.engine,
        "design": case.design,
        "recording_sha256": recording.sha256,
    }
    place = folder / case.name
    seal(place, made.truth, public, case.seed)
    diagnosis = diagnose_sealed(recording, analysis.model_copy(update={"seed": case.seed}), place)
    gap, shrink, power = 0.0, None, None
    if case.effects:
        clean = partial(engine.make, withheld, case.seed, design=case.design, noise=False)
        alone = CleanCase(clean(beside=False).recording, analysis)
        gap, power = alone.gap, alone.oracle_power()
        # The gap is that of the whole recording, including small amounts of other effects.
        whole = CleanCase(clean().recording, analysis)
        shrink = whole.shrink([(cause.effect, cause.law) for cause in diagnosis.causes])
    scored = score(
        *open_envelope(place),
        diagnosis,
        gap=gap,
        true_shrink=shrink,
        oracle_power=power,
        effect_names=all_effects(),
    )
    result: dict[str, Any] = scored.model_dump(mode="json")
    return result


def diagnose_sealed(recording: Recording, analysis: Analysis, place: Path) -> DiagnosisFile:
    """Diagnose a recording whose answer is sealed, and write the verdict beside it."""
    diagnosis = diagnose(recording, analysis).summary
    write_whole(place / VERDICT, json_bytes(diagnosis))
    return diagnosis


def _rms(residuals: Residuals, force: Array) -> float:
    return float(np.sqrt((residuals.weight * force**2).sum()))


def _candidates(name: str, law: str) -> list[Candidate]:
    """Return the candidates of a cause's law; a twin's law is called ``law (twin)``."""
    own, _, twin = law.partition(" (")
    effect = all_effects()[twin.removesuffix(")") or name]
    return [candidate for candidate in candidates_of(effect) if candidate.law == own]
