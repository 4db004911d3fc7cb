"""What is sealed cannot be changed unnoticed."""

import hashlib
import json

import pytest

from bayesfric.blind.envelope import ENVELOPE, PUBLIC, open_envelope, seal
from bayesfric.errors import InputError

TRUTH = {"withheld": [{"name": "viscous", "strength": 0.3}]}


def test_the_hash_in_the_public_file_is_that_of_the_sealed_one(tmp_path):
    digest = seal(tmp_path, TRUTH, {"name": "a"}, 7)
    assert hashlib.sha256((tmp_path / ENVELOPE).read_bytes()).hexdigest() == digest
    public = json.loads((tmp_path / PUBLIC).read_text())
    assert public == {"name": "a", "envelope_sha256": digest}
    assert open_envelope(tmp_path) == ({"name": "a", "envelope_sha256": digest}, TRUTH)


def test_a_case_made_again_has_the_same_envelope_and_equal_answers_have_others(tmp_path):
    assert seal(tmp_path / "a", TRUTH, {}, 7) == seal(tmp_path / "b", TRUTH, {}, 7)
    assert seal(tmp_path / "a", TRUTH, {}, 7) != seal(tmp_path / "b", TRUTH, {}, 8)


def test_a_changed_envelope_is_an_error(tmp_path):
    seal(tmp_path, TRUTH, {}, 7)
    sealed = tmp_path / ENVELOPE
    sealed.write_text(sealed.read_text().replace("viscous", "runout"))
    with pytest.raises(InputError, match="expected the envelope whose SHA-256 stands in"):
        open_envelope(tmp_path)


@pytest.mark.parametrize("name", [ENVELOPE, PUBLIC])
def test_a_missing_file_is_an_error(tmp_path, name):
    seal(tmp_path, TRUTH, {}, 7)
    (tmp_path / name).unlink()
    with pytest.raises(InputError, match="expected a sealed case"):
        open_envelope(tmp_path)
