"""Converts a log of a servo's commands to a force: the lag of the joint behind them.

A position servo drives with the force K (q_ref(t − d) − q) − D q̇, and its gains and delay are not
in the log. If the stiffness K is unknown, all forces are relative to K. The force is then the
position error of the servo, and friction is the distance by which the joint stays behind its
command.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.weak_form import WeakForce

DELAY_S, DELAY_SD_S = 0.02, 0.015
"""Prior mean and standard deviation of an undeclared delay of a servo, by its bus and its loop."""
IN_BAND = 0.9  # part of the squared speed that lies in the band of a motion


def force_of_commands(samples: pd.DataFrame, constants: RigConstants) -> pd.DataFrame:
    """Return samples with the command as their force, at the times from which commands act.

    Parameters
    ----------
    samples : DataFrame
        Samples of a run, with ``command_m`` and without ``force_n``.
    constants : RigConstants
        Its ``latency_s`` is the servo's delay.
    """
    since = samples["command_time_s" if "command_time_s" in samples else "time_s"]
    late_s = DELAY_S if constants.latency_s is None else constants.latency_s
    return samples.assign(force_n=samples["command_m"], force_time_s=since + late_s)


def commanded(log: EvenLog, constants: RigConstants) -> EvenLog:
    """Return a run with the servo's force instead of its command.

    Parameters
    ----------
    log : EvenLog
        Its force is the command [m, or rad].
    constants : RigConstants
        Its ``command_gain`` is the stiffness; 1 if it is not declared.
    """
    stiffness = constants.command_gain or 1.0
    sent = stiffness * log.force
    # A command may change within a sampling interval; the moment corrects the sum of its means.
    moment = None if log.moment is None else -stiffness * log.moment
    whole = WeakForce(sent, curvature=log.interval_s**2 / 24 * sent, momentum=moment)
    return replace(log, force=sent - stiffness * log.position, sent=whole, stiffness=stiffness)


def samples_a_period(logs: Sequence[EvenLog]) -> float:
    """Return samples per period of the frequency below which most of the speed lies.

    Parameters
    ----------
    logs : sequence of EvenLog
        The runs.
    """
    rates, powers = [], []
    for log in logs:
        speed = np.diff(log.position)
        spectrum = np.abs(np.fft.rfft(speed * np.hanning(speed.size))) ** 2
        rates.append(np.fft.rfftfreq(speed.size))  # per sample
        powers.append(spectrum)
    rate, power = np.concatenate(rates), np.concatenate(powers)
    order = np.argsort(rate)
    share = np.cumsum(power[order]) / power.sum()
    return float(1 / max(rate[order][np.searchsorted(share, IN_BAND)], 1e-12))
