"""analysis.toml: what is accepted, and one clear fault for each thing that is not."""

import pytest

from bayesfric.analysis import Analysis, HalfNormal, Normal, read_analysis, settings_sha256
from bayesfric.errors import InputError


def write(tmp_path, text):
    path = tmp_path / "analysis.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_defaults_without_a_file():
    analysis = read_analysis(None)
    assert analysis == Analysis()
    assert analysis.priors.c1 == HalfNormal(scale=0.01)
    assert analysis.priors.c3 is None
    assert analysis.priors.wrap_share == Normal(mean=0.0, sd=0.005)


def test_a_wrap_slope_is_stated_once(tmp_path):
    slope = "c3 = {family = 'normal', mean = 0.0, sd = 1e-4}\n"
    share = "wrap_share = {family = 'normal', mean = 0.004, sd = 0.002}\n"
    for section in ("[priors]\n", "[priors.pulleys.lab]\n"):
        with pytest.raises(InputError, match="not both"):
            read_analysis(write(tmp_path, section + slope + share))
        alone = read_analysis(write(tmp_path, section + slope))
        assert Analysis.model_validate_json(alone.model_dump_json()) == alone


def test_values_are_read_and_the_seed_is_overridden(tmp_path):
    path = write(
        tmp_path,
        "seed = 3\n[priors]\nc1 = {family = 'log-normal', median = 0.01, sd_log = 0.3}\n"
        "[priors.pulleys.lab]\nc2 = {family = 'uniform', low = 0.0, high = 1.0}\n",
    )
    analysis = read_analysis(path, seed=9)
    assert analysis.seed == 9
    assert analysis.priors.c1.median == 0.01
    assert analysis.priors.pulleys["lab"].c2.high == 1.0


@pytest.mark.parametrize(
    ("text", "column", "expected"),
    [
        ("sede = 1", "sede", "no such key"),
        ("[priors]\nc4 = 1", "priors.c4", "no such key"),
        ("seed = -1", "seed", "greater than or equal to 0"),
        ("seed = 'x'", "seed", "integer"),
        ("seed = '7'", "seed", "integer"),
        ("seed = true", "seed", "integer"),
        ("[priors]\nc1 = {family = 'half-normal', scale = true}", "scale", "number"),
        ("[scatter]\nby_size = 1", "scatter.by_size", "boolean"),
        ("[priors]\ntau = {family = 'half-normal', scale = 0}", "scale", "greater than 0"),
        ("[priors]\ntau = {family = 'half-normal', scale = nan}", "scale", "finite"),
        ("[priors]\ntau = {family = 'cauchy', scale = 1}", "priors.tau", "half-normal"),
        ("[priors]\nc3 = {family = 'uniform', low = 1, high = 0}", "priors.c3", "high above low"),
        (
            "[priors]\nc1 = {family = 'uniform', low = -2, high = 0}",
            "priors",
            "of c1 that has some",
        ),
        ("[sampler]\nensembles = 3", "sampler.ensembles", "greater than or equal to 4"),
        ("[sampler]\nwalkers = 33", "sampler", "even number"),
        ("[sampler]\nsteps = 50\nthin = 10", "sampler", "at least 20 steps"),
        ("[scatter]\ntrial = 'cauchy'", "scatter.trial", "student-t"),
    ],
)
def test_each_fault_is_one_clear_error(tmp_path, text, column, expected):
    with pytest.raises(InputError) as raised:
        read_analysis(write(tmp_path, text))
    (fault,) = raised.value.faults
    assert fault.file == "analysis.toml"
    assert column in fault.column
    assert expected in fault.expected


def test_all_faults_are_told_together(tmp_path):
    with pytest.raises(InputError) as raised:
        read_analysis(write(tmp_path, "sede = 1\n[sampler]\nthin = 0\nburn = 1"))
    assert len(raised.value.faults) == 3


@pytest.mark.parametrize(
    ("text", "expected"), [("a = = 1", "TOML that parses"), (b"\xff\xfe", "UTF-8")]
)
def test_files_that_do_not_parse(tmp_path, text, expected):
    with pytest.raises(InputError, match=expected):
        read_analysis(write(tmp_path, text))


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="readable file"):
        read_analysis(tmp_path / "none.toml")


def test_hash_follows_the_settings_not_the_text(tmp_path):
    spelled_out = read_analysis(write(tmp_path, "[sampler]\nthin = 1\n"))
    assert settings_sha256(spelled_out) == settings_sha256(Analysis())
    assert settings_sha256(read_analysis(None, seed=1)) != settings_sha256(Analysis())
