"""A stored fit is used again for the same tables, the same rig and the same analysis alone."""

from dataclasses import replace

import pytest

from bayesfric.analysis import Analysis
from bayesfric.claims.stored_fit import current_posterior
from bayesfric.fitting import posterior
from bayesfric.results import identified, recording_id


def heavier(recording):
    """The same tables where gravity is another."""
    return replace(recording, rig=replace(recording.rig, gravity_m_s2=9.3))


def test_a_fit_of_another_rig_is_not_used(small_recording, small_fit, tmp_path):
    """Tables are the same where only datapackage.json was corrected."""
    summary = identified(small_fit.summary.model_copy(update={"converged": True}))
    replace(small_fit, summary=summary).write(tmp_path)
    analysis = Analysis.model_validate(summary.analysis)
    assert list(current_posterior(tmp_path, small_recording, analysis)) == ["gravity"]
    assert current_posterior(tmp_path, heavier(small_recording), analysis) == {}


def test_a_fit_that_was_killed_does_not_go_on_with_another_rig(
    small_recording, tmp_path, monkeypatch
):
    keys = []

    def stop(folder, key):
        keys.append(key)
        raise KeyboardInterrupt

    monkeypatch.setattr(posterior, "Checkpoint", stop)
    for recording in (small_recording, small_recording, heavier(small_recording)):
        with pytest.raises(KeyboardInterrupt):
            posterior.fit(recording, checkpoint=tmp_path)
    assert keys[0] == keys[1] != keys[2]


def test_files_of_earlier_versions_name_no_rig(small_recording):
    identity, other = recording_id(small_recording), recording_id(heavier(small_recording))
    assert not identity.same_data(other)
    assert identity.same_data(other.model_copy(update={"rig_sha256": ""}))
