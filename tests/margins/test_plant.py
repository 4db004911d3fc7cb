"""What a loop file comes to at the shaft, by hand."""

import numpy as np
import pytest
from margins.loops import shaft

from bayesfric.margins.plant import plant_of


def test_the_plant_of_the_bench_by_hand():
    # kp 0.02, kd 1e-3, J 2e-5 + 0.1/100², lag 1.5 ms, EA 15 kN over 10 mm, two sides at 1 mm/rad
    plant = plant_of(shaft())
    assert plant.natural_frequency_hz == pytest.approx(np.sqrt(0.02 / 3e-5) / 2 / np.pi)
    assert plant.damping_ratio == pytest.approx((1e-3 - 0.02 * 1.5e-3) / 2 / np.sqrt(0.02 * 3e-5))
    ringing = np.sqrt(2 * 15e3 / 0.01 * 1e-6 * (1 / 2e-5 + 1 / 1e-5))
    assert plant.resonance_hz == pytest.approx(ringing / 2 / np.pi)
    assert plant.load_inertia_kg_m2 == pytest.approx(1e-5)
    assert plant.cable_m_per_rad == pytest.approx(1e-3)
    assert plant.tip_m_per_rad == pytest.approx(0.5 / 100)
    assert "1/10 of the capstan, 6.28 mm of cable and 31.4 mm at the tip" in plant.sentence
    assert "The motor turns 100 rad for each rad of the joint." in plant.sentence


def test_a_forgotten_gearbox_shows():
    forgotten = plant_of(shaft({"drive.gearbox_ratio": 1.0}))
    assert "1/1 of the capstan, 62.8 mm of cable" in forgotten.sentence
