"""Draws depend only on their names, and have the right distributions."""

from __future__ import annotations

import math

from scenario_compiler.engine.columns.opcodes import DRAWS_PER_RUN
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.randomness import normal, random_hash, random_unit, uniform


def test_a_draw_belongs_to_seed_variant_and_stream() -> None:
    draws = {uniform(seed, variant, name) for seed in (1, 2) for variant in (0, 1) for name in ("a", "b")}
    assert len(draws) == 8
    assert uniform(1, 0, "a") == uniform(1, 0, "a")


def test_draws_do_not_change_between_versions() -> None:
    assert uniform(1, 0, "driver/takeover_time/0") == 0.684528745967219
    assert normal(1, 0, "driver/takeover_time/0") == 0.48040068397159535
    assert random_hash(1, 2, 3, 4) == 549126174
    assert len(make_draws(1)) == DRAWS_PER_RUN


def test_uniform_draws_are_spread_evenly_and_normal_ones_normally() -> None:
    flat = [uniform(3, k, "x") for k in range(4000)]
    assert abs(sum(flat) / 4000 - 0.5) < 0.02
    assert 0.0 < min(flat) < 0.002
    assert 0.998 < max(flat) < 1.0
    bell = [normal(3, k, "x") for k in range(4000)]
    assert abs(sum(bell) / 4000) < 0.05
    assert abs(math.sqrt(sum(b * b for b in bell) / 4000) - 1.0) < 0.04


def test_the_counter_hash_changes_half_its_bits_with_each_argument() -> None:
    usual = random_hash(11, 1, 5, 1000)
    flips = [
        bin(usual ^ other).count("1")
        for step in range(64)
        for other in (random_hash(11, 1, 5, 1001 + step), random_hash(12 + step, 1, 5, 1000))
    ]
    assert 14.0 < sum(flips) / len(flips) < 18.0
    assert abs(sum(random_unit(9, 1, 2, k) for k in range(4000)) / 4000 - 0.5) < 0.02
