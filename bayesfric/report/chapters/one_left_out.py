"""What the fit says of trials it has not seen: probabilities, and predictive densities."""

from collections.abc import Iterator

from bayesfric.plots.assemblies import (
    assemblies_left_out,
    has_assemblies,
    has_probabilities,
    leave_one_out_probabilities,
)
from bayesfric.plots.style import svg_of
from bayesfric.report.content import (
    Block,
    Column,
    Figure,
    Heading,
    Paragraph,
    Table,
    from_file,
    prose,
    right_columns,
)
from bayesfric.report.quantities import (
    MISSING,
    error_cells,
    format_count,
    format_fixed,
    format_number,
    format_probability,
)
from bayesfric.report.rig_words import group_words, rig_words
from bayesfric.report.stored import StoredFit
from bayesfric.schemas.fit import AssemblyCheck, Prediction, Uniformity


def left_out(stored: StoredFit) -> Iterator[Block]:
    """Yield leave-one-trial-out probabilities and leave-one-out predictive densities."""
    fit = stored.fit
    if not fit.prediction:
        return
    yield Heading(2, "Leave-one-out checks")
    if fit.uniformity and has_probabilities(stored.predictive):
        yield from _probabilities(stored, fit.uniformity)
    if fit.assemblies and has_assemblies(stored.predictive):
        yield from _assemblies(stored, fit.assemblies)
    yield _densities(fit.prediction)


def _probabilities(stored: StoredFit, uniformities: tuple[Uniformity, ...]) -> Iterator[Block]:
    yield Paragraph(
        [
            "Each trial is left out in turn, and the model is fitted to all others, those of the "
            f"same {group_words(stored.fit.rigs)[0]} included. The leave-one-out probability of "
            "a trial (LOO-PIT) is the predictive probability of less friction than measured. If "
            "the model is right, these probabilities are uniform. ",
            " ".join(
                _uniform(test, test.trials, rig_words(test.rig).trials) for test in uniformities
            ),
        ]
    )


def further_left_out(stored: StoredFit) -> Iterator[Figure]:
    """Yield the distribution of the leave-one-out probabilities, where there are any."""
    if not (stored.fit.uniformity and has_probabilities(stored.predictive)):
        return
    yield Figure(
        svg_of(leave_one_out_probabilities, stored.predictive),
        from_file(
            "predictive.nc",
            "Distribution function of the leave-one-out probabilities (LOO-PIT) minus the uniform "
            "one. "
            "A curve that first rises and then falls means that trials scatter more than the model "
            "expects. Its mirror image means that they scatter less. A bow to one side means that "
            "friction is biased. "
            "The band is simultaneous: 95 % of recordings made again stay inside it everywhere. "
            f"Trials of one {group_words(stored.fit.rigs)[0]} are correlated as in the model.",
        ),
        "A panel for each rig: a step line around zero, and a band that is widest in the middle "
        "and vanishes at both ends.",
        label="loo-pit",
    )


def _uniform(test: Uniformity | AssemblyCheck, count: int, called: str) -> str:
    """Return how `count` trials or assemblies of a rig lie about their predictions."""
    return (
        f"For the {format_count(count)} {called} of the {rig_words(test.rig).rig}, the test of "
        f"uniformity has p = {format_probability(test.p_value)}. The {called} lie "
        f"{format_fixed(test.spread, 2)} times as far from their prediction as the model expects; "
        f"{format_fixed(test.spread_q05, 2)} to {format_fixed(test.spread_q95, 2)} is expected "
        "(90 %)."
    )


def _assemblies(stored: StoredFit, checked: tuple[AssemblyCheck, ...]) -> Iterator[Block]:
    group, groups = group_words(stored.fit.rigs)
    yield Paragraph(
        [
            "The fit infers the effects of n and of the wrap angle by comparing assemblies, which "
            "differ more than trials of one assembly do. "
            if stored.fit.pulleys
            else "",
            *prose(
                "Each {} is left out with all of its trials, and @assemblies compares it with its "
                "prediction. {}",
                group,
                " ".join(map(_assembly, checked)),
            ),
        ]
    )
    yield Figure(
        svg_of(assemblies_left_out, stored.predictive),
        from_file(
            "predictive.nc",
            f"{groups.capitalize()}, each compared with its prediction from all others. Above, "
            "left: distribution of the predictive probabilities of less friction than measured, "
            "minus the uniform distribution; by chance 95 % of such curves stay inside the band. "
            "Beside it: a Q–Q plot of their normal scores; then one of single trials, each "
            f"predicted from the others of its {group}. Below: the normal scores by condition. If "
            f"all {groups} of a condition lie on one side, the law is biased at that condition.",
        ),
        "Of each rig a step line around zero inside a band, points along a diagonal, and points by "
        "condition about zero, most of them within a shaded band of the 90 percent interval.",
        label="assemblies",
        floats=True,
    )


def _assembly(check: AssemblyCheck) -> str:
    far = "; ".join(
        f"{outlier.setup} {format_fixed(abs(outlier.z), 1)} sd "
        f"{'above' if outlier.z > 0 else 'below'} (by chance, 1 recording in "
        f"{format_count(max(round(1 / outlier.chance), 1))} has one as far away)"
        for outlier in check.outlying
    )
    said = _uniform(check, check.assemblies, rig_words(check.rig).groups)
    return f"{said} {f'Beyond 3 sd: {far}.' if far else 'None lies beyond 3 sd.'}"


def _densities(predictions: tuple[Prediction, ...]) -> Table:
    whys = {prediction.elpd_why for prediction in predictions if prediction.elpd_why}
    return Table(
        "Expected log predictive density (elpd) by leave-one-out cross-validation.",
        [
            "left out",
            Column("number", align="right"),
            Column("elpd", "nat", align="right"),
            Column("±", "nat", align="right"),
            *right_columns("bad Pareto k", "refitted"),
        ],
        [
            [
                _kind(prediction),
                format_count(prediction.groups),
                *(
                    (format_fixed(prediction.elpd, 1), MISSING)
                    if prediction.elpd_se is None
                    else error_cells(prediction.elpd, prediction.elpd_se)
                ),
                format_count(prediction.bad),
                format_count(prediction.refitted),
            ]
            for prediction in predictions
        ],
        label="elpd",
        note="The density is of raw data, so its level depends on their units and number; only "
        "differences between models of the same data have a meaning. ±: standard error over "
        f"the groups left out.{_limit(predictions)}{' No density: ' if whys else ''}"
        f"{'; '.join(sorted(whys))}{'.' if whys else ''}",
    )


def _kind(prediction: Prediction) -> str:
    words = rig_words(prediction.rig)
    return f"{words.trial if prediction.left_out == 'trial' else words.group} of the {words.rig}"


def _limit(predictions: tuple[Prediction, ...]) -> str:
    limits = [
        prediction.pareto_k_limit
        for prediction in predictions
        if prediction.pareto_k_limit is not None
    ]
    if not limits:
        return ""
    return (
        f" Where a Pareto k is above {format_number(min(limits), 2)}, the importance weights are "
        "unreliable, and the posterior without that group is sampled anew."
    )
