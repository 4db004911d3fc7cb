"""What an author of an effect is told."""

import dataclasses
import pickle

import numpy as np
import pytest

from bayesfric.effects import all_effects
from bayesfric.testing import EffectError, check_effect

VISCOUS = all_effects()["viscous"]
RUNOUT = all_effects()["runout"]
SLIP = all_effects()["slip"]
CABLE_WEIGHT = all_effects()["cable-weight"]


@pytest.mark.parametrize("name", list(all_effects()))
def test_our_own_effects_pass(name):
    check_effect(all_effects()[name])


def with_law(law):
    return dataclasses.replace(VISCOUS, laws={"mine": law})


def with_amplitude(**changes):
    return dataclasses.replace(VISCOUS, amplitude=dataclasses.replace(VISCOUS.amplitude, **changes))


@pytest.mark.parametrize(
    ("effect", "reason"),
    [
        (with_law(lambda p, s: p["slope"] * s.speed_m_s + 0.1), "still is 0.1, not 0"),
        (with_law(lambda p, s: p["slope"] ** 2 * s.speed_m_s), "not linear in slope"),
        (with_law(lambda p, s: p["slope"] / (s.speed_m_s - s.speed_m_s[0])), "not finite"),
        (with_amplitude(unit="furlong"), "'furlong' is none of"),
        (with_amplitude(reference=""), "no reference"),
        (with_amplitude(plausible=(5.0, 9.0)), "not in reach"),
        (dataclasses.replace(VISCOUS, along_path=False), "not said to act along_path"),
        (dataclasses.replace(VISCOUS, laws={}), "no law"),
        (dataclasses.replace(RUNOUT, components=3), r"shape \(2, 12\), .* go with \(3, 12\)"),
        (dataclasses.replace(RUNOUT, components=0), r"shape \(2, 12\), .* go with \(12,\)"),
        (dataclasses.replace(CABLE_WEIGHT, along_path=False), "not said to act along_path"),
        (
            dataclasses.replace(SLIP, laws={"mine": lambda p, r: p["share"] ** 3 * r.time_s}),
            "not linear in share",
        ),
        (
            with_law(lambda p, s: np.ravel(p["slope"])[-1] * s.speed_m_s),
            "a column of amplitudes gives other values",
        ),
        (
            dataclasses.replace(
                all_effects()["stribeck"],
                shape=dataclasses.replace(all_effects()["stribeck"].shape, typical=None),
            ),
            "needs a typical value",
        ),
    ],
)
def test_a_fault_is_named(effect, reason):
    with np.errstate(divide="ignore", invalid="ignore"), pytest.raises(EffectError, match=reason):
        check_effect(effect)


def test_a_prior_that_is_not_normalised_is_named(monkeypatch):
    from bayesfric import testing

    monkeypatch.setattr(testing, "log_density", lambda prior, x: np.log(0.5) - x**2)
    with pytest.raises(EffectError, match="integrates to"):
        check_effect(VISCOUS)


def test_a_file_is_checked_by_its_name(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text("from bayesfric.effects.viscous import EFFECT")
    check_effect(str(path))
    path.write_text(
        "from dataclasses import replace\n"
        "from bayesfric.effects.viscous import EFFECT as SOUND\n"
        "EFFECT = replace(SOUND, laws={})"
    )
    with pytest.raises(EffectError, match="there is no law"):
        check_effect(path)


@pytest.mark.parametrize("name", sorted(all_effects(None)))
def test_an_effect_goes_to_another_process_and_comes_back(name):
    """Claims and campaigns send effects to their workers."""
    effect = all_effects(None)[name]
    assert list(pickle.loads(pickle.dumps(effect)).laws) == list(effect.laws)


def test_meanings_by_variant_are_of_variants_that_exist():
    for effect in all_effects(None).values():
        for parameter in effect.parameters:
            assert set(parameter.by_law) <= set(effect.laws)
