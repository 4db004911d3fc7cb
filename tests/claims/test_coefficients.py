"""Table I is supported where data inform it and are narrow, and never because they are few."""

import numpy as np
import pytest
from altered import by_acceleration

from bayesfric.analysis import Analysis, ClaimRules, Sampler
from bayesfric.claims import check_claims
from bayesfric.claims.base import Case
from bayesfric.claims.coefficients import CLAIM, decide, largest_difference
from bayesfric.claims.entered import Entered
from bayesfric.fitting.hypothesis import LawWithEffects, model_of
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.sampling import sample
from bayesfric.paper import table1
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

RULES = ClaimRules()
SHORT = Sampler(burn=10, steps=80, thin=3, extensions=0)


def draws_of(**factors):
    """Table I's coefficients times factors, one draw."""
    return {
        f"{name}[{size}]": np.array([getattr(row, name).value * factors.get(name, 1.0)])
        for size, row in table1().items()
        for name in ("c1", "c2", "c3")
    }


def test_the_largest_difference_is_that_at_a_corner_of_table_2():
    assert largest_difference(draws_of(), ["small"])[0] == 0.0
    every = draws_of(c1=1.25, c2=1.25, c3=1.25)
    assert largest_difference(every, ["small", "large"])[0] == pytest.approx(0.2)
    # Of c3 alone: at 150 degrees and 33 N, by hand.
    row = table1()["small"]
    c1, c2, c3 = (getattr(row, name).value for name in ("c1", "c2", "c3"))
    by_hand = (
        65 * 0.3 * c3 * 33 / ((c1 + 65 * 1.3 * c3) * 33 + c2),
        40 * 0.3 * c3 * 33 / ((c1 - 40 * 1.3 * c3) * 33 + c2),
    )
    difference = largest_difference(draws_of(c3=1.3), ["small"])[0]
    assert difference == pytest.approx(max(by_hand), rel=1e-12)


@pytest.mark.parametrize(
    ("tail", "probability", "uninformed", "verdict"),
    [
        (0.5, 0.95, [], "supported"),
        (0.5, 0.94, [], "undecided"),  # too wide
        (0.5, 1.0, ["c3[small]"], "undecided"),  # rests on a prior
        (0.009, 0.05, [], "refuted"),
        (0.009, 0.06, [], "undecided"),  # off, perhaps by less than matters
        (0.009, 0.0, ["c3[small]"], "refuted"),  # whatever c3 is
    ],
)
def test_verdicts(tail, probability, uninformed, verdict):
    assert decide(RULES, tail, probability, uninformed)[0] == verdict


@pytest.fixture(scope="module")
def one_cell():
    design = Protocol({(9, 85.0): 1}, (6.0, 16.0, 30.0), (), 2)
    return simulate_recording(design, seed=2, rigs=("gravity",))


def test_a_single_cell_supports_nothing(one_cell):
    analysis, entered = Analysis(seed=1), Entered.of(one_cell)
    model = model_of(entered.data["gravity"], analysis, LawWithEffects(), {})
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    drawn = sample(model.log_posterior, laplace, SHORT, 1).z.reshape(-1, laplace.mode.size)
    posterior = {"gravity": model.by_name(model.natural(drawn))}
    finding = CLAIM.judge(CLAIM, Case(one_cell, analysis, entered, {}, posterior=posterior))
    assert finding.verdict == "undecided"
    assert "c3[small]" in finding.figures["uninformed"]
    assert "the prior, not these data" in finding.reason


def test_an_informed_recording_supports_table_1_and_refutes_another():
    informed = simulate_recording("quick", seed=6, rigs=("gravity",))
    laws = {
        s: law._replace(c1=1.12 * law.c1, c2=1.12 * law.c2, c3=1.12 * law.c3)
        for s, law in table1_coefficients().items()
    }
    other = simulate_recording("quick", seed=6, rigs=("gravity",), truth=Truth(coefficients=laws))
    verdicts = [
        check_claims(
            by_acceleration(board), Analysis(seed=1), only=["coefficients"]
        ).summary.claims[0]
        for board in (informed, other)
    ]
    assert [claim.verdict for claim in verdicts] == ["supported", "refuted"]
