"""Cable that slips: the two sensors disagree more and more."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, Reading
from bayesfric.effects.state import STANDARD_GRAVITY_M_S2

TYPICAL_FRICTION_N = 2.0  # of the board


def _proportional(p: Parameters, reading: Reading) -> Array:
    at_load = np.asarray(reading.displacement_m) * np.asarray(reading.is_load)
    return np.asarray(p["share"] * at_load)


def _creep(p: Parameters, reading: Reading) -> Array:
    # The cable's strain changes over the pulleys by the step of tension, which is their friction.
    drive, load = np.asarray(reading.mass_drive_kg), np.asarray(reading.mass_load_kg)
    pull = (drive - load) * STANDARD_GRAVITY_M_S2
    friction = pull - (drive + load) * np.asarray(reading.acceleration_m_s2)
    return np.asarray(_proportional(p, reading) * friction / TYPICAL_FRICTION_N)


EFFECT = Effect(
    name="slip",
    acts_on="reading",
    sentence="the cable slips, so that the two sensors disagree",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="travel that the sensor at the load end does not see, as a share of travel, at "
        "the board's typical friction; negative if the sensor at the drive end does not see it",
        prior=Normal(mean=0.0, sd=0.03),
        plausible=(-0.01, 0.01),
        reference="argued: elastic creep over a pulley is the difference of strain, under 33 N / "
        "15 kN = 0.2 %; several times that where the cable slips for moments",
    ),
    laws={"proportional": _proportional, "creep": _creep},
    along_path=True,
    needs=frozenset({"pulleys"}),
    axes=frozenset({"acceleration", "sensor"}),
)
