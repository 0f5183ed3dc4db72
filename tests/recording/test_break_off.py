"""The reasons for which variants have no result."""

from __future__ import annotations

from scenario_compiler.recording.break_off import equal_reasons


def test_reasons_that_differ_only_in_their_numbers_count_as_one() -> None:
    reasons = [
        (0, "gap is 408.9, but must be at most 400"),
        (1, "'car.1' and 'car.2' overlap at the start"),
        (4, "gap is 4.1e2, but must be at most 400"),
        (5, "gap is -3, but must be at least 0"),
        (6, "'car.1' and 'car.3' overlap at the start"),
        (9, "gap is 401, but must be at most 400"),
    ]
    assert equal_reasons(reasons) == [
        ("gap is 408.9, but must be at most 400", 3, 0),
        ("'car.1' and 'car.2' overlap at the start", 1, 1),
        ("gap is -3, but must be at least 0", 1, 5),
        ("'car.1' and 'car.3' overlap at the start", 1, 6),
    ]
