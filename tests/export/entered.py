"""A number of a joint as a diagnosis gives it to enter."""

from bayesfric.robots.fields import fields_of
from bayesfric.schemas.base import Interval
from bayesfric.schemas.diagnosis import Enter, SimulatorField


def number(parameter, mean, sd, unit="N·m", **more):
    value = Interval(mean=mean, sd=sd, q05=mean - 1.645 * sd, q50=mean, q95=mean + 1.645 * sd)
    fields = {
        name: None if field is None else SimulatorField(**field._asdict())
        for name, field in fields_of(parameter, turns=True).items()
    }
    return Enter(parameter=parameter, unit=unit, value=value, fields=fields, **more)
