"""The joints of a diagnosis: numbers to enter of each, and their joint draws."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from bayesfric.arrays import Array
from bayesfric.attention.diagnosis import why_untrusted
from bayesfric.errors import Fault, InputError
from bayesfric.results import read_json
from bayesfric.rigs.rotary import is_relative, turns
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import INERTIAS
from bayesfric.schemas.diagnosis import Enter

OF_LAW = (*INERTIAS, "coulomb", "viscous")
POWER_OF_SPEED = {
    "coulomb": 0,
    "viscous": 1,
    "air-drag.coefficient": 2,
    "cubic-drag.coefficient": 3,
}
OF_SPEED = tuple(POWER_OF_SPEED)
NOT_BELOW_ZERO = {*INERTIAS, *OF_SPEED}


@dataclass(frozen=True)
class ExportedJoint:
    """A joint with the numbers for a simulator.

    Parameters
    ----------
    name : str
        Name in the log; empty if it has none.
    in_model : str or None
        Name in the model of the recording; None without a model.
    turns : bool
        Whether it turns.
    numbers : mapping of str to Enter
        Numbers by parameter.
    draws : mapping of str to ndarray, shape (S,)
        Draws by parameter; those of one index belong together. Parameters without draws are
        absent.
    causes : tuple of str
        Effects that the diagnosis names.
    warning : str or None
        Why its numbers are unreliable; None if they are reliable.
    """

    name: str
    in_model: str | None
    turns: bool
    numbers: Mapping[str, Enter]
    draws: Mapping[str, Array]
    causes: tuple[str, ...] = ()
    warning: str | None = None

    @property
    def called(self) -> str:
        """Its name, or `joint` if it has none."""
        return self.name or "joint"

    @property
    def inertia(self) -> str | None:
        """The name of its inertia or mass among the numbers; None without one."""
        return next((name for name in INERTIAS if name in self.numbers), None)

    @property
    def said(self) -> str:
        """Origin of the numbers, reasons why they may be wrong, and what they leave out."""
        lacking = ", ".join(name for name in self.numbers if name not in (*OF_LAW, *OF_SPEED))
        return " ".join(
            [
                "Numbers that diagnosis.json gives to enter in a simulator.",
                *([] if self.warning is None else [f"{self.warning}."]),
                *([f"Not in friction and damping: {lacking}."] if lacking else []),
            ]
        )

    def friction(self, speed: Array) -> Array:
        """Return friction against the motion at given speeds [N or N·m]: a constant and powers."""
        total = np.zeros(np.shape(speed))
        for name, power in POWER_OF_SPEED.items():
            if name in self.numbers:
                total = total + self.numbers[name].value.mean * np.abs(speed) ** power
        return total

    def possible_draws(self) -> tuple[dict[str, Array], int]:
        """Return the draws without negative numbers, and the number of the other draws."""
        signed = [values for name, values in self.draws.items() if name in NOT_BELOW_ZERO]
        count = len(next(iter(self.draws.values()), ()))
        possible = np.all([values >= 0 for values in signed], axis=0) & np.ones(count, bool)
        kept = {name: values[possible] for name, values in self.draws.items()}
        return kept, int(count - possible.sum())


def read_diagnosis(folder: Path) -> DiagnosisFile:
    """Read the diagnosis of a folder.

    Parameters
    ----------
    folder : Path
        Folder with the results of ``diagnose``.

    Raises
    ------
    InputError
        There is no diagnosis.
    """
    return read_json(DiagnosisFile, folder / "diagnosis.json", "diagnose")


def refuse_ratios(diagnosis: DiagnosisFile) -> None:
    """Refuse numbers that are divided by a servo's stiffness: no simulator accepts them.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        Diagnosis of one joint, or of several.

    Raises
    ------
    InputError
        A joint has such a number.
    """
    for block in diagnosis.joints or (diagnosis,):
        if is_relative(block.gap.unit):
            expected = (
                f"numbers in newtons: those{f' of {block.joint}' if block.joint else ''} are over "
                f"the stiffness K of a servo ({block.gap.unit}). Say what tells it "
                "(rig.command_gain, a payload with rig.payload_arm_m, rig.moving_mass_kg, a model "
                "in rig.robot), or take the ratios with --to json"
            )
            raise InputError([Fault("diagnosis.json", expected)])


def joints_of(diagnosis: DiagnosisFile, curves: xr.DataTree) -> tuple[ExportedJoint, ...]:
    """Return the joints of a diagnosis.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        Diagnosis of one joint, or of several.
    curves : DataTree
        Content of ``diagnosis.nc``.

    Raises
    ------
    InputError
        It has no joint, or no joint has a number to enter.
    """
    blocks = diagnosis.joints or (diagnosis,)
    joints = []
    for place, block in enumerate(blocks, start=1):
        own = curves[f"joints/{place}"] if diagnosis.joints else curves
        if block.enter:
            joints.append(_joint(block, own["law"].to_dataset()))
    if not joints:
        why = next((block.enter_why for block in blocks if block.enter_why), "nothing to enter")
        expected = f"a diagnosis of a joint, with numbers to enter ({why})"
        raise InputError([Fault("diagnosis.json", expected)])
    return tuple(joints)


def _joint(block: DiagnosisFile, law: xr.Dataset) -> ExportedJoint:
    numbers = {number.parameter: number for number in block.enter}
    draws = _drawn_law(block, law) | _drawn_effects(block, law)
    return ExportedJoint(
        name=block.joint or "",
        in_model=block.joint_in_model,
        turns=turns(block.gap.unit),
        numbers=numbers,
        draws={name: values for name, values in draws.items() if name in numbers},
        causes=tuple(cause.effect for cause in block.causes),
        warning=why_untrusted(block),
    )


def _drawn_law(block: DiagnosisFile, law: xr.Dataset) -> dict[str, Array]:
    """Return draws of the law's own numbers, by their coefficients."""
    places = {**dict.fromkeys(INERTIAS, "c1"), "coulomb": "c2", "viscous": "c3"}
    drawn = {name: law[places[name]].to_numpy()[:, 0] for name in OF_LAW if name in block.law}
    return {name: _as_told(block.law[name].after, values) for name, values in drawn.items()}


def _as_told(value: Interval, values: Array) -> Array:
    """Return draws transformed to the reported median and 90 % interval, in the same order.

    The reported interval includes corrections by held-out data, by an instrument, or for scatter
    between runs, which the draws of the fit do not.
    """
    low, middle, high = np.quantile(values, (0.05, 0.5, 0.95))
    below = (value.q50 - value.q05) / (middle - low) if middle > low else 0.0
    above = (value.q95 - value.q50) / (high - middle) if high > middle else 0.0
    return np.asarray(value.q50 + np.where(values < middle, below, above) * (values - middle))


def _drawn_effects(block: DiagnosisFile, law: xr.Dataset) -> dict[str, Array]:
    """Return draws of the causes' amplitudes; 0 in draws of hypotheses without the cause."""
    drawn: dict[str, Array] = {}
    if "effect" not in law.coords:
        return drawn
    places = {str(name): place for place, name in enumerate(law["effect"].to_numpy())}
    for cause in block.causes:
        if cause.effect not in places:
            continue
        amplitude = law["amplitude"].to_numpy()[:, places[cause.effect]]
        name, value = next(iter(cause.parameters.items()))
        acts = amplitude != 0
        if acts.any():
            amplitude = amplitude.copy()
            amplitude[acts] = _as_told(value, amplitude[acts])
        drawn[f"{cause.effect}.{name}"] = amplitude
        damping = next((number for number in block.enter if number.parameter == "viscous"), None)
        if cause.effect == "viscous" and damping is not None and acts.any():
            # The amplitude is a share of a Coulomb friction that is the same for all draws.
            drawn["viscous"] = amplitude * (damping.value.mean / float(amplitude[acts].mean()))
    return drawn
