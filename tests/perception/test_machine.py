import pytest

from scenario_compiler.perception.machine import CHOOSING, drawn_by


def test_the_versions_on_which_pictures_depend_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in CHOOSING:
        monkeypatch.delenv(name, raising=False)
    found = drawn_by()
    assert set(found) == {"processor"}
    assert len(found["processor"].split()) >= 1


def test_a_kernel_of_linear_algebra_that_the_environment_chooses_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """With another kernel the confidences of the same pictures differ in their last digits."""
    monkeypatch.setenv("OPENBLAS_CORETYPE", "Prescott")
    assert drawn_by()["OPENBLAS_CORETYPE"] == "Prescott"
