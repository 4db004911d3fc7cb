"""Loop files: what is read, and what is refused where."""

import tomllib
from pathlib import Path

import pytest
from margins.loops import changed, loop
from pydantic import BaseModel

from bayesfric.analysis import settings_sha256
from bayesfric.errors import InputError
from bayesfric.margins import loop_file
from bayesfric.margins.loop_reading import read_loop
from bayesfric.resources import data_folder

LOOPS = data_folder() / "loops"
HERE = loop_file.__name__


def as_toml(values):
    """Write nested dictionaries as TOML; enough for a loop."""

    def inline(value):
        if isinstance(value, bool):
            return str(value).lower()
        if isinstance(value, str):
            return f'"{value}"'
        if isinstance(value, dict):
            return "{ " + ", ".join(f"{k} = {inline(v)}" for k, v in value.items()) + " }"
        return repr(value)

    tables, lines = [], []
    for key, value in values.items():
        if isinstance(value, dict):
            tables += [f"[{key}]", *(f"{k} = {inline(v)}" for k, v in value.items())]
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for table in value:
                tables += [f"[[{key}]]", *(f"{k} = {inline(v)}" for k, v in table.items())]
        else:
            lines.append(f"{key} = {inline(value)}")
    return "\n".join(lines + tables) + "\n"


def refused(tmp_path, changes):
    path = tmp_path / "bad.toml"
    path.write_text(as_toml(changed(changes)), encoding="utf-8")
    with pytest.raises(InputError) as raised:
        read_loop(path)
    return raised.value.faults


@pytest.mark.parametrize(
    ("changes", "column", "expected"),
    [
        ({"joint.inertia_kg_m2": -0.1}, "joint.inertia_kg_m2", "above 0"),
        ({"joint.inertia_g_m2": 0.1}, "joint.inertia_g_m2", "no such key"),
        ({"drive.colour": "red"}, "drive.colour", "no such key"),
        ({"runs.0.tension_known_at": None}, "runs.0.tension_known_at", "this key"),
        ({"runs.0.tension_known_at": "middle"}, "runs.0.tension_known_at", "'mean'"),
        ({"runs.0.topology": None}, "runs.0.topology", "this key"),
        ({"runs.0.wrap_angle_deg": [85, 85]}, "runs.0", "5 values"),
        ({"spec": {"headroom_continuous_min": 0.3}}, None, "drive.continuous_current_a"),
        ({"joint.inertia_kg_m2": {"family": "normal", "mean": 1.0, "sd": 0.5}},
         "joint.inertia_kg_m2", "log-normal"),
        ({"joint.inertia_kg_m2": {"family": "cauchy"}}, "joint.inertia_kg_m2", "family"),
        ({"joint.inertia_kg_m2": {"family": "log-normal", "median": 1.0}},
         "joint.inertia_kg_m2.sd_log", "this key"),
        ({"controller.velocity_filter": "low-pass"}, "controller", "velocity_cutoff_hz"),
        ({"compensation.signal": "error"}, "compensation", "boundary_rad"),
        ({"tool.lever_m": None}, None, "lever_m"),
        ({"joint.kind": "hinge"}, "joint.kind", "revolute"),
        ({"joint.inertia_kg_m2": "0.3"}, "joint.inertia_kg_m2", "number"),
        ({"spec": {"headroom_clip_min": "0.3"}}, "spec.headroom_clip_min", "number"),
        ({"runs.0.count": "3"}, "runs.0.count", "integer"),
        ({"runs.0.count": True}, "runs.0.count", "integer"),
    ],
)  # fmt: skip
def test_a_bad_loop_is_one_clear_fault(tmp_path, changes, column, expected):
    (fault,) = refused(tmp_path, changes)
    assert fault.file == "bad.toml"
    assert fault.column == column
    assert expected in str(fault)


@pytest.mark.parametrize(
    ("changes", "column", "mistake"),
    [
        ({"drive.gearbox_ratio": 1 / 12}, "joint.transmission_rad_per_rad", "inverted"),
        ({"joint.transmission_rad_per_rad": 0.01}, "joint.transmission_rad_per_rad", "inverted"),
        ({"drive.capstan_radius_m": 10}, "joint.transmission_rad_per_rad", "millimetres"),
        ({"joint": {"kind": "prismatic", "mass_kg": 0.5, "transmission_rad_per_m": 1e-3},
          "tool": {}}, "joint.transmission_rad_per_m", "capstan_radius_m, 1000 (is it"),
        ({"controller.sample_time_s": 1}, "controller.sample_time_s", "milliseconds"),
        ({"drive.torque_constant_n_m_per_a": 50}, "drive.torque_constant_n_m_per_a", "mN·m/A"),
        ({"drive.current_limit_a": 2000}, "drive.torque_constant_n_m_per_a", "in mA"),
        ({"runs.0.wrap_angle_deg": 1.48}, "runs.0.wrap_angle_deg", "radians"),
        ({"cable.length_m": 1200}, "cable.length_m", "millimetres"),
        ({"tool.lever_m": 500}, "tool.lever_m", "millimetres"),
        ({"spec": {"phase_margin_min_rad": 30}}, "spec.phase_margin_min_rad", "in degrees"),
    ],
)  # fmt: skip
def test_a_ratio_or_unit_that_no_joint_has_is_one_line_that_names_it(
    tmp_path, changes, column, mistake
):
    (fault,) = refused(tmp_path, changes)
    assert fault.column == column
    assert mistake in str(fault)


def test_all_faults_are_told_at_once(tmp_path):
    changes = {"joint.inertia_kg_m2": -1.0, "cable.length_m": 0.0, "drive.colour": "red"}
    assert len(refused(tmp_path, changes)) == 3


def test_what_is_written_is_read(tmp_path):
    path = tmp_path / "good.toml"
    uncertain = {"family": "uniform", "low": 1.0, "high": 2.0}
    path.write_text(as_toml(changed({"joint.inertia_kg_m2": uncertain})), encoding="utf-8")
    assert read_loop(path) == loop({"joint.inertia_kg_m2": uncertain})
    assert settings_sha256(read_loop(path)) != settings_sha256(loop())


def test_a_folder_of_results_does_not_hide_the_bundled_loop_of_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("raven-elbow").mkdir()
    assert read_loop(Path("raven-elbow")).name == "raven-elbow"


def test_examples_are_valid_and_carry_their_assumptions():
    examples = {path.stem: read_loop(path) for path in sorted(LOOPS.glob("*.toml"))}
    assert len(examples) >= 4
    for name, example in examples.items():
        assert example.assumptions, name
    # published: kp 0.3 at the gearbox output is 0.0245 at the motor
    elbow = examples["raven-elbow"]
    assert elbow.controller.kp_n_m_per_rad / elbow.drive.gearbox_ratio == pytest.approx(
        0.02449, 1e-3
    )
    # capstan, gearbox and transmission of a prismatic axis are one number
    slide = examples["raven-insertion"]
    ratio = slide.drive.gearbox_ratio / slide.drive.capstan_radius_m
    assert slide.joint.transmission_rad_per_m == pytest.approx(ratio, rel=1e-4)


def test_the_template_shows_every_key():
    text = (LOOPS / "template.toml").read_text(encoding="utf-8")
    tomllib.loads(text)
    classes = [member for member in vars(loop_file).values() if isinstance(member, type)]
    models = [
        model for model in classes if issubclass(model, BaseModel) and model.__module__ == HERE
    ]
    keys = {key for model in models for key in model.model_fields}
    assert len(keys) > 50
    assert sorted(key for key in keys if key not in text) == []


def test_the_loops_of_the_raven_are_as_its_software_has_them():
    """uw-biorobotics/raven2, params/r2params.yaml: kp, kd, ki of each axis; defines.h: radii."""
    gains = {"elbow": (0.3, 0.008, 0.0), "insertion": (0.15, 0.012, 0.0),
             "tool-rotation": (0.09, 0.001, 0.05), "grasp": (0.05, 0.0, 0.05)}  # fmt: skip
    for name, expected in gains.items():
        controller = read_loop(Path(f"raven-{name}")).controller
        gains_of_file = (controller.kp_n_m_per_rad, controller.kd_n_m_s_per_rad)
        assert (*gains_of_file, controller.ki_n_m_per_rad_s) == expected, name
        assert (controller.torque_at, controller.angle_of) == ("gearbox-output", "motor")
    elbow = read_loop(Path("raven-elbow"))
    stage = elbow.second_stage
    first = 49 / 4 * stage.driven_radius_m / elbow.drive.capstan_radius_m
    last = (40.85 + 1.19 / 2) * 1e-3 / stage.driving_radius_m
    assert elbow.joint.transmission_rad_per_rad == pytest.approx(first * last, rel=1e-3)
