"""What looks like a mistake of a unit or a sign is asked about, and what does not is not."""

import pytest
from rigs.joints import Joint, recording_of

from bayesfric.rigs.single_axis.entering import entering
from bayesfric.rigs.single_axis.mistakes import likely_mistakes

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
SHORT = Joint(seconds=6.0, sampled_hz=100.0)


def asked(change):
    recording = recording_of(change(SHORT.samples()), force_is="motor")
    entered = entering(recording.axis, recording.rig)
    parts = (entered[name] for name in ("readings", "measures", "interval_s"))
    return list(likely_mistakes(*parts, viscous=True))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda log: log.assign(force_n=-log["force_n"]), "sign = -1"),
        (lambda log: log.assign(force_n=log["force_n"].abs()), "is it a magnitude"),
        (lambda log: log.assign(time_s=1e-3 * log["time_s"]), "100,000 samples a second"),
        (lambda log: log.assign(position_m=57.3 * log["position_m"]), "in degrees"),
        (lambda log: log.assign(force_n=log["force_n"] + 9.0), None),  # a load that hangs
        (lambda log: log, None),
    ],
)
def test_likely_mistakes_are_asked_about(change, said):
    lines = asked(change)
    assert len(lines) == (said is not None)
    assert said is None or said in lines[0]
