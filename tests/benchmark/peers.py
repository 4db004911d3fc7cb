"""Other people's samplers on a posterior of the benchmark, in an environment of their own.

``python peers.py SAMPLER PROBLEM.npz RESULT.npz SEED``; it imports nothing of the package. The
result holds draws in the parameters' units, shape (chains, draws, D), and processor seconds.
"""

import os
import sys
import time

os.environ["XLA_FLAGS"] = (
    "--xla_cpu_multi_thread_eigen=false --xla_force_host_platform_device_count=1"
)

import numpy as np

CHAINS, WARM_UP, DRAWS = 4, 500, 1000
JITTER = 0.1  # of starts, in unconstrained numbers


def main(sampler, problem, result, seed):
    """Sample a problem and write what was found."""
    with np.load(problem) as stored:
        data = dict(stored)
    np.savez(result, **SAMPLERS[sampler](data, int(seed)))


def _timed(draw, total):
    """Return draws of a compiled function, its seconds, and all seconds before it."""
    began = time.process_time()
    draws = draw()
    seconds = time.process_time() - began
    return {"theta": draws, "seconds": seconds, "before": total}


def _starts(posterior, seed):
    """Start near the priors' scales.

    From starts as far as a prior is wide, a chain in four ends in a mode of no weight at
    ``omega`` = 0.4, and the peer could not be compared with.
    """
    return np.random.default_rng(seed).uniform(-JITTER, JITTER, (CHAINS, len(posterior.names)))


def _constrained(posterior):
    import jax
    import jax.numpy as jnp

    def natural(u):
        theta = posterior.constrain(u)[0]
        return jnp.stack([theta[name] for name in posterior.names])

    return jax.jit(jax.vmap(jax.vmap(natural)))


def numpyro_nuts(data, seed):
    """NumPyro's NUTS; its mass matrix is dense, since coefficients of one size trade off."""
    import jax
    from jax_density import Posterior
    from numpyro.infer import MCMC, NUTS

    posterior = Posterior(data)
    kernel = NUTS(potential_fn=lambda u: -posterior.log_density(u), dense_mass=True)
    mcmc = MCMC(
        kernel,
        num_warmup=WARM_UP,
        num_samples=DRAWS,
        num_chains=CHAINS,
        chain_method="vectorized",
        progress_bar=False,
    )
    mcmc.run(jax.random.PRNGKey(seed), init_params=_starts(posterior, seed))
    cold = time.process_time()
    mcmc.post_warmup_state = mcmc.last_state

    def draw():
        mcmc.run(jax.random.PRNGKey(seed + 1000))
        return mcmc.get_samples(group_by_chain=True).block_until_ready()

    timed = _timed(draw, cold)
    draws = timed["theta"]
    # The first run was warm-up, compilation and as many draws.
    timed["before"] -= timed["seconds"]
    return timed | {"theta": np.asarray(_constrained(posterior)(draws))}


def blackjax_nuts(data, seed):
    """BlackJAX's NUTS with its window adaptation, dense likewise."""
    import blackjax
    import jax
    from jax_density import Posterior

    posterior = Posterior(data)
    adaptation = blackjax.window_adaptation(
        blackjax.nuts, posterior.log_density, is_mass_matrix_diagonal=False
    )

    def run(key, start):
        first, second = jax.random.split(key)
        (state, parameters), _ = adaptation.run(first, start, num_steps=WARM_UP)
        return state, parameters, second

    def sample(state, parameters, key):
        step = blackjax.nuts(posterior.log_density, **parameters).step

        def transition(state, key):
            state, _ = step(key, state)
            return state, state.position

        return jax.lax.scan(transition, state, jax.random.split(key, DRAWS))[1]

    keys = jax.random.split(jax.random.PRNGKey(seed), CHAINS)
    adapted = jax.block_until_ready(jax.jit(jax.vmap(run))(keys, _starts(posterior, seed)))
    compiled = jax.jit(jax.vmap(sample)).lower(*adapted).compile()
    timed = _timed(lambda: compiled(*adapted).block_until_ready(), time.process_time())
    return timed | {"theta": np.asarray(_constrained(posterior)(timed["theta"]))}


def nutpie_nuts(data, seed):
    """nutpie's NUTS with a diagonal mass matrix, its default; one chain at a time."""
    import jax
    import nutpie
    from jax_density import Posterior
    from nutpie.compiled_pyfunc import from_pyfunc

    posterior = Posterior(data)
    both = jax.jit(jax.value_and_grad(posterior.log_density))

    def density():
        def value_and_slope(u):
            value, slope = both(u)
            return float(value), np.asarray(slope, dtype=np.float64)

        return value_and_slope

    def expand(*_):
        return lambda u: {"u": np.asarray(u, dtype=np.float64)}

    size = len(posterior.names)
    model = from_pyfunc(
        size,
        density,
        expand,
        [np.dtype(np.float64)],
        [(size,)],
        ["u"],
        make_initial_point_fn=lambda its: np.random.default_rng(its).uniform(-JITTER, JITTER, size),
    )

    def draw(count):
        drawn = nutpie.sample(
            model,
            draws=count,
            tune=WARM_UP,
            chains=CHAINS,
            cores=1,
            seed=seed,
            progress_bar=False,
        )
        return drawn.posterior["u"].to_numpy()

    draw(1)  # compilation, and the warm-up, which a longer run of this seed repeats
    cold = time.process_time()
    draw(1)
    warm_up = time.process_time() - cold
    timed = _timed(lambda: draw(DRAWS), cold)
    timed["seconds"] -= warm_up
    return timed | {"theta": np.asarray(_constrained(posterior)(timed["theta"]))}


SAMPLERS = {
    "NumPyro NUTS": numpyro_nuts,
    "BlackJAX NUTS": blackjax_nuts,
    "nutpie NUTS": nutpie_nuts,
}

if __name__ == "__main__":
    main(*sys.argv[1:])
