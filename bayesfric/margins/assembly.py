"""Draws for a new assembly: coefficients of the friction law and numbers of the loop.

The posterior of c1, c2, c3 describes the law of the measured boards. A new machine scatters around
that law as assemblies of the board did (omega, and omega_intercept for c2 alone). It also differs
from it as one rig differs from another.
"""

import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from pydantic import BaseModel

from bayesfric.arrays import Array, Whole, taken
from bayesfric.diagnosis.drawn_effect import DrawnEffect
from bayesfric.errors import Fault, InputError
from bayesfric.inference.priors import from_normal
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.posterior import Posterior, RigDiscrepancy
from bayesfric.margins.quantities import central, is_uncertain
from bayesfric.physics.friction import Coefficients

COEFFICIENTS = "c1, c2, c3"
NEW_ASSEMBLY = "new assembly and rig"


@dataclass(frozen=True)
class Assembly:
    """Everything on which the margins depend, one value for each draw.

    Parameters
    ----------
    coefficients : mapping of str to Coefficients
        Coefficients of the law by pulley size, shape (draws,).
    factor, factor_of_c2 : mapping of str to ndarray
        Factors on the friction by c1 and c3, and by c2, by the key of a run, shape (draws,).
    numbers : mapping of str to ndarray
        Values by dotted key of the loop file, shape (draws,).
    uncertain : tuple of str
        Which of these keys are distributions.
    acting : tuple of DrawnEffect
        Effects on friction beside the law; their draws match those of the coefficients.
    """

    coefficients: Mapping[str, Coefficients]
    factor: Mapping[str, Array]
    factor_of_c2: Mapping[str, Array]
    numbers: Mapping[str, Array]
    uncertain: tuple[str, ...]
    acting: tuple[DrawnEffect, ...] = ()

    @property
    def draws(self) -> int:
        """Number of draws."""
        return next(iter(self.factor.values())).size

    def __getitem__(self, key: str) -> Array:
        return self.numbers[key]

    @property
    def groups(self) -> tuple[str, ...]:
        """Independent groups of inputs: the law, the assembly, and each uncertain number."""
        return (COEFFICIENTS, NEW_ASSEMBLY, *self.uncertain)

    def with_group(self, group: str, other: "Assembly") -> "Assembly":
        """Return this assembly with one group taken from another."""
        if group == COEFFICIENTS:
            return replace(self, coefficients=other.coefficients, acting=other.acting)
        if group == NEW_ASSEMBLY:
            return replace(self, factor=other.factor, factor_of_c2=other.factor_of_c2)
        return replace(self, numbers={**self.numbers, group: other.numbers[group]})

    def taken(self, rows: Whole) -> "Assembly":
        """Return some of the draws."""
        return replace(
            self,
            coefficients={size: taken(law, rows) for size, law in self.coefficients.items()},
            factor={key: values[rows] for key, values in self.factor.items()},
            factor_of_c2={key: values[rows] for key, values in self.factor_of_c2.items()},
            numbers={key: values[rows] for key, values in self.numbers.items()},
            acting=tuple(effect.taken(rows) for effect in self.acting),
        )


def _quantities(loop: Loop) -> dict[str, object]:
    """Return every number of a loop file that may be uncertain, by its dotted key."""
    numbers: dict[str, object] = {"stiction_ratio": loop.stiction_ratio}
    sections: dict[str, BaseModel] = {
        name: getattr(loop, name)
        for name in ("joint", "drive", "cable", "controller", "compensation", "kick", "tool")
    }
    for key, run in loop.every_run:
        numbers[f"{key}.tension_n"] = run.tension_n
    if loop.coupling is not None:
        others = enumerate(loop.coupling.others)
        sections |= {f"coupling.others.{place}": other for place, other in others}
    if loop.second_stage is not None:
        sections |= {
            "second_stage": loop.second_stage,
            "second_stage.cable": loop.second_stage.cable,
        }
    for name, section in sections.items():
        for key, value in section:
            number = isinstance(value, float | int) and not isinstance(value, bool)
            if number or is_uncertain(value):
                numbers[f"{name}.{key}"] = value
    return numbers


def draw_assembly(
    loop: Loop, posterior: Posterior, discrepancy: RigDiscrepancy, seed: int, stream: int = 0
) -> Assembly:
    """Draw new assemblies of a loop, one for each draw of the posterior.

    Parameters
    ----------
    loop : Loop
        The loop; its uncertain numbers are drawn independently.
    posterior : Posterior
        Draws, in the order of the file for stream 0, shuffled for other streams.
    discrepancy : RigDiscrepancy
        Difference between rigs, common to all runs of one machine. Each run also has an assembly
        factor of its own.
    seed : int
        Seed of the analysis.
    stream : int
        Number of the sample; different streams are independent.

    Raises
    ------
    InputError
        A pulley size of the loop is not in the draws.
    """
    refuse_sizes(loop, posterior)
    n = posterior.count

    def generator(key: str) -> np.random.Generator:
        # each number has its own stream: an additional number does not change the others
        name = f"{loop.name}/{key}"
        return np.random.default_rng([seed, 7, stream, zlib.crc32(name.encode())])

    order = generator("order").permutation(n) if stream else np.arange(n)
    rig = discrepancy.sd * generator("rig").standard_normal(n)

    def scattered(kind: str, key: str, scatter: Array | None) -> Array:
        # deviation of a run's assembly from the law
        if scatter is None:
            return np.zeros(n)
        deviation = generator(f"{kind}.{key.removeprefix('runs.')}").standard_normal(n)
        return scatter[order] * deviation

    factor, factor_of_c2 = {}, {}
    for key, run in loop.every_run:
        size = run.pulley_size
        factor[key] = 1 + scattered("assembly", key, posterior.omega.get(size)) + rig
        of_c2 = scattered("intercept", key, posterior.omega_intercept.get(size))
        factor_of_c2[key] = factor[key] + of_c2
    numbers, uncertain = {}, []
    for key, value in _quantities(loop).items():
        if is_uncertain(value):
            uncertain.append(key)
            numbers[key] = from_normal(value, generator(key).standard_normal(n))  # type: ignore[arg-type]
        else:
            numbers[key] = np.full(n, central(value))  # type: ignore[arg-type]
    acting = tuple(effect.taken(order) for effect in posterior.acting)
    coefficients = {size: taken(law, order) for size, law in posterior.coefficients.items()}
    return Assembly(coefficients, factor, factor_of_c2, numbers, tuple(uncertain), acting)


def refuse_sizes(loop: Loop, posterior: Posterior) -> None:
    """Raise for runs over pulleys of a size that is not in the draws."""
    sizes = set(posterior.coefficients)
    faults = [
        Fault(
            loop.name,
            f"a size of the draws: {', '.join(sorted(sizes))}",
            column=f"{key}.pulley_size",
            value=run.pulley_size,
        )
        for key, run in loop.every_run
        if run.pulley_size not in sizes
    ]
    if faults:
        raise InputError(faults)


def nominal_assembly(loop: Loop, posterior: Posterior) -> Assembly:
    """Return one draw: posterior means, no scatter, no effects, medians of uncertain numbers."""
    unscattered = {key: np.ones(1) for key, _ in loop.every_run}
    return Assembly(
        {
            size: Coefficients(*(np.array([np.mean(np.asarray(part))]) for part in law))
            for size, law in posterior.coefficients.items()
        },
        unscattered,
        unscattered,
        {key: np.array([central(value)]) for key, value in _quantities(loop).items()},  # type: ignore[arg-type]
        (),
    )
