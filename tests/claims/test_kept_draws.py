"""Draws of the law and of the best rival, compared by ArviZ as by the claim."""

import arviz_stats as azs
import numpy as np
import pytest
import xarray as xr

from bayesfric.claims import check_claims
from bayesfric.claims.kept_draws import NOT_BEST, models_kept
from bayesfric.claims.studies import Kept, Studied, Task
from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.results import read_tree
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording

BY_ASSEMBLY = {"var_name": "assembly", "method": "pseudo-bma"}


@pytest.mark.filterwarnings("ignore:The inplace keyword")  # of pandas, inside the library
def test_arviz_finds_the_rival_whose_every_assembly_is_less_likely():
    rng = np.random.default_rng(1)
    density = rng.normal(0.0, 0.1, (4, 250, 12))
    setups = tuple(f"s{place:03d}" for place in range(12))
    theta = {"tau": rng.normal(size=(4, 250))}
    law, rival, third, fourth = (
        Task("gravity", law_with_effects)
        for law_with_effects in (
            LawWithEffects(),
            LawWithEffects(effects=(("viscous", "constant"),)),
            LawWithEffects(effects=(("slip", "constant"),)),
            LawWithEffects(effects=(("viscous", "tension"),)),
        )
    )
    groups = models_kept(
        {
            law: Studied(None, kept=Kept(theta, setups, density)),
            rival: Studied(None, kept=Kept(theta, setups, density - 0.5)),
            third: Studied(None, "separate places"),
            fourth: Studied(None, kept=Kept(theta, setups, density)),
            Task("gravity/small", LawWithEffects()): Studied(None),
        },
        [law, rival],
    )
    tree = xr.DataTree.from_dict(groups)["models"]
    why = dict(zip(tree["hypothesis"].to_numpy(), tree["why"].to_numpy(), strict=True))
    assert why == {
        "gravity/paper": "",
        "gravity/viscous/constant": "",
        "gravity/slip/constant": "separate places",
        "gravity/viscous/tension": NOT_BEST,
    }
    assert set(groups) == {
        "models",
        *(
            f"models/gravity/{model}/{group}"
            for model in ("paper", "viscous/constant")
            for group in ("posterior", "log_likelihood")
        ),
    }
    pair = {"law": tree["gravity/paper"], "rival": tree["gravity/viscous/constant"]}
    table = azs.compare(pair, **BY_ASSEMBLY)
    assert list(table.index) == ["law", "rival"]
    assert abs(float(table.loc["rival", "elpd_diff"])) == pytest.approx(6.0, abs=0.1)


@pytest.fixture(scope="module")
def checked():
    design = Protocol({(9, 85.0): 2, (5, 50.0): 1, (15, 85.0): 1}, (6.0, 28.0), (6.0,), 2)
    recording = simulate_recording(design, seed=2, rigs=("gravity",))
    return check_claims(recording, only=["proportional-to-pulleys"])


@pytest.mark.nightly
@pytest.mark.filterwarnings("ignore:The inplace keyword")  # of pandas, inside the library
@pytest.mark.filterwarnings("ignore:Estimated shape parameter")  # few assemblies
def test_arviz_compares_the_claim_with_its_best_rival_as_the_claim_does(checked, tmp_path):
    checked.write(tmp_path)
    models = read_tree(tmp_path / "claims.nc")["models"]
    (claim,) = checked.summary.claims
    rival = claim.figures["best_rival"]
    table = azs.compare(
        {"law": models["gravity/paper"], "rival": models[f"gravity/{rival}"]}, **BY_ASSEMBLY
    )
    difference = float(table.loc["law", "elpd"]) - float(table.loc["rival", "elpd"])
    assert difference == pytest.approx(claim.elpd_difference, abs=0.05)


@pytest.mark.nightly
def test_each_hypothesis_has_draws_or_a_reason(checked):
    models = checked.curves["models"]
    (claim,) = checked.summary.claims
    drawn = {f"/models/{hypothesis}" for hypothesis in models["hypothesis"].to_numpy()}
    drawn &= {node.path for node in models.subtree}
    for name, why in zip(models["hypothesis"].to_numpy(), models["why"].to_numpy(), strict=True):
        assert (f"/models/{name}" in drawn) == (not why), name
    for path in drawn:
        posterior = models[path]["posterior"]
        assert posterior["tau"].shape == (4, 250)
        assert models[path]["log_likelihood"]["assembly"].shape[:2] == (4, 250)
        assert np.unique(posterior["tau"].to_numpy()).size > 100
    listed = set(claim.figures["log10_bayes_factor_against"])
    assert {f"gravity/{model}" for model in listed} <= set(models["hypothesis"].to_numpy())
