import numpy as np
import pytest

from scenario_compiler.perception.degradation import RAIN, SENSOR_NOISE, add_noise, generator

GREY = np.full((64, 128, 3), 128, np.uint8)


def test_noise_depends_on_seed_and_frame_alone() -> None:
    first = add_noise(GREY, 20.0, 1, 7)
    add_noise(GREY, 20.0, 1, 8)
    assert np.array_equal(first, add_noise(GREY, 20.0, 1, 7))
    assert not np.array_equal(first, add_noise(GREY, 20.0, 1, 8))
    assert not np.array_equal(first, add_noise(GREY, 20.0, 2, 7))


@pytest.mark.parametrize("sigma", [5.0, 25.0])
def test_noise_has_mean_zero_and_the_sigma_asked_for(sigma: float) -> None:
    error = add_noise(GREY, sigma, 1, 0).astype(float) - 128.0
    assert abs(error.mean()) < 0.03 * sigma
    assert error.std() == pytest.approx(sigma, rel=0.03)


def test_noise_is_clipped_and_never_wraps() -> None:
    dark, bright = np.zeros((64, 64, 3), np.uint8), np.full((64, 64, 3), 255, np.uint8)
    assert add_noise(dark, 60.0, 1, 0).mean() == pytest.approx(60.0 / np.sqrt(2 * np.pi), rel=0.1)
    assert add_noise(bright, 60.0, 1, 0).mean() == pytest.approx(255 - 60.0 / np.sqrt(2 * np.pi), rel=0.05)


@pytest.mark.parametrize("sigma", [0.0, -1.0, float("nan")])
def test_without_noise_the_image_stays(sigma: float) -> None:
    assert np.array_equal(add_noise(GREY, sigma, 1, 0), GREY)


def test_streams_of_a_frame_differ() -> None:
    assert generator(1, 2, SENSOR_NOISE).random() != generator(1, 2, RAIN).random()


def test_negative_seeds_and_large_frame_numbers_are_taken() -> None:
    assert generator(-1, 2**63, RAIN).random() >= 0.0
