"""Formulas and what they are altered to: the file, its text and another text, one at a time.

They were chosen by reading the files, without looking at what the fingerprint holds: each is a
slip of a sign, a factor, an exponent or a term that a rewrite could make.
"""

PHYSICS = """
physics/friction.py | (_floats(wrap_angle_deg) - REFERENCE | (_floats(wrap_angle_deg) + REFERENCE
physics/friction.py | share = -np.expm1(n * np.log1p(-a)) | share = n * a
physics/friction.py | np.where(a == 0, n, share | np.where(a == 0, 1.0, share
physics/friction.py | return at_drive / (1 - loss.share / 2) | return at_drive / (1 - loss.share)
physics/friction.py | np.exp(total[..., None] - np.cumsum | np.exp(total[..., None] + np.cumsum
physics/gravity.py | condition.total_mass_kg * gravity - difference | condition.total_mass_kg * gravity + difference
physics/gravity.py | condition.total_mass_kg - slope * half_difference | condition.total_mass_kg + slope * half_difference
physics/gravity.py | (condition.total_mass_kg - loss.share * mass_drive) | condition.total_mass_kg
physics/gravity.py | self.acceleration * time**2 * 0.5 | self.acceleration * time**2
physics/gravity.py | np.sqrt(v0**2 + 2 * alpha * distance) | np.sqrt(v0**2 + alpha * distance)
physics/gravity.py | frictionless + factor * (alpha - frictionless) | factor * alpha
physics/motor.py | friction = sign * (slope * condition.weight_n + constant) / (1 - 0.5 * sign * slope) | friction = sign * (slope * condition.weight_n + constant) / (1 + 0.5 * sign * slope)
physics/motor.py | lowering = -recursive_friction(loss, condition.weight_n, "drive") | lowering = -recursive_friction(loss, condition.weight_n, "load")
physics/motor.py | condition.weight_n + 0.5 * np.asarray(friction_n) | condition.weight_n + np.asarray(friction_n)
physics/laws.py | return recursive_friction(loss, tension_n, "mean") | return recursive_friction(loss, tension_n, "drive")
physics/laws.py | dtype=np.float64) / 2) | dtype=np.float64))
physics/loads.py | sharp * (1 - end**2) / whole | sharp * (1 - end) / whole
physics/loads.py | halved = 0.25 * pull * step**2 | halved = 0.5 * pull * step**2
physics/loads.py | (before - coasting) / loss | (before + coasting) / loss
physics/loads.py | np.where(each > 0, each, slows) / length | np.where(each > 0, each, slows) / length**2
physics/stepped.py | faster = v + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4) | faster = v + step / 6 * (a1 + 2 * a2 + 3 * a3)
physics/stepped.py | curved = 3 * rise - 2 * slope0 - slope1 | curved = 3 * rise - slope0 - 2 * slope1
physics/cable.py | stiffness / np.asarray(self.length_m | stiffness * np.asarray(self.length_m
"""

EFFECTS = """
effects/base.py | missing = 1 - missing * np.exp | missing = 1 + missing * np.exp
effects/stribeck.py | ratio = np.asarray(state.speed_m_s) / p["speed"] | ratio = np.asarray(state.speed_m_s) * p["speed"]
effects/tension_curvature.py | / MIDDLE_TENSION_N - 1 | / MIDDLE_TENSION_N + 1
effects/terms.py | return np.asarray(amplitude * self.spline(place).T) | return np.asarray(amplitude * self.spline(0 * place).T)
effects/candidates.py | return median * float(np.exp(sd**2 / 2)), median * sd | return median, median * sd
"""

LIKELIHOODS = """
inference/priors.py | np.log(2 / scale) - 0.5 * (LOG_2PI | np.log(1 / scale) - 0.5 * (LOG_2PI
inference/priors.py | return np.asarray(median * np.exp(sd * z)) | return np.asarray(median * np.exp(sd**2 * z))
inference/model.py | raised = np.log(value[:, bent]) * (power[bent] - 1) | raised = np.log(value[:, bent]) * power[bent]
inference/model.py | prior = -0.5 * (LOG_2PI + z**2).sum(axis=1) | prior = -0.5 * (z**2).sum(axis=1)
inference/grouped_normal.py | return np.asarray(0.5 * (np.log(precision) - LOG_2PI - score**2 / precision)) | return np.asarray(0.5 * (np.log(precision) - LOG_2PI - score**2 * precision))
inference/grouped_normal.py | ndtr(sign * (score / np.sqrt(precision))) | ndtr(sign * (score / precision))
inference/grouped_normal.py | precision = precision - along**2 / gain | precision = precision - along / gain
inference/grouped_normal.py | np.where(square > 0, score / np.sqrt(square), np.nan) | np.where(square > 0, score / square, np.nan)
inference/grouped_normal.py | np.eye(rank) + whole | 2 * np.eye(rank) + whole
inference/heavy_groups.py | log_weight = width.logpdf(np.exp(log)) + log | log_weight = width.logpdf(np.exp(log))
inference/heavy_groups.py | scales = 1 / np.sqrt(self._nodes[0]) | scales = 1 / self._nodes[0]
inference/quadratic.py | pivot = 1 + variance * row[0] | pivot = 1 + variance * row[0] ** 2
inference/quadratic.py | squares[2] += other * (2 * across - row[0] * other) | squares[2] += other * (2 * across)
inference/cosines.py | * np.asarray(length)) ** 2 / 3) ** -2 | * np.asarray(length)) ** 2 / 2) ** -2
inference/thresholds.py | spread = np.sqrt(1 + (slope[:, 0] ** 2).sum(axis=-1)) | spread = np.sqrt((slope[:, 0] ** 2).sum(axis=-1))
rigs/gravity_board/hall_events.py | tick_variance=tick_s**2 / 12 | tick_variance=tick_s**2 / 3
rigs/gravity_board/hall_events.py | clock = np.sqrt(sigma_t**2 + self.tick_variance) | clock = sigma_t + 0 * np.sqrt(self.tick_variance)
rigs/gravity_board/hall_events.py | self.degrees_of_freedom * (LOG_2PI + np.log(scale2)) | self.degrees_of_freedom * np.log(scale2)
rigs/gravity_board/hall_events.py | relative2 = (self.speed / self.typical_speed) ** 2 | relative2 = (self.speed / self.typical_speed) ** 0
rigs/gravity_board/likelihood.py | own = (law * tau) ** 2 + variance | own = (law * tau) ** 2 + 2 * variance
rigs/gravity_board/likelihood.py | forces.mass**2 * acceleration.variance | forces.mass * acceleration.variance
rigs/gravity_board/likelihood.py | acceleration.log_constant + np.log(forces.mass) | acceleration.log_constant - np.log(forces.mass)
rigs/gravity_board/likelihood.py | np.stack([law * omega, self._intercept(theta) * of_intercept]) | np.stack([law * omega, law * of_intercept])
rigs/gravity_board/likelihood.py | 0.5 * (LOG_2PI - np.log(precision)) + np.log(np.abs(law)) | 0.5 * (LOG_2PI - np.log(precision)) - np.log(np.abs(law))
rigs/gravity_board/wander.py | (rms * friction_n) ** 2) | rms * friction_n)
rigs/gravity_board/wander.py | 2 * (self._rms(theta, size) * friction_n) ** 2 | (self._rms(theta, size) * friction_n) ** 2
rigs/motor_board/likelihood.py | (theta["load_noise"][:, None] * load) ** 2 | (theta["load_noise"][:, None] * load)
rigs/motor_board/likelihood.py | sign * speed**2] | sign * speed**3]
rigs/steady_points/likelihood.py | (theta[TAU][:, None] * law) ** 2 + self._error(theta) ** 2 | (theta[TAU][:, None] * law) ** 2 + self._error(theta)
rigs/single_axis/likelihood.py | whole = square - along**2 / stiff + determinant | whole = square - along / stiff + determinant
rigs/single_axis/likelihood.py | (theta["tau"][:, None] * law) ** 2 | (theta["tau"][:, None] * law)
rigs/single_axis/weak_form.py | curvature = HEIGHT / width**3 * (-6 * inside**2 + 24 | curvature = HEIGHT / width**3 * (-6 * inside**2 - 24
rigs/single_axis/covariance.py | mass**2 * banded(readings.position_lag) | mass * banded(readings.position_lag)
"""

EVIDENCE = """
inference/laplace.py | step = np.sqrt(2 * DROP) * unit :: 1 | step = 1.5 * np.sqrt(2 * DROP) * unit
inference/laplace.py | hessian = np.diag(bent / step**2) | hessian = np.diag(bent / step)
inference/evidence/importance.py | Evidence(float(total - np.log(size)) | Evidence(float(total + np.log(size))
inference/evidence/importance.py | (weights**2).sum() - 1 / size | (weights**2).sum() + 1 / size
inference/evidence/importance.py | np.logaddexp(*(np.log(share) + one.log_density(z) | np.logaddexp(*(one.log_density(z)
inference/evidence/bridge.py | shift = np.log(counted / at_proposed.size) | shift = np.log(at_proposed.size / counted)
inference/evidence/bridge.py | expit(at_proposed - value + shift) | expit(at_proposed - value - shift)
inference/evidence/bridge.py | part.var() / part.mean() ** 2 / part.size | part.var() / part.mean() / part.size
inference/evidence/leave_out.py | np.sqrt(values.size * values.var(ddof=1)) | np.sqrt(values.var(ddof=1))
inference/proposals.py | power = 0.5 * (self.freedom + self.location.size) | power = 0.5 * (self.freedom + self.location.size - 1)
inference/proposals.py | covariance * (freedom - 2) / freedom | covariance * freedom / freedom
inference/power.py | log_density(prior, amplitude) - 0.5 * (NODES**2 + LOG_2PI) | log_density(prior, amplitude) - 0.5 * NODES**2
claims/comparison.py | LN10 = float(np.log(10)) | LN10 = float(np.log(2))
claims/studies.py | np.log(width) - here | here
"""

DIAGNOSIS = """
inference/information.py | log_determinant = 2 * np.log | log_determinant = np.log
inference/information.py | value -= np.log(np.diag(factor[0])).sum() | value += np.log(np.diag(factor[0])).sum()
inference/information.py | 0.5 * mean @ left + 0.5 * slope @ moved | 0.5 * mean @ left + slope @ moved
inference/smooths.py | np.exp(-0.5 * ((grid[:, None] - grid) / length) ** 2) | np.exp(-((grid[:, None] - grid) / length) ** 2)
rigs/gravity_board/scattered.py | 0.5 * sums.freedom * np.log(kappa) | sums.freedom * np.log(kappa)
rigs/gravity_board/scattered.py | (sums.square + (right**2).sum()) / kappa | (sums.square - (right**2).sum()) / kappa
rigs/gravity_board/linear_scatter.py | return -0.5 * float((np.log(value) / KAPPA_SD_LOG) ** 2) | return -float((np.log(value) / KAPPA_SD_LOG) ** 2)
rigs/points.py | self._error2(noise)[runs] + (noise[self._own] * moved) ** 2 | self._error2(noise)[runs] + (noise[self._own] * moved)
rigs/points.py | LOG_2PI + 2 * np.log(sigma) | LOG_2PI + np.log(sigma)
rigs/shared_deviation.py | 0.5 * float(pulled - np.linalg.slogdet(whole)[1].sum()) | 0.5 * float(pulled + np.linalg.slogdet(whole)[1].sum())
rigs/single_axis/linear.py | constant += shared.constant - 0.5 * shared.rest[k, k] | constant += shared.constant - shared.rest[k, k]
rigs/single_axis/linear.py | Levels(tau**2, omega**2, run**2 | Levels(tau**2, omega, run**2
diagnosis/discrepancy.py | part = np.sqrt(len(self.smooths) / np.count_nonzero(chosen)) | part = len(self.smooths) / np.count_nonzero(chosen)
diagnosis/discrepancy.py | part = share / np.sqrt(len(effects) * len(each)) | part = share / (len(effects) * len(each))
diagnosis/scales.py | np.full(sum(one.count for one in own), 1 / np.sqrt(terms)) | np.full(sum(one.count for one in own), 1 / terms)
diagnosis/shapes.py | value -= 0.5 * at @ at | value -= at @ at
diagnosis/shapes.py | density = found - 0.5 * grid**2 | density = found
diagnosis/hypotheses.py | rest * mass / comb(len(self.classes.members), number) | rest * mass / len(self.classes.members)
diagnosis/hypotheses.py | np.log(rest * prior.unknown) | np.log(prior.unknown**2)
diagnosis/unknown.py | - np.log(len(nodes))) + volume | + np.log(len(nodes))) + volume
diagnosis/weighing.py | 0.5 * (values.size * np.log(2 * np.pi) - np.log(values).sum()) | 0.5 * (values.size * np.log(2 * np.pi) + np.log(values).sum())
diagnosis/weighing.py | np.log(len(forms))) + prior | np.log(len(forms)))
diagnosis/weighing.py | + np.log(shifts[1] - shifts[0])) | - np.log(shifts[1] - shifts[0]))
diagnosis/systematic.py | gap = np.sqrt(weight @ force**2 + hidden2) | gap = np.sqrt(weight @ force**2 - 0.5 * (weight @ force) ** 2 + hidden2)
diagnosis/systematic.py | float(np.sqrt((weight * column**2).sum() / friction2)) | float((weight * column**2).sum() / friction2)
diagnosis/residuals.py | 1 / (windows * trials * np.unique(self.condition).size) | 1 / (windows * windows.size / np.mean(windows))
diagnosis/held_out.py | (left**2 - np.asarray(chance2) + scatter2) | (left**2 - np.asarray(chance2))
diagnosis/held_out.py | left2 = one.refit.kept(drawn + off)[rows] ** 2 | left2 = one.refit.kept(drawn)[rows] ** 2
diagnosis/where.py | noise = residuals.variance / residuals.friction_n**2 | noise = residuals.variance / residuals.friction_n
diagnosis/forms.py | return found | return found[:1] :: 0
"""

MARGINS = """
margins/describing.py | effective_damping(shaft) / (2 * np.sqrt(shaft.kp * shaft.inertia)) | effective_damping(shaft) / np.sqrt(shaft.kp * shaft.inertia)
margins/describing.py | np.sqrt(shaft.kp / shaft.inertia) | np.sqrt(shaft.inertia / shaft.kp)
margins/linear.py | return 1 / np.sqrt(apart), 1 / np.sqrt(inverse) | return 1 / apart, 1 / np.sqrt(inverse)
margins/linear.py | (1 + value.real) ** 2 + value.imag**2 | (1 - value.real) ** 2 + value.imag**2
margins/linear.py | return 2 * np.sqrt(least), where | return np.sqrt(least), where
margins/cable_run.py | (np.arange(run.count) + 0.5)[None, :] / run.count | np.arange(run.count)[None, :] / run.count
margins/cable_stage.py | rho**2 * sides * given | rho * sides * given
margins/cable_stage.py | return np.sqrt(last / upper), np.sqrt(upper) | return np.sqrt(last), np.sqrt(upper)
margins/swing.py | rms = np.sqrt(self._squares / | rms = (self._squares /
margins/shaft.py | second = np.where(near, 0.5 * series, | second = np.where(near, series,
margins/open_loop.py | np.sqrt(self.stiffness / self.load_inertia) | np.sqrt(self.stiffness * self.load_inertia)
margins/loop_at_shaft.py | np.sqrt(self.stiffness * (1 / self.load_inertia + 1 / self.motor_inertia)) | np.sqrt(self.stiffness / self.motor_inertia)
"""

SIMULATORS = """
rigs/gravity_board/simulator.py | (1 / np.sqrt(far[setup_index]) - 1) | (1 / far[setup_index] - 1)
rigs/gravity_board/simulator.py | truth.wander * np.sqrt(variance)[:, None] | truth.wander * variance[:, None]
rigs/motor_board/simulator.py | curvature * speed**2)) | curvature * speed + 1e-4))
rigs/single_axis/simulator.py | acceleration = -((size * rate**2) | acceleration = -((size * rate)
rigs/single_axis/simulator.py | size = np.sqrt(cosine_variances(length / extent, MODES)) | size = cosine_variances(length / extent, MODES)
rigs/steady_points/simulator.py | np.abs(speed), **around | speed, **around
"""


def altered_formulas() -> list[tuple[str, str, str, str, int]]:
    """Return room, file, text, other text, and which occurrence of the text, from 0."""
    found = []
    rooms = {
        "physics": PHYSICS,
        "effects": EFFECTS,
        "likelihoods": LIKELIHOODS,
        "evidence": EVIDENCE,
        "diagnosis": DIAGNOSIS,
        "margins": MARGINS,
        "simulators": SIMULATORS,
    }
    for room, rows in rooms.items():
        for row in rows.strip().splitlines():
            body, _, place = row.partition(" :: ")
            if place and " | " in place:
                place, _, rest = place.partition(" | ")
                body = f"{body} | {rest}"
            file, old, new = body.split(" | ")
            found.append((room, file.strip(), old, new, int(place or 0)))
    return found
