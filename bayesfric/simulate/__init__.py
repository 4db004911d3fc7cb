"""Simulation of recordings: boards, effects and noise to tables."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

from bayesfric.paper import paper
from bayesfric.physics.gravity import TRAVEL_M
from bayesfric.recording.tables import Recording, RigConstants
from bayesfric.rigs import all_rigs, paper_rigs
from bayesfric.rigs.own_design import OwnDesign, Simulated
from bayesfric.rigs.protocols import PROTOCOLS, Protocol
from bayesfric.rigs.truth import AppliedEffect as AppliedEffect
from bayesfric.rigs.truth import Truth as Truth
from bayesfric.rigs.truth import table1_coefficients as table1_coefficients
from bayesfric.simulate.strength import at_strength

TORQUE_CONSTANT_N_M_PER_A = 0.0259  # an assumption: the paper does not name its motor's
CAPSTAN_RADIUS_M = 0.0065  # likewise


def simulate_recording(
    protocol: str | Protocol = "paper",
    *,
    seed: int = 0,
    truth: Truth | None = None,
    name: str = "simulated",
    created: str | None = None,
    rigs: Collection[str] | None = None,
    effects: Mapping[str, float] | None = None,
) -> Recording:
    """Simulate the paper's boards.

    Parameters
    ----------
    protocol : str or Protocol
        A name in :data:`bayesfric.rigs.protocols.PROTOCOLS`, or a design; or the name of
        what another rig is simulated with, which then records alone: ``axis``, ``points``.
    seed : int
        Seeds streams of their own for order, scatter, sensors, noise and phases of each
        rig, so that a change of one leaves the others as they were.
    truth : Truth or None
        Parameters; None is the paper's Table I with 1 % trial and 1.5 % setup
        scatter, 30 µm and 20 µs; of a motor the specified torque constant, 2 mA and
        0.5 % of the load.
    name : str
        Name of the recording.
    created : str or None
        ISO 8601 date to write down; none is made up.
    rigs : collection of str or None
        Names of the paper's rigs that record; None is all.
    effects : mapping of str to float, or None
        Strengths of effects by name, see :func:`bayesfric.simulate.strength.at_strength`;
        they come on top of those of `truth`.

    Returns
    -------
    Recording
        Trials in `order`, those of an assembly together. One that stays where it is
        has ``did_not_move``. One that stalls before the fifth event of a sensor cannot
        be written in the recording format; it is left out and named in
        ``metadata["simulation"]["stalled"]``.

    Raises
    ------
    ValueError
        A rig is unknown, or there is none.
    InputError
        An effect is unknown.
    """
    designs = {own.name: own for rig in all_rigs().values() if (own := rig.own_design)}
    if isinstance(protocol, str) and protocol in designs:
        if rigs is not None:
            raise ValueError(f"rigs is {rigs!r}; the protocol {protocol} has one of its own")
        fields = _of_design(designs[protocol], seed, truth, effects or {})
    else:
        fields = _of_boards(protocol, seed, truth, rigs, effects or {})
    return Recording(name=name, created=created, **fields)


def _of_boards(
    protocol: str | Protocol,
    seed: int,
    truth: Truth | None,
    rigs: Collection[str] | None,
    effects: Mapping[str, float],
) -> dict[str, Any]:
    """Simulate boards of the paper's by one of its protocols, or by a design."""
    rigs_by_name = paper_rigs()
    rigs = tuple(rigs_by_name) if rigs is None else rigs
    if not rigs or set(rigs) - set(rigs_by_name):
        raise ValueError(f"rigs is {rigs!r}; it holds one or more of {', '.join(rigs_by_name)}")
    label = protocol if isinstance(protocol, str) else "custom"
    design = PROTOCOLS[protocol] if isinstance(protocol, str) else protocol
    board = paper()["board"]
    constants = RigConstants(
        hall_spacing_m=board["hall_spacing_m"],
        magnets_per_revolution=board["magnets_per_revolution"],
        timer_resolution_s=board["timer_resolution_s"],
        motor_torque_constant_n_m_per_a=TORQUE_CONSTANT_N_M_PER_A,
        capstan_radius_m=CAPSTAN_RADIUS_M,
        limits={"travel_m": [0.0, TRAVEL_M]},
    )
    truth = _with_effects(Truth() if truth is None else truth, effects, design, constants)
    recorded = [
        rig.simulate(design, constants, truth, seed)
        for name, rig in rigs_by_name.items()
        if name in rigs
    ]
    title = f"Synthetic pulley-board recording, protocol {label}, seed {seed}"
    return _fields(title, constants, label, seed, truth, recorded)


def _of_design(
    design: OwnDesign, seed: int, truth: Truth | None, effects: Mapping[str, float]
) -> dict[str, Any]:
    """Simulate a rig that no protocol of the paper's lays out."""
    constants = design.constants
    truth = Truth(coefficients=design.coefficients) if truth is None else truth
    truth = _with_effects(truth, effects, design, constants)
    title = f"Synthetic: {design.title}, seed {seed}"
    simulated = design.simulate(constants, truth, seed)
    return _fields(title, constants, design.name, seed, truth, [simulated])


def _with_effects(
    truth: Truth,
    effects: Mapping[str, float],
    design: Protocol | OwnDesign,
    constants: RigConstants,
) -> Truth:
    """Return a truth with effects of these strengths, each by itself, beside its own."""
    added = [
        at_strength(effect, size, design, constants, truth) for effect, size in effects.items()
    ]
    return replace(truth, effects=(*truth.effects, *added))


def _fields(
    title: str,
    constants: RigConstants,
    label: str,
    seed: int,
    truth: Truth,
    recorded: Sequence[Simulated],
) -> dict[str, Any]:
    """Return what a recording holds beside its name and its date."""
    tables = {name: table for simulated in recorded for name, table in simulated.tables.items()}
    simulation = {
        "protocol": label,
        "seed": seed,
        "truth": truth.as_json(),
        "stalled": [trial for simulated in recorded for trial in simulated.stalled],
    }
    metadata = {
        "sources": [{"title": "Simulated by bayesfric; no board was measured"}],
        "licenses": [{"name": "CC0-1.0"}],
        "simulation": simulation,
    }
    return {"title": title, "rig": constants, "metadata": metadata, **tables}
