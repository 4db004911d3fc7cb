"""``bayesfric calibrate``: simulation-based calibration."""

from pathlib import Path
from typing import Annotated

from bayesfric.cli.exits import check_fail_on, exit_status, fail_on
from bayesfric.cli.locks import hold
from bayesfric.cli.options import Cases, Config, Folder, Quiet, Scheduler, Seed, Workers, fails
from bayesfric.cli.printing import say, say_attention


@exit_status
def calibrate(
    output: Folder = Path("bayesfric-run"),
    number: Cases = 50,
    workers: Workers = 1,
    scheduler: Scheduler = None,
    seed: Seed = None,
    config: Config = None,
    quiet: Quiet = False,
    fail_on_list: Annotated[str, fails("calibrate")] = "",
) -> None:
    """Fit recordings of known truth, rank the truths; write calibration.json.

    Truths are drawn from the prior of [calibration], with which they are fitted too. Cases
    that are done are kept under calibration/.

    Example: bayesfric calibrate -o my-calibration --n 500 --workers 2
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.calibration.running import calibrate as run
    from bayesfric.progress import stage

    check_fail_on(fail_on_list, "calibrate")
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
    fail_on(fail_on_list, happened if calibrated.calibrated else happened | {"uncalibrated"})
