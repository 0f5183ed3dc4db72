from scenario_compiler.perception.machine import drawn_by


def test_the_versions_on_which_pictures_depend_are_named() -> None:
    found = drawn_by()
    assert set(found) == {"opencv", "processor"}
    assert found["opencv"][0].isdigit()
    assert len(found["processor"].split()) >= 1
