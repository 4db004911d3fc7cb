"""The trials of the gravity board that are used in a fit or a diagnosis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array, evenly
from bayesfric.effects import Effect
from bayesfric.effects.candidates import Candidate
from bayesfric.effects.terms import ActiveEffect
from bayesfric.errors import Fault, InputError
from bayesfric.observation.coefficients import law_of_rows
from bayesfric.observation.exact import ExactLikelihood
from bayesfric.observation.feasible import every_condition, levels_of
from bayesfric.physics.cable import Cable
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import TRAVEL_M, coulomb_acceleration, nominal_tension
from bayesfric.physics.laws import BASELINES, FrictionLaw
from bayesfric.recording.frames import stands_in
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.base import Predictive, Resting, Rig, RigTrials, Unsupported
from bayesfric.rigs.gravity_board.estimator import PaperEstimate, estimate_as_the_paper
from bayesfric.rigs.gravity_board.likelihood import GravityModel
from bayesfric.rigs.gravity_board.linear import LinearEvents
from bayesfric.rigs.gravity_board.linear_scatter import EVENT_SD_M
from bayesfric.rigs.gravity_board.measured_motion import MeasuredMotion, measured_motion
from bayesfric.rigs.gravity_board.places import TrialPlaces
from bayesfric.rigs.gravity_board.predictions import curves, trajectories
from bayesfric.rigs.gravity_board.predictions import trials as trials_dataset
from bayesfric.rigs.gravity_board.screening import RULES, SELECTS_ON, Screened, screen_trials
from bayesfric.rigs.gravity_board.sensor_agreement import MATERIAL_SHARE, SensorAgreement
from bayesfric.rigs.gravity_board.slopes import paper_slopes
from bayesfric.rigs.gravity_board.stretch import friction_ratios
from bayesfric.rigs.gravity_board.trial_motion import pilot_fits, trial_condition
from bayesfric.schemas.fit import Agreement, Clocks, Excluded, PointEstimate, Repaired

PAIRS_OF_MASSES = 10  # pairs of masses that are planned for each size
MOVING_M_S2 = 0.1  # acceleration below which a planned trial might stall
DISAGREEING_SHARE = 0.1  # of trials with disagreeing sensors, beyond which the rig is the cause


@dataclass(frozen=True)
class GravityTrials(RigTrials):
    """Trials that are used; those of an assembly are adjacent.

    Parameters
    ----------
    rig : Rig
        The kind of rig.
    constants : RigConstants
        Constants of the board.
    gravity : Gravity
        Trials and their repaired events.
    screened : Screened
        Used and excluded trials, with the rules.
    source : Gravity
        All recorded trials and events.
    at_rest : DataFrame
        Trials that did not move, which the likelihood uses as bounds.
    law : FrictionLaw
        Law around which a diagnosis linearises.
    event_error_m : float or None
        Rms error of the events of planned trials [m]; None for recorded trials, whose events
        determine it.
    loads : tuple of str
        Columns that define a condition, together with size, number and wrap angle.
    """

    rig: Rig
    constants: RigConstants
    gravity: Gravity
    screened: Screened
    source: Gravity
    at_rest: pd.DataFrame
    law: FrictionLaw = BASELINES["paper"]
    event_error_m: float | None = None
    loads: tuple[str, ...] = ("mass_drive_kg", "mass_load_kg")

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row for each trial."""
        return self.gravity.trials

    @property
    def slowest_speed_m_s(self) -> float:
        """Lowest speed at any event; infinite without events [m/s]."""
        events, trials = self.gravity.events, self.gravity.trials
        if events.empty:
            return float("inf")
        with_events = stands_in(trials["trial"], events["trial"])
        return float(pilot_fits(events, trials["trial"][with_events]).least_speed.min())

    def levels(self, name: str) -> int:
        """Return the number of values of a column; ``tension`` is the sum of both masses."""
        trials = self.gravity.trials
        if name == "tension":
            return int((trials["mass_drive_kg"] + trials["mass_load_kg"]).round(2).nunique())
        return int(trials[name].nunique())

    def select(self, keep: "pd.Series[bool]") -> "GravityTrials | None":
        """Return the trials that a mask selects, and those at rest of their sizes."""
        trials = self.gravity.trials[keep].reset_index(drop=True)
        events = self.gravity.events
        events = events[events["trial"].isin(trials["trial"])].reset_index(drop=True)
        if trials.empty:
            return None
        still = self.at_rest[self.at_rest["pulley_size"].isin(trials["pulley_size"])]
        return replace(self, gravity=Gravity(trials, events), at_rest=still.reset_index(drop=True))

    def moved(self) -> "GravityTrials | None":
        """Return the trials that moved over their whole travel; None if all or none did."""
        stalled = self.table["trial"].isin(self.screened.stalled) | self._held_back
        if self.at_rest.empty and not stalled.any():
            return None
        rest = self.select(~stalled)
        return None if rest is None else replace(rest, at_rest=self.at_rest.iloc[:0])

    @property
    def _held_back(self) -> "pd.Series[bool]":
        """Which trials without events did not accelerate in the direction of the drive."""
        trials = self.table
        if "acceleration_m_s2" not in trials:
            return pd.Series(data=False, index=trials.index)
        without_events = ~stands_in(trials["trial"], self.gravity.events["trial"])
        return without_events & (trials["acceleration_m_s2"] <= 0)

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why the likelihood cannot contain an effect; None if it can."""
        return self.places.supports(effect)

    @cached_property
    def places(self) -> TrialPlaces:
        """States of the trials and their tabulated events, which all likelihoods share."""
        return TrialPlaces(self.gravity, self.constants)

    @cached_property
    def measured(self) -> MeasuredMotion:
        """The measured motion, independent of any law."""
        motion = measured_motion(self.gravity, self.constants)
        if self.event_error_m is None:
            return motion
        return motion._replace(residual=np.full_like(motion.residual, self.event_error_m))

    def linear(
        self, laws: Mapping[str, Coefficients], acting: Sequence[tuple[Candidate, float]] = ()
    ) -> LinearEvents:
        """Return the events as rows of a linear model."""
        return LinearEvents(self.gravity, self.constants, laws, self.measured, acting, self.law)

    def entering(self) -> "GravityTrials":
        """Return the trials that a diagnosis uses.

        Trials that did not move, or stopped, are not used, because a diagnosis estimates forces
        along the whole travel. If the sensors disagree in many trials, the cause is the rig, and
        the diagnosis should find it. These trials are therefore used.
        """
        if self._held_back.all():
            expected = "a trial that enters a diagnosis: one whose acceleration is above 0"
            raise InputError([Fault("gravity_trials.csv", expected, column="acceleration_m_s2")])
        excluded = self.screened.excluded
        disagreeing = [trial for trial, rule in excluded.items() if rule == "sensors-disagree"]
        if len(disagreeing) <= DISAGREEING_SHARE * len(self.recorded):
            return self.moved() or self
        screened = screen_trials(self.source, self.constants, exclude=False)
        whole = replace(self, gravity=screened.gravity, screened=screened)
        kept = whole.select(~whole.table["trial"].isin(set(excluded) - set(disagreeing)))
        assert kept is not None
        return kept.moved() or kept

    def planned(self, laws: Mapping[str, Coefficients]) -> "GravityTrials | None":
        """Return trials in the recorded conditions that move by a law, with noise-free events."""
        used = self.gravity.trials
        sensors = tuple(dict.fromkeys(self.gravity.events["sensor"])) or ("drive",)
        gravity = with_predicted_events(used, self.constants, laws, sensors)
        none = self.at_rest.iloc[:0]
        return None if gravity is None else replace(self, gravity=gravity, at_rest=none)

    def next_trials(self, laws: Mapping[str, Coefficients]) -> "GravityTrials | None":
        """Return a trial in every feasible condition; see :func:`feasible_trials`."""
        gravity = feasible_trials(self.gravity.trials, self.constants, laws)
        if gravity is None:
            return None
        residual = self.measured.residual
        error = float(np.sqrt(np.mean(residual**2))) if residual.size else EVENT_SD_M
        return replace(self, gravity=gravity, at_rest=self.at_rest.iloc[:0], event_error_m=error)

    def likelihood(
        self,
        analysis: Analysis,
        law: FrictionLaw = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
    ) -> ExactLikelihood:
        """Return the density of the event times."""
        return ExactLikelihood(
            GravityModel(
                self.gravity, self.constants, analysis, law, effects, self.at_rest, self.places
            )
        )

    def stretch_ratios(self, cable: Cable, theta: Mapping[str, Array]) -> Array | Unsupported:
        """Return the ratio of friction by model (3) to model (4) for each trial with events."""
        trials, events = self.gravity.trials, self.gravity.events
        seen = stands_in(trials["trial"], events["trial"])
        if not seen.any():
            return Unsupported("No trial has Hall events, which would show a stretch.")
        with_events = Gravity(trials[seen].reset_index(drop=True), events)
        sigma_x, sigma_t = (float(np.median(theta[name])) for name in ("sigma_x", "sigma_t"))
        return friction_ratios(with_events, self.constants, cable, sigma_x, sigma_t)

    @cached_property
    def recorded(self) -> pd.DataFrame:
        """All recorded trials."""
        return self.source.trials

    @property
    def excluded(self) -> Mapping[str, str]:
        """Excluded trials, each with the name of a rule of :data:`.screening.RULES`."""
        return self.screened.excluded

    def quality(self) -> Mapping[str, Any]:
        """Return numbers of trials, assemblies and events, and irregularities of the data."""
        trials, screened = self.gravity.trials, self.screened
        cells = trials.groupby(["pulley_size", "n_pulleys", "wrap_angle_deg"])["setup"].nunique()
        return {
            "trials": len(self.recorded),
            "trials_used": len(trials) + len(self.at_rest),
            "setups": trials["setup"].nunique(),
            "events": len(self.gravity.events),
            "replicated_cells": int((cells > 1).sum()),
            "excluded": tuple(
                Excluded(trial=trial, rule=rule, reason=RULES[rule], selects_on=SELECTS_ON[rule])
                for trial, rule in screened.excluded.items()
            ),
            "repaired": tuple(
                Repaired.model_validate(row) for row in screened.repaired.to_dict("records")
            ),
            "agreement": _agreement(screened.agreement),
            "clocks": Clocks(
                trials=int(screened.clocks.trials["same_motion"].sum()),
                late_s=screened.clocks.late_s,
                sd_s=screened.clocks.sd_s,
                allowed_sd_s=screened.clocks.allowed_sd_s,
            ),
            "stalled": screened.stalled,
            "did_not_move": tuple(self.at_rest["trial"]),
        }

    def paper_estimates(self) -> Mapping[str, PointEstimate]:
        """Return the estimate by the paper's method for each pulley size, eqs (6) to (15)."""
        return {
            size.pulley_size: PointEstimate(
                c1=size.c1.value,
                c1_why=size.c1.reason,
                c2=size.c2.value,
                c2_why=size.c2.reason,
                c3=size.c3.value,
                c3_why=size.c3.reason,
            )
            for size in self.estimate.sizes
        }

    @cached_property
    def estimate(self) -> PaperEstimate:
        """The paper's estimator, run on these trials."""
        return estimate_as_the_paper(self.gravity, self.constants)

    def predicted(self, view: Predictive) -> xr.Dataset:
        """Return observed friction, and predicted friction of a new trial on a new assembly."""
        return trials_dataset(self._model_of(view), self.recorded, view)

    def resting(self, conditions: pd.DataFrame) -> Resting:
        """Return tension and driving force of both masses at rest."""
        condition = trial_condition(conditions, self.constants)
        return Resting(nominal_tension(condition, 0.0), condition.drive_force_n)

    def figures(self, view: Predictive) -> Mapping[str, xr.Dataset]:
        """Return friction against tension, the paper's slopes, and a few trajectories."""
        model, board = self._model_of(view), (self.gravity, self.constants)
        assert isinstance(view.likelihood, ExactLikelihood)
        figures = {"curves": curves(model, view.named, view.law)}
        figures |= paper_slopes(
            view.likelihood, model, self.estimate, view.named, view.law, view.rng
        )
        figures["trajectories"] = trajectories(model, *board, view.named, view.factor, view.law)
        return figures

    @staticmethod
    def _model_of(view: Predictive) -> GravityModel:
        assert isinstance(view.likelihood, ExactLikelihood)
        assert isinstance(view.likelihood.model, GravityModel)
        return view.likelihood.model


def _agreement(agreement: SensorAgreement) -> Agreement:
    trials = agreement.trials
    size = np.abs(trials["z"].to_numpy(dtype=np.float64))
    return Agreement(
        trials=len(trials),
        largest_z=float(size.max()) if size.size else None,
        z_q95=float(np.quantile(size, 0.95)) if size.size else None,
        limit_z=agreement.limit,
        limit_friction_share=MATERIAL_SHARE,
        disagreeing=tuple(trials["trial"][trials["disagrees"].astype(bool)]),
    )


def feasible_trials(
    measured: pd.DataFrame, rig: RigConstants, laws: Mapping[str, Coefficients]
) -> Gravity | None:
    """Return a trial in every feasible condition that moves, with noise-free events by a law.

    Parameters
    ----------
    measured : DataFrame
        Recorded trials.
    rig : RigConstants
        Constants of the board.
    laws : mapping of str to Coefficients
        Coefficients of each pulley size.

    Returns
    -------
    Gravity or None
        Trials and events; None if no trial moves.
    """

    def levels(own: pd.DataFrame) -> list[pd.DataFrame]:
        masses = own[["mass_drive_kg", "mass_load_kg"]].drop_duplicates()
        order = np.argsort((masses["mass_drive_kg"] - masses["mass_load_kg"]).to_numpy())
        pairs = masses.iloc[order[evenly(order.size, PAIRS_OF_MASSES)]]
        return [levels_of(own["n_pulleys"]), levels_of(own["wrap_angle_deg"]), pairs]

    trials = every_condition(measured, levels)
    return with_predicted_events(trials, rig, laws, ("drive",))


def with_predicted_events(
    trials: pd.DataFrame,
    rig: RigConstants,
    laws: Mapping[str, Coefficients],
    sensors: Sequence[str],
) -> Gravity | None:
    """Return the trials that move by a law, with noise-free events.

    Parameters
    ----------
    trials : DataFrame
        Conditions of trials; other columns are kept unchanged.
    rig : RigConstants
        Constants of the board.
    laws : mapping of str to Coefficients
        Coefficients of each pulley size.
    sensors : sequence of str
        Sensors that record the events.

    Returns
    -------
    Gravity or None
        Trials and events; None if no trial moves.
    """
    law = law_of_rows(laws, trials["pulley_size"])
    rate = coulomb_acceleration(law, trial_condition(trials, rig))
    moving = rate > MOVING_M_S2
    trials = trials[moving].reset_index(drop=True)
    if trials.empty:
        return None
    spacing = rig.hall_spacing_m or 0.01
    place = np.arange(spacing / 2, rig.limits.get("travel_m", (0.0, TRAVEL_M))[1], spacing)
    time = np.sqrt(2 * place / rate[moving][:, None])
    events_of_sensor = {
        "trial": np.repeat(trials["trial"].to_numpy(), place.size),
        "displacement_m": np.tile(place - place[0], len(trials)),
        "time_s": time.ravel(),
    }
    events = pd.concat([pd.DataFrame({**events_of_sensor, "sensor": sensor}) for sensor in sensors])
    return Gravity(trials, events.reset_index(drop=True))
