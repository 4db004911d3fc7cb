"""Margins against python-control, on loops whose crossings are roots of polynomials."""

import control
import numpy as np
import pytest

from bayesfric.margins.linear import is_stable, linear_margins, peaks

LOOPS = 240


def rational(num, den):
    """The frequency response of rational loops, a row of coefficients each."""

    def response(omega, rows):
        s = 1j * omega
        above, below = np.zeros_like(s * rows), np.zeros_like(s * rows)
        for power in range(num.shape[1]):
            above = above * s + num[rows, power]
        for power in range(den.shape[1]):
            below = below * s + den[rows, power]
        return above / below

    return response


def delayed(gain, lag):
    """gain e^{−jωτ}/jω."""
    return lambda omega, rows: gain * np.exp(-1j * omega * lag) / (1j * omega)


def random_loops(seed):
    """Stable closed loops with one or two integrators or none, some conditionally stable."""
    rng = np.random.default_rng(seed)
    num, den = [], []
    while len(num) < LOOPS:
        origin = rng.integers(0, 3)
        below = np.eye(1, int(origin) + 1)[0]
        for _ in range(rng.integers(1, 3)):
            pole, ratio = 10 ** rng.uniform(-1, 2), rng.uniform(0.03, 1.0)
            below = np.polymul(below, [1, 2 * ratio * pole, pole**2])
        degree = rng.integers(0, len(below) - 2)
        above = np.atleast_1d(np.poly(-(10 ** rng.uniform(-1, 2, degree))))
        reference = 10 ** rng.uniform(-1, 2)
        above = above / abs(np.polyval(above, 1j * reference) / np.polyval(below, 1j * reference))
        if np.roots(np.polyadd(below, above)).real.max() > -1e-4:
            continue
        num.append(np.pad(above, (7 - len(above), 0)))
        den.append(np.pad(below, (7 - len(below), 0)))
    return np.array(num), np.array(den)


@pytest.fixture(scope="module")
def loops():
    return random_loops(1)


@pytest.mark.nightly
def test_margins_of_random_loops_are_those_of_python_control(loops):
    num, den = loops
    omega = np.tile(np.geomspace(1e-4, 1e5, 3000), (LOOPS, 1))
    margins = linear_margins(rational(num, den), omega)
    most_s, most_t = peaks(rational(num, den), omega)
    crossed = 0
    for row in range(LOOPS):
        system = control.tf(np.trim_zeros(num[row], "f"), np.trim_zeros(den[row], "f"))
        gains, phases, _, _, at_gain, _ = control.stability_margins(
            system, returnall=True, method="poly"
        )
        gains = gains[np.isfinite(gains) & (gains > 0)]
        if gains.size:
            nearest = gains[np.abs(np.log(gains)).argmin()]
            assert margins.gain[row] == pytest.approx(nearest, rel=1e-6)
        else:
            assert np.isinf(margins.gain[row])
        if at_gain.size:
            crossed += at_gain.size > 1
            assert margins.phase[row] == pytest.approx(np.radians(np.abs(phases).min()), rel=1e-6)
            lag = np.mod(np.radians(phases), 2 * np.pi) / at_gain
            assert margins.delay[row] == pytest.approx(lag.min(), rel=1e-6)
            assert margins.crossings[row] == at_gain.size
        else:
            assert np.isinf(margins.phase[row])
        value = rational(num, den)(omega[row], row)
        near = omega[row]
        for width in (8e-3, 2e-5):  # the second for loops that hardly are stable
            size = rational(num, den)(near, row)
            nearest = near[(np.abs(1 + size) / np.abs(1 - size)).argmin()]
            near = nearest * np.exp(np.linspace(-width, width, 801))
        grid = np.sort(np.concatenate([omega[row, ::10], near]))
        disk, _, _ = control.disk_margins(system, grid)
        assert margins.disk[row] == pytest.approx(float(disk), rel=1e-6)
        if row % 5:  # peaks need fine grids: a fifth of the loops will do
            continue
        for closed, peak, sizes in (
            (control.feedback(1, system), most_s, np.abs(1 / (1 + value))),
            (control.feedback(system, 1), most_t, np.abs(value / (1 + value))),
        ):
            top, most = omega[row, sizes.argmax()], sizes.max()
            for width in (8e-3, 6e-5):  # the second for peaks of loops that hardly are stable
                near = top * np.exp(np.linspace(-width, width, 401))
                fine = np.abs(control.frequency_response(closed, near).complex)
                top, most = near[fine.argmax()], max(most, fine.max())
            assert peak[row] == pytest.approx(most, rel=1e-6)
    assert crossed >= 10  # several crossings are part of the test


def test_stability_is_that_of_the_poles():
    rng = np.random.default_rng(2)
    num, den = random_loops(3)
    num = num * 10 ** rng.uniform(-1, 2, (LOOPS, 1))
    omega = np.tile(np.geomspace(1e-5, 1e6, 2000), (LOOPS, 1))
    stable = np.array(
        [np.roots(np.polyadd(d, n)).real.max() < 0 for n, d in zip(num, den, strict=True)]
    )
    assert 20 < stable.sum() < LOOPS - 20
    assert is_stable(rational(num, den), omega).tolist() == stable.tolist()


def test_an_integrator_with_delay_by_hand():
    # L = k e^{−jωτ}/jω: crossings at k and π/2τ; stable below k τ = π/2.
    omega = np.geomspace(1e-3, 1e4, 600)[None, :]
    margins = linear_margins(delayed(2.0, 0.1), omega)
    assert margins.phase == pytest.approx(np.pi / 2 - 0.2, rel=1e-9)
    assert margins.gain == pytest.approx(np.pi / 0.4, rel=1e-9)
    assert margins.delay == pytest.approx((np.pi / 2 - 0.2) / 2.0, rel=1e-9)
    gains = np.array([15.6, 15.8])
    pair = lambda w, r: gains[r] * np.exp(-0.1j * w) / (1j * w)  # noqa: E731
    assert is_stable(pair, np.repeat(omega, 2, axis=0)).tolist() == [True, False]


def test_a_gain_that_may_only_rise_or_only_fall():
    # L = k (s + 1)²/s³ is stable above k = 1/2 only: the margin is downward.
    num, den = np.array([[2.0, 4.0, 2.0]]), np.array([[1.0, 0, 0, 0]])
    margins = linear_margins(rational(num, den), np.geomspace(1e-3, 1e3, 600)[None, :])
    assert margins.gain == pytest.approx(0.25, rel=1e-9)
