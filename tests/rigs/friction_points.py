"""Steady friction points of made machines, as recordings."""

import json
from pathlib import Path

import numpy as np
import pandas as pd

import bayesfric as bf


def recorded(folder: Path, table: dict[str, object], **rig: object):
    """Write a table as a recording, by hand, and read it."""
    folder.mkdir(parents=True, exist_ok=True)
    points = pd.DataFrame(table)
    points.insert(0, "run", [f"r{place:03d}" for place in range(len(points))])
    points.to_csv(folder / "steady_friction.csv", index=False)
    resources = [{"name": "steady-friction", "path": "steady_friction.csv"}]
    package = {"name": "bench", "title": "Points", "rig": rig, "resources": resources}
    (folder / "datapackage.json").write_text(json.dumps(package))
    return bf.read_recording(folder)


def joint(viscous: float, *, force: float = 1.0, speed: float = 1.0) -> dict[str, np.ndarray]:
    """Return 60 points of a joint that runs both ways: 8 N m, and more with speed."""
    rng = np.random.default_rng(11)
    size = np.tile(np.linspace(0.1, 2.0, 15), 4)
    way = np.repeat([1.0, -1.0], 30)
    friction = (8 + viscous * size) * (1 + 0.01 * rng.standard_normal(60))
    friction += 0.03 * rng.standard_normal(60)
    return {"velocity_m_s": speed * way * size, "friction_n": force * way * friction}


def curved(seed: int) -> dict[str, np.ndarray]:
    """Return 60 points under a Stribeck curve and viscous friction: first less, then more."""
    rng = np.random.default_rng(seed)
    speed = np.exp(rng.uniform(np.log(0.005), np.log(0.6), 60))
    friction = 10 + 5 * np.exp(-speed / 0.04) + 10 * speed
    friction = friction * (1 + 0.01 * rng.standard_normal(60)) + 0.15 * rng.standard_normal(60)
    return {"velocity_m_s": speed, "friction_n": friction}


def slide(change: float = 0.0) -> dict[str, np.ndarray]:
    """Return 40 points of a slide under four loads, whose friction may fall with temperature."""
    rng = np.random.default_rng(12)
    load = np.repeat([100.0, 200.0, 400.0, 800.0], 10)
    warm = np.tile(np.linspace(10.0, 50.0, 10), 4)
    friction = (0.1 * load + 10) * (1 - change * (warm - 30) / 20)
    friction *= 1 + 0.01 * rng.standard_normal(40)
    return {"tension_n": load, "oil_temperature_c": warm, "friction_n": friction}


def warming() -> dict[str, np.ndarray]:
    """Return 40 points of a joint with cold grease, which rubs a third more at first."""
    rng, order = np.random.default_rng(3), np.arange(1, 41)
    speed = np.tile(np.linspace(0.1, 2.0, 20), 2)
    friction = (8 + 0.5 * speed) * (1 + 0.3 * np.exp(-order / 12))
    friction = friction * (1 + 0.005 * rng.standard_normal(40))
    return {"velocity_m_s": speed, "friction_n": friction, "order": order}
