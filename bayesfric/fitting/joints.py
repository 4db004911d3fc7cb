"""Combines the fits of all joints of a machine."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import xarray as xr

from bayesfric.fitting.result import Fit
from bayesfric.recording.tables import Recording
from bayesfric.results import identified
from bayesfric.schemas import FitFile
from bayesfric.schemas.fit import JointFit
from bayesfric.schemas.parameter import ParameterSummary

OFFSET = "offset"


def fit_joints(
    parted: Mapping[str, Recording],
    fitted: Callable[[Recording, Path | None], Fit],
    checkpoint: Path | None,
) -> Fit:
    """Fit each joint separately; the top level of the result is the first joint's.

    Parameters
    ----------
    parted : mapping of str to Recording
        Recordings by joint.
    fitted : callable
        Fits one recording; its second argument is the folder of its checkpoint.
    checkpoint : Path or None
        Checkpoint folder of all joints.

    Raises
    ------
    InputError
        A joint cannot be fitted.
    """
    fits: dict[str, Fit] = {}
    for place, (joint, recording) in enumerate(parted.items(), start=1):
        folder = None if checkpoint is None else checkpoint / f"joint-{place}"
        fits[joint] = fitted(recording, folder)
    first = next(iter(fits.values()))
    summaries = {joint: fit.summary for joint, fit in fits.items()}
    summary = first.summary.model_copy(
        update={
            "joint": next(iter(fits)),
            "joint_why": None,
            "joints": {
                joint: JointFit(
                    converged=summary_of_joint.converged,
                    parameters=_called(summary_of_joint, parted[joint]),
                    scatter=summary_of_joint.scatter,
                    noise=summary_of_joint.noise,
                )
                for joint, summary_of_joint in summaries.items()
            },
            "converged": all(fit_of_joint.converged for fit_of_joint in summaries.values()),
            "attention": tuple(
                f"{joint}: {line}"
                for joint, summary_of_joint in summaries.items()
                for line in summary_of_joint.attention
            ),
        }
    )
    seconds = {
        f"{joint}: {stage}": time
        for joint, fit in fits.items()
        for stage, time in fit.seconds.items()
    }
    return replace(
        first,
        summary=identified(summary),
        draws=_with_joints(first.draws, [fit.draws for fit in fits.values()]),
        predictive=_with_joints(first.predictive, [fit.predictive for fit in fits.values()]),
        seconds=seconds,
    )


def _called(of_joint: FitFile, recording: Recording) -> dict[str, ParameterSummary]:
    """Return the numbers of a joint's law by the names of a diagnosis, which has no mass.

    An offset of the force is included; the fit of a single joint lists it with the noise.
    """
    robot, joint = recording.rig.robot, None if recording.axis is None else recording.axis.joint
    has_model = robot is not None and joint is not None and joint in robot.joints
    called = {"mass": "armature" if has_model else "inertia"}
    law = {called.get(name, name): number for name, number in of_joint.parameters.items()}
    return law | {name: of_joint.noise[name] for name in (OFFSET,) if name in of_joint.noise}


def _with_joints(first: xr.DataTree, trees: list[xr.DataTree]) -> xr.DataTree:
    """Return the first joint's tree with a group ``joints`` of all trees, numbered from 1."""
    numbered = {str(place): tree for place, tree in enumerate(trees, start=1)}
    joints = xr.DataTree(children={name: tree.copy() for name, tree in numbered.items()})
    return xr.DataTree(first.to_dataset(), children=dict(first.children) | {"joints": joints})
