"""Boards and noise make a recording: the mirror of :mod:`bayesfric.likelihood`.

A trial is released at rest; its friction is the law's times 1 + η + ε, with η
drawn once for each assembly and ε once for each trial. Magnets pass a sensor
each `hall_spacing_m` of travel, with a position error each, and the clock adds
its own error before it rounds.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.boards.gravity import Condition, trajectory
from bayesfric.friction import Coefficients
from bayesfric.paper import paper, table1
from bayesfric.protocols import PROTOCOLS, Assembly, Protocol
from bayesfric.recording.tables import Gravity, Recording, Rig

__all__ = ["SENSORS", "Truth", "simulate_recording", "table1_coefficients"]

SENSORS = ("drive", "load")
TRAVEL_M = 0.6
LEAST_PATH_M = 0.001  # from release to the first event, so that the cable moves there
RELEASE_WINDOW_S = 0.3  # the release comes this long, at most, after the clock starts
LEAST_EVENTS = 5  # of a trial and sensor, by the recording format


def table1_coefficients() -> dict[str, Coefficients]:
    """Return the coefficients of the paper's Table I, size to law."""
    return {
        size: Coefficients(row.c1.value, row.c2.value, row.c3.value)
        for size, row in table1().items()
    }


@dataclass(frozen=True)
class Truth:
    """What a simulated recording is made from.

    Parameters
    ----------
    coefficients : mapping of str to Coefficients
        Friction law of each pulley size; default Table I.
    tau, omega : float
        Relative friction scatter of a trial and of an assembly.
    sigma_x : float
        Position error of a Hall event [m].
    sigma_t : float
        Clock error of a Hall event, before rounding [s].
    """

    coefficients: Mapping[str, Coefficients] = field(default_factory=table1_coefficients)
    tau: float = 0.01
    omega: float = 0.015
    sigma_x: float = 30e-6
    sigma_t: float = 20e-6

    def as_json(self) -> dict[str, Any]:
        """Return the values as plain JSON types."""
        return {
            "coefficients": {
                size: {name: float(np.asarray(value)) for name, value in law._asdict().items()}
                for size, law in self.coefficients.items()
            },
            "tau": self.tau,
            "omega": self.omega,
            "sigma_x": self.sigma_x,
            "sigma_t": self.sigma_t,
        }


def simulate_recording(
    protocol: str | Protocol = "paper",
    *,
    seed: int = 0,
    truth: Truth | None = None,
    name: str = "simulated",
    created: str | None = None,
) -> Recording:
    """Simulate the gravity board.

    Parameters
    ----------
    protocol : str or Protocol
        A name in :data:`bayesfric.protocols.PROTOCOLS`, or a design.
    seed : int
        Seeds four streams of their own (order, scatter, sensors, noise), so that
        a change of one leaves the others as they were.
    truth : Truth or None
        Parameters; None is the paper's Table I with 1 % trial and 1.5 % setup
        scatter, 30 µm and 20 µs.
    name : str
        Name of the recording.
    created : str or None
        ISO 8601 date to write down; none is made up.

    Returns
    -------
    Recording
        Trials in `order`, those of an assembly together. A trial that stalls
        before the fifth event of a sensor cannot be written in the recording
        format; it is left out and named in ``metadata["simulation"]["stalled"]``.
    """
    truth = Truth() if truth is None else truth
    label = protocol if isinstance(protocol, str) else "custom"
    design = PROTOCOLS[protocol] if isinstance(protocol, str) else protocol
    order_rng, scatter_rng, sensor_rng, noise_rng = (
        np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(4)
    )
    board = paper()["board"]
    rig = Rig(
        hall_spacing_m=board["hall_spacing_m"],
        magnets_per_revolution=board["magnets_per_revolution"],
        timer_resolution_s=board["timer_resolution_s"],
        limits={"travel_m": [0.0, TRAVEL_M]},
    )
    trials = _trials(design, order_rng)
    events, moved = _events(trials, rig, truth, scatter_rng, sensor_rng, noise_rng)
    stalled = trials.loc[~moved, "trial"].tolist()
    return Recording(
        name=name,
        title=f"Synthetic gravity-board recording, protocol {label}, seed {seed}",
        rig=rig,
        gravity=Gravity(trials=trials[moved].reset_index(drop=True), events=events),
        created=created,
        metadata={
            "sources": [{"title": "Simulated by bayesfric; no board was measured"}],
            "licenses": [{"name": "CC0-1.0"}],
            "simulation": {
                "protocol": label,
                "seed": seed,
                "truth": truth.as_json(),
                "stalled": stalled,
            },
        },
    )


def _trials(design: Protocol, rng: np.random.Generator) -> pd.DataFrame:
    """Lay the assemblies, and the trials of each, in a random order."""
    assemblies = list(design.assemblies())
    rows: list[dict[str, Any]] = []
    for place, chosen in enumerate(rng.permutation(len(assemblies)), start=1):
        assembly: Assembly = assemblies[chosen]
        for index in rng.permutation(len(assembly.trials)):
            order = len(rows) + 1
            rows.append(
                {
                    "trial": f"g{order:04d}",
                    "order": order,
                    "setup": f"s{place:03d}",
                    "pulley_size": assembly.pulley_size,
                    "n_pulleys": assembly.n_pulleys,
                    "wrap_angle_deg": assembly.wrap_angle_deg,
                    "mass_drive_kg": assembly.trials[index].mass_drive_kg,
                    "mass_load_kg": assembly.trials[index].mass_load_kg,
                    "drive_end": ("left", "right")[order % 2],
                }
            )
    return pd.DataFrame(rows)


def _events(
    trials: pd.DataFrame,
    rig: Rig,
    truth: Truth,
    scatter_rng: np.random.Generator,
    sensor_rng: np.random.Generator,
    noise_rng: np.random.Generator,
) -> tuple[pd.DataFrame, NDArray[np.bool_]]:
    """Return the events, and which trials gave enough of them."""
    assert rig.hall_spacing_m and rig.magnets_per_revolution and rig.timer_resolution_s
    spacing, tick = rig.hall_spacing_m, rig.timer_resolution_s
    setup_index = pd.factorize(trials["setup"])[0]
    eta = truth.omega * scatter_rng.standard_normal(setup_index.max() + 1)
    factor = 1 + eta[setup_index] + truth.tau * scatter_rng.standard_normal(len(trials))

    # Column by column: trial × sensor × event, made rectangular and then masked.
    shape = (len(trials), len(SENSORS))
    rotation = spacing * sensor_rng.uniform(0, rig.magnets_per_revolution, shape)
    first = LEAST_PATH_M + rotation % spacing  # the first magnet is rotation // spacing
    release = sensor_rng.uniform(0, RELEASE_WINDOW_S, len(trials))
    grid = np.arange(int(TRAVEL_M / spacing) + 1) * spacing
    place = first[:, :, None] + grid
    laws = [truth.coefficients[size] for size in trials["pulley_size"]]
    motion = trajectory(
        Coefficients(*(np.array(column)[:, None, None] for column in zip(*laws, strict=True))),
        Condition(
            trials["n_pulleys"].to_numpy()[:, None, None],
            trials["wrap_angle_deg"].to_numpy()[:, None, None],
            trials["mass_drive_kg"].to_numpy()[:, None, None],
            trials["mass_load_kg"].to_numpy()[:, None, None],
            rig.gravity_m_s2,
        ),
        friction_factor=factor[:, None, None],
    )
    magnet = place + truth.sigma_x * noise_rng.standard_normal(place.shape)
    clock = truth.sigma_t * noise_rng.standard_normal(place.shape)
    passed = motion.time_at(magnet) + release[:, None, None] + clock
    seen = (place <= TRAVEL_M) & np.isfinite(passed)
    moved = (seen.sum(axis=2) >= LEAST_EVENTS).all(axis=1)
    seen &= moved[:, None, None]

    which_trial, which_sensor, which_event = np.nonzero(seen)
    events = pd.DataFrame(
        {
            "trial": trials["trial"].to_numpy()[which_trial],
            "sensor": np.array(SENSORS)[which_sensor],
            "displacement_m": grid[which_event],
            "time_s": np.round(passed[seen] / tick) * tick,
        }
    )
    return events, moved
