"""``bayesfric calibrate``: simulation-based calibration."""

from pathlib import Path
from typing import Annotated

from bayesfric.cli import options
from bayesfric.cli.exits import exit_status
from bayesfric.cli.locks import hold
from bayesfric.cli.printing import say, say_attention


@exit_status
def calibrate(
    output: options.Folder = Path("bayesfric-run"),
    number: options.Cases = 50,
    workers: options.Workers = 1,
    scheduler: options.Scheduler = None,
    seed: options.Seed = None,
    config: options.Config = None,
    quiet: options.Quiet = False,
    fail_on_list: Annotated[str, options.fails("calibrate")] = "",
) -> set[str]:
    """Simulate recordings, fit them, and rank the truths; write calibration.json.

    True values are drawn from the prior of [calibration], and the fits use the same prior.
    Finished cases are kept under calibration/.

    Example: bayesfric calibrate -o my-calibration --n 500 --workers 2
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.calibration.running import calibrate as run
    from bayesfric.progress import stage

    with (
        hold(output, "calibrate"),
        stage("calibrating", quiet=quiet) as progress,
    ):
        calibrated = run(
            output,
            number=number,
            workers=workers,
            scheduler=scheduler,
            analysis=read_analysis(config, seed=seed),
            progress=progress,
        )
    inside = sum(quantity.inside for quantity in calibrated.quantities)
    say(f"{inside} of {len(calibrated.quantities)} quantities have uniform ranks")
    happened = say_attention(calibrated.attention, quiet=quiet)
    return happened if calibrated.calibrated else happened | {"uncalibrated"}
