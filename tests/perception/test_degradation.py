import cv2
import numpy as np
import pytest

from scenario_compiler.perception.degradation import (
    RAIN,
    SENSOR_NOISE,
    Degradation,
    Sensor,
    add_impulses,
    add_noise,
    degraded,
    generator,
    overexposed,
    quantised,
    without_rows,
)

GREY = np.full((64, 128, 3), 128, np.uint8)


def test_noise_depends_on_seed_and_frame_only() -> None:
    first = add_noise(GREY, 20.0, 1, 7)
    add_noise(GREY, 20.0, 1, 8)
    assert np.array_equal(first, add_noise(GREY, 20.0, 1, 7))
    assert not np.array_equal(first, add_noise(GREY, 20.0, 1, 8))
    assert not np.array_equal(first, add_noise(GREY, 20.0, 2, 7))


@pytest.mark.parametrize("sigma", [5.0, 25.0])
def test_noise_has_mean_zero_and_the_given_sigma(sigma: float) -> None:
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


def test_impulses_change_the_given_share_of_each_channel_half_to_black_and_half_to_white() -> None:
    """As scikit-image's "s&p", which ImageNet-C uses: the channels of a pixel are struck independently."""
    struck = add_impulses(GREY, 0.2, 1, 3)
    for channel in range(3):
        assert (struck[..., channel] == 0).mean() == pytest.approx(0.1, abs=0.02)
        assert (struck[..., channel] == 255).mean() == pytest.approx(0.1, abs=0.02)
    untouched = (struck == 128).all(axis=2).mean()
    assert untouched == pytest.approx(0.8**3, abs=0.03)
    assert np.array_equal(struck, add_impulses(GREY, 0.2, 1, 3))
    assert not np.array_equal(struck, add_impulses(GREY, 0.2, 1, 4))
    assert (GREY == 128).all()


def test_overexposure_adds_to_the_brightest_channel_and_keeps_the_hue() -> None:
    pixel = np.array([[[20, 40, 80], [0, 0, 0], [100, 200, 250]]], np.uint8)
    assert overexposed(pixel, 80 / 255).tolist() == [[[40, 80, 160], [80, 80, 80], [102, 204, 255]]]
    assert (overexposed(GREY, 1.0) == 255).all()


def test_dead_rows_are_the_same_in_every_image_and_more_of_them_grow_from_those() -> None:
    few, many = (np.flatnonzero((without_rows(GREY, share, 1) == 0).all(axis=(1, 2))) for share in (0.1, 0.4))
    assert 0 < len(few) < len(many)
    assert set(few) <= set(many)
    assert np.array_equal(without_rows(GREY, 0.1, 1), without_rows(GREY, 0.1, 1))


@pytest.mark.parametrize(("coarse", "levels"), [(1.0, 2), (5 / 7, 8), (3 / 7, 32)])
def test_coarse_grey_levels_go_evenly_from_black_to_white(coarse: float, levels: int) -> None:
    ramp = np.repeat(np.arange(256, dtype=np.uint8)[None, :, None], 3, axis=2)
    found = np.unique(quantised(ramp, coarse))
    assert len(found) == levels
    assert (found[0], found[-1]) == (0, 255)
    assert np.ptp(np.diff(found.astype(int))) <= 1


@pytest.mark.parametrize("threads", [1, 2, 7])
def test_failures_do_not_depend_on_the_number_of_threads(threads: int) -> None:
    state = Degradation(sigma=10.0, dark=0.1, blur=2.0, dirt=0.2, impulses=0.1, brighter=0.2, dead_rows=0.1, coarse=0.4)
    image = generator(5, 0, 0).integers(0, 256, (128, 256, 3), dtype=np.uint8)
    before = cv2.getNumThreads()
    try:
        cv2.setNumThreads(1)
        alone = degraded(image, state, 1, 2)
        cv2.setNumThreads(threads)
        assert np.array_equal(degraded(image, state, 1, 2), alone)
    finally:
        cv2.setNumThreads(before)


def test_late_images_arrive_when_they_are_due_and_the_last_one_stays_until_then() -> None:
    sensor, seen = Sensor(1), []
    for k in range(10):
        late = 0.3 if 2 <= k < 7 else 0.0
        image = np.full((4, 4, 3), k, np.uint8)
        seen.append(int(sensor.deliver(image, Degradation(late=late), k, 0.1 * k)[0, 0, 0]))
    assert seen == [0, 1, 1, 1, 1, 2, 3, 7, 8, 9]
