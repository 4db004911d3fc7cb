"""Every check that failed is in the list of what a reader must know, and none that held."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from report.diagnosis_sample import cause, diagnosis, interval

from bayesfric.analysis import Normal
from bayesfric.attention.claims import of_claims
from bayesfric.attention.diagnosis import biased_numbers, of_diagnosis
from bayesfric.attention.fit import Coverage, of_fit
from bayesfric.attention.together import attention_of_all, by_weight
from bayesfric.fitting.predictive import covered
from bayesfric.inference.priors import Parameter
from bayesfric.resources import reference_folder
from bayesfric.results import read_json
from bayesfric.schemas import ClaimsFile
from bayesfric.schemas.causes import LawNumber
from bayesfric.schemas.fit import Agreement, AssemblyCheck, DataQuality, OutlyingAssembly
from bayesfric.schemas.instrument import Instrument, InstrumentNumber


def quality(agreement=None):
    return DataQuality(
        trials=100, trials_used=100, setups=20, events=9000, replicated_cells=3,
        excluded=(), notes=(), agreement=agreement,
    )  # fmt: skip


def remarks(**changes):
    """What a sound fit is told of, with one thing changed."""
    sound = {
        "convergence": {},
        "entries": {},
        "parameters": (),
        "quality": quality(),
        "uniformity": (),
        "assemblies": (),
        "coverage": (),
        "untold": {},
    }
    return of_fit(**(sound | changes))


def sensors(largest_z, disagreeing=()):
    return Agreement(
        trials=100, largest_z=largest_z, z_q95=2.0, limit_z=3.9, limit_friction_share=0.02,
        disagreeing=disagreeing,
    )  # fmt: skip


def test_a_sound_fit_has_nothing_that_a_reader_must_know():
    coverage = (Coverage("gravity", 0.9, 0.84, 0.96),)
    assert remarks(quality=quality(sensors(2.9)), coverage=coverage) == ()


def test_coefficients_that_the_recording_cannot_determine_are_named_with_the_reason():
    why = dict.fromkeys(("mass", "coulomb"), "The force has one size throughout")
    assert remarks(untold=why) == ("Do not use mass, coulomb: The force has one size throughout",)


@pytest.mark.parametrize("share", [0.80, 0.98])
def test_coverage_outside_of_its_range_is_told(share):
    (line,) = remarks(coverage=(Coverage("gravity", share, 0.84, 0.96),))
    assert f"{share:.1%} of the gravity board's trials" in line
    assert "84.0% to 96.0%" in line


def test_sensors_that_are_far_apart_are_told():
    """4.4 sd by noise alone: 100 trials × 1.1e-5, one recording in 900."""
    (line,) = remarks(quality=quality(sensors(4.4)))
    assert "by up to 4.4 standard errors" in line
    assert line.endswith("in no trial does this reach 2% of friction")
    (line,) = remarks(quality=quality(sensors(6.0, ("g0007", "g0009"))))
    assert "in 2 of 100 trials (g0007, g0009) this is also more than" in line
    assert remarks(quality=quality(sensors(3.8))) == ()  # 100 × 1.4e-4: one in 70


@pytest.mark.parametrize(
    ("without", "words"),
    [
        ({}, "Its trials are in the fit, with the scatter of assemblies: look at how"),
        (
            {"c1[small]": 1.009, "c2[small]": 1.0},
            "The numbers to use hardly change: without it c1[small] is 1.01, not 1.00, and no "
            "coefficient leaves its 90% interval",
        ),
        (
            {"c1[small]": 1.0, "c2[small]": 0.979},
            "It matters for the numbers to use: without it c2[small] is 0.979 N, not 1.00 N, "
            "outside of its 90% interval. Look at how",
        ),
    ],
)
def test_a_far_assembly_is_told_with_what_it_means_for_the_numbers(without, words):
    """Either 90 % interval is from 0.99 to 1.01."""
    entries = {
        "c1[small]": SimpleNamespace(
            mean=1.0, sd=0.006, q05=0.99, q95=1.01, unit="1", informed=True
        ),
        "c2[small]": SimpleNamespace(
            mean=1.0, sd=0.006, q05=0.99, q95=1.01, unit="N", informed=True
        ),
    }
    far = OutlyingAssembly(setup="s047", z=3.67, chance=0.013, without=without)
    check = AssemblyCheck(
        rig="gravity", assemblies=54, p_value=0.5, spread=1.0, spread_q05=0.8, spread_q95=1.2,
        outlying=(far,),
    )  # fmt: skip
    (line,) = remarks(entries=entries, assemblies=(check,))
    assert line.startswith("Friction of assembly s047 of the gravity board is 3.7 standard")
    assert words in line
    heeded, _ = by_weight([line])
    assert bool(heeded) == ("hardly change" not in words)  # what asks for nothing is a note


@pytest.mark.parametrize(
    ("name", "prior", "mean", "sd", "is_told"),
    [
        ("latency", Normal(mean=0.0, sd=0.02), -0.027, 0.0012, True),
        ("latency", Normal(mean=0.0, sd=0.02), -0.027, 0.009, False),
        ("latency", Normal(mean=0.0, sd=0.003), 0.001, 0.0001, False),
        ("torque_constant_factor", Normal(mean=1.0, sd=0.05), 1.15, 0.01, True),
        ("torque_constant_factor", Normal(mean=1.0, sd=0.05), 1.06, 0.01, False),
    ],
    ids=[
        "late",
        "not surely late",
        "as sampled",
        "far from the data sheet",
        "within the data sheet",
    ],
)
def test_a_declared_number_that_the_data_miss_is_told(name, prior, mean, sd, is_told):
    parameter = Parameter(name, "s", prior, "noise")
    lines = remarks(
        parameters=[parameter], entries={name: SimpleNamespace(mean=mean, sd=sd, informed=True)}
    )
    assert len(lines) == is_told
    if is_told:
        assert lines[0].startswith(f"Parameter {name} is {mean:.3g} ± {sd:.2g} s")


def test_coverage_is_read_where_it_is_stored():
    table = xr.Dataset(
        {"covered_share": 0.7, "covered_expected": ("quantile", [0.8, 0.9, 0.95])},
        attrs={"rig": "motor"},
    )
    tree = xr.DataTree.from_dict({"runs": table, "ranks": xr.Dataset({"x": ("k", np.ones(2))})})
    assert covered(tree) == (Coverage("motor", 0.7, 0.8, 0.95),)


def law(before, after, sd=0.001):
    return LawNumber(unit="N", before=interval(before, sd), after=interval(after, sd))


def test_a_law_that_is_biased_without_the_causes_is_told():
    """c2 68 % too high; c1 that hardly moves is not."""
    numbers = {"c2[small]": law(0.0439, 0.0261), "c1[small]": law(0.01285, 0.0128, 1e-5)}
    summary = diagnosis(causes=(cause("viscous"),), law=numbers)
    assert list(biased_numbers(summary)) == ["c2[small]"]
    (line,) = [line for line in of_diagnosis(summary) if "c2[small]" in line]
    assert line.startswith("Without viscous")
    assert "gives c2[small] as 43.9e-3 N instead of 26.1e-3 N" in line
    assert "Also biased" not in line
    assert not biased_numbers(diagnosis(causes=(), law=numbers))


def test_a_number_whose_two_values_agree_is_not_biased():
    """6.2 ± 0.67 alone and 7.12 ± 0.30 with the cause are 1.3 combined deviations apart."""
    near = {"c3[large]": LawNumber(unit="1", before=interval(6.2, 0.67), after=interval(7.12, 0.3))}
    assert not biased_numbers(diagnosis(causes=(cause("viscous"),), law=near))
    far = {"c3[large]": LawNumber(unit="1", before=interval(5.6, 0.67), after=interval(7.12, 0.3))}
    assert list(biased_numbers(diagnosis(causes=(cause("viscous"),), law=far))) == ["c3[large]"]


def test_numbers_that_are_biased_alike_are_one_remark():
    """The worst is told with its figures, 68 % off; the others, a tenth off, by their names."""
    numbers = {name: law(0.011, 0.010, 1e-4) for name in ("c1[large]", "c3[large]")}
    worst = {"c2[small]": law(0.0439, 0.0261)}
    biased = diagnosis(causes=(cause("viscous"),), law=numbers | worst)
    (line,) = [line for line in of_diagnosis(biased) if "Without viscous" in line]
    assert "c2[small] as 43.9e-3 N" in line
    assert "Also biased: c1[large], c3[large]." in line
    assert line.endswith("on this biased law: use the numbers refitted with viscous")


def test_what_a_diagnosis_holds_already_comes_first_and_once():
    summary = diagnosis(attention=("Scatter is taken as normal.",))
    once = summary.model_copy(update={"attention": of_diagnosis(summary)})
    assert once.attention[0] == "Scatter is taken as normal."
    assert of_diagnosis(once) == once.attention


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"stray_trials": ("g0003",)}, "g0003"),
        ({"causes": (cause("viscous").model_copy(update={"plausible": False}),)}, "plausible"),
    ],
    ids=["stray", "implausible"],
)
def test_each_check_of_a_diagnosis_is_told(changes, said):
    before, after = of_diagnosis(diagnosis()), of_diagnosis(diagnosis(**changes))
    assert any(said in line for line in set(after) - set(before))


def test_claims_whose_evidence_and_prediction_disagree_are_told():
    stored = read_json(ClaimsFile, reference_folder() / "claims.json").claims[0]
    sound = stored.model_copy(
        update={
            "verdict": "supported", "log10_bayes_factor_se": 0.05,
            "elpd_difference": 1.0, "elpd_difference_se": 2.0,
        }
    )  # fmt: skip
    assert of_claims([sound]) == ()
    contrary = sound.model_copy(update={"elpd_difference": -20.0, "elpd_difference_se": 3.0})
    (line,) = of_claims([contrary])
    assert "-20.0 ± 3.0 nat" in line
    (line,) = of_claims([sound.model_copy(update={"log10_bayes_factor_se": 1.0})])
    assert "known only to a factor of 10" in line


def test_all_results_make_one_list_with_each_line_once():
    claims = read_json(ClaimsFile, reference_folder() / "claims.json")
    records = {
        "diagnosis.json": diagnosis(attention=("a", "b")),
        "claims.json": claims.model_copy(update={"attention": ("b", "c")}),
    }
    assert attention_of_all(records) == [
        ("diagnosis.json", "a"), ("diagnosis.json", "b"), ("claims.json", "c")
    ]  # fmt: skip


def test_other_biased_numbers_stand_in_their_usual_order():
    number = LawNumber(unit="1", before=interval(2.0, 0.01), after=interval(1.0, 0.01))
    names = ("c3[small]", "c2[large]", "c1[mine]", "c2[medium]", "c2[small]")
    worst = number.model_copy(update={"before": interval(9.0, 0.01)})
    law = dict.fromkeys(names, number) | {"c1[small]": worst}
    (line,) = [
        line for line in of_diagnosis(diagnosis(law=law)) if "the fit gives c1[small]" in line
    ]
    assert "Also biased: c1[mine], c2[small], c2[medium], c2[large], c3[small]." in line


def test_what_asks_for_nothing_stands_apart_and_a_biased_law_comes_first():
    harmless = "These data hardly inform tau: its prior decides; no coefficient of the law is"
    apart = "The two sensors disagree; in no trial does this reach 1% of friction"
    biased = "Without viscous c1 is 1. Results of fit and claims rest on this biased law: so"
    lines = [f"{harmless} affected", "An assembly is far", apart, biased]
    assert by_weight(lines) == ([biased, lines[1]], [lines[0], apart])


@pytest.mark.parametrize(("inertia", "viscous"), [(0.5, 0.3), (-0.5, 0.3), (0.5, -0.3)])
def test_an_inertia_below_0_by_the_instrument_is_no_number_to_use(inertia, viscous):
    """Of half of a public log an inertia of -6.9 kg·m² was said to be the one to use."""

    def number(value):
        return InstrumentNumber(
            unit="u", ordinary=1.0, ordinary_se=0.1, instrumental=value, instrumental_se=0.1
        )

    instrument = Instrument(
        kind="earlier motion", statistic=9.0, p_value=1e-6, strength=90.0, windows=99, alarms=True,
        numbers={"inertia": number(inertia), "viscous": number(viscous)},
    )  # fmt: skip
    lines = of_diagnosis(diagnosis().model_copy(update={"instrument": instrument}))
    (line,) = (line for line in lines if "Durbin" in line)
    assert ("except for inertia: no joint" in line) == (inertia < 0)
    assert "Use the instrumental-variable numbers" in line
