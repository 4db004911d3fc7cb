"""The posterior of the benchmark in JAX, from the arrays of :mod:`benchmark.problems`.

It imports nothing of the package: draws from both show whether the two densities agree.
"""

import jax
import jax.numpy as jnp
import numpy as np

jax.config.update("jax_enable_x64", True)  # the events' sums do not survive single precision
LOG_2PI = float(np.log(2 * np.pi))


class Posterior:
    """Log prior and log likelihood of parameters in their units.

    Parameters
    ----------
    data : mapping of str to ndarray
        As :func:`benchmark.problems.arrays_of` returns them.
    """

    def __init__(self, data):
        self.names = [str(name) for name in data["names"]]
        self.families = dict(zip(self.names, map(str, data["family"]), strict=True))
        self.scales = dict(zip(self.names, data["scale"], strict=True))
        self._sizes = [str(size) for size in data["sizes"]]
        # Products with tables of zeros and ones: XLA is slow at gathering and scattering.
        self._of_size = jnp.eye(len(self._sizes))[data["size"]]
        self._of_setup = jnp.eye(int(data["setup"].max()) + 1)[data["setup"]]
        self._data = {k: jnp.asarray(v) for k, v in data.items() if v.dtype.kind in "fi"}
        self._modes = int(data["modes"]) if "modes" in data else 0

    def constrain(self, u):
        """Return parameters by name, and the log slope, of unconstrained numbers of shape (D,)."""
        theta, slope = {}, 0.0
        for place, name in enumerate(self.names):
            scale, centre = self.scales[name]
            if self.families[name] == "normal":
                theta[name] = centre + scale * u[place]
            elif self.families[name] == "half-normal":
                theta[name] = scale * jnp.exp(u[place])
                slope += u[place]
            else:
                theta[name] = jnp.exp(centre + scale * u[place])
                slope += centre + scale * u[place]
        return theta, slope

    def log_density(self, u):
        """Return the log posterior of unconstrained numbers, up to a constant."""
        theta, slope = self.constrain(u)
        return self.log_prior(theta) + slope + self.log_likelihood(theta)

    def log_prior(self, theta):
        """Return the log prior up to a constant."""
        total = 0.0
        for name, value in theta.items():
            scale, centre = self.scales[name]
            if self.families[name] == "log-normal":
                total -= 0.5 * ((jnp.log(value) - centre) / scale) ** 2 + jnp.log(value)
            else:
                total -= 0.5 * ((value - centre) / scale) ** 2
        return total

    def log_likelihood(self, theta):
        """Return the log density of the data."""
        d = self._data
        c1, c2, c3 = (
            self._of_size @ jnp.stack([theta[f"{name}[{size}]"] for size in self._sizes])
            for name in ("c1", "c2", "c3")
        )
        slope, intercept = d["pulleys"] * (c1 + c3 * d["wrap"]), d["pulleys"] * c2
        law = (slope * d["still"] + intercept) / (1 - slope * d["feedback"])
        mean, variance, constant = self._acceleration(theta, law)
        residual = d["drive"] - d["mass"] * mean - law
        own = (law * theta["tau"]) ** 2 + d["mass"] ** 2 * variance
        first, second = law * theta["omega"], intercept * theta["omega_intercept"]

        def total(values):
            return values @ self._of_setup

        # Normal in the two numbers of each assembly, which are integrated out.
        a, b = 1 + total(first**2 / own), 1 + total(second**2 / own)
        c = total(first * second / own)
        p, q = total(first * residual / own), total(second * residual / own)
        determinant = a * b - c**2
        square = total(residual**2 / own)
        square -= (b * p**2 - 2 * c * p * q + a * q**2) / determinant
        grouped = -0.5 * (total(LOG_2PI + jnp.log(own)) + jnp.log(determinant) + square)
        return grouped.sum() + (constant + jnp.log(d["mass"])).sum()

    def _acceleration(self, theta, law):
        """Return mean, variance and log constant of each trial's acceleration."""
        d = self._data
        if "acceleration" in d:
            return d["acceleration"], d["acceleration_sd"] ** 2, 0.0
        clock = jnp.sqrt(theta["sigma_t"] ** 2 + d["tick_variance"]) * d["typical_speed"]
        scale2 = theta["sigma_x"] ** 2 + clock**2
        x = jnp.clip(jnp.log(clock / theta["sigma_x"]), d["knots"][0], d["end"][0])
        piece = jnp.clip(jnp.searchsorted(d["knots"], x, side="right") - 1, 0)
        step = x - d["knots"][piece]
        row = jnp.zeros(d["basis"].shape[0] - 1)
        for power in d["pieces"]:  # Horner
            row = row * step + power[piece]
        row = jnp.concatenate([jnp.ones(1), row])
        parts = (d["basis"].T @ (row / scale2)).reshape(-1, law.size)
        log_determinant = parts[-1] * scale2
        constant = d["constant"] + log_determinant
        constant -= 0.5 * d["degrees_of_freedom"] * (LOG_2PI + jnp.log(scale2))
        order = jnp.arange(1, self._modes + 1) * theta["wander_length"] / d["extent"]
        density = (1 + (jnp.pi * order) ** 2 / 3) ** -2
        share = density / density.sum()
        # Triangle of the six cosines, the acceleration and the residual.
        side, rows, start = self._modes + 2, {}, 0
        for i in range(side):
            for j in range(i, side):
                rows[i, j] = parts[start]
                start += 1
        square = (theta["wander"] * law) ** 2
        for k in range(self._modes):
            variance = share[k] * square
            pivot = 1 + variance * rows[k, k]
            constant -= 0.5 * jnp.log(pivot)
            for i in range(k + 1, side):
                for j in range(i, side):
                    rows[i, j] -= variance / pivot * rows[k, i] * rows[k, j]
        m = self._modes
        precision, right, squares = rows[m, m], rows[m, m + 1], rows[m + 1, m + 1]
        constant += 0.5 * (right**2 / precision - squares + LOG_2PI - jnp.log(precision))
        return d["origin"] + right / precision, 1 / precision, constant
