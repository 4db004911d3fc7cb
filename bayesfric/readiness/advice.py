"""What to record so that an effect can be found, by what the effect needs."""

from collections.abc import Iterable

ADVICE = {
    "load-both-ways": "lift and lower at the same pose, and again with a second load",
    "test": "runs with another load, of role test",
    "dwell": "rests of different lengths before the axis starts, from 0.1 s to 10 s",
    "warmth": "a temperature column, from cold to warm",
    "temperature": "a temperature column, from cold to warm",
    "turns": "more reversals, at least eight",
    "position": "reversals at different places of the stroke",
    "angle": "a stroke of half a turn or more, there and back",
    "acting-gravity": "",
    "period": "slow runs there and back over the whole stroke",
    "direction": "runs in both directions, with at least four reversals",
    "play": "slow motion with at least eight reversals",
    "spring": "a chirp to 4 Hz, or quick reversals",
    "limit": "commands above the force limit of the drive",
    "commanded-force": "the commanded force rather than the measured one (rig.force_is)",
    "known-load": "a load that was weighed (rig.moving_mass_kg), or a model of the machine",
    "drive": "quick starts and stops: a chirp to 4 Hz",
    "pulleys": "",
}
"""What to record, by need of an effect; empty if no recording of the rig can provide it."""


def advice_for(needs: Iterable[str]) -> tuple[str, ...]:
    """Return what to record for needs that a recording lacks; nothing for needs without advice."""
    wanted = [ADVICE.get(need, "") for need in needs]
    return tuple(dict.fromkeys(wanted)) if wanted and all(wanted) else ()
