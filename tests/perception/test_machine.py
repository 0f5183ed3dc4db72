from scenario_compiler.perception.machine import drawn_by


def test_what_pictures_depend_on_is_named() -> None:
    found = drawn_by()
    assert set(found) == {"opencv", "processor"}
    assert found["opencv"][0].isdigit()
    assert len(found["processor"].split()) >= 1
