"""Checks that every property of the driver has an effect."""

from __future__ import annotations

from collections.abc import Iterator

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.driver import DriverModel

IDLE_DRIVER = Code(
    "SC511",
    "idle-driver-attribute",
    "A property of the driver has no effect or is contradictory: a traffic density without an <effect> on the "
    "takeover time; a task or closed eyes together with a fixed takeover_time, which no effect changes; or shares of "
    "braking and steering drivers whose sum exceeds 1.\n\n"
    '    <driver traffic_density="20"/>     <effect of="traffic_density" by="0.05"/> is missing inside',
    Severity.WARNING,
)


def check_driver(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of attributes of the driver that have no effect."""
    del network
    driver = plan.takeover.driver
    if not isinstance(driver, DriverModel):
        return
    for attribute, message in _idle(driver):
        sink.add(IDLE_DRIVER, message, driver.place_of(attribute))
    how = driver.driving
    if how.brakes + how.steers > 1.0:
        message = f"{how.brakes:g} who brake and {how.steers:g} who steer exceed 1 in sum"
        sink.add(IDLE_DRIVER, message, how.place_of("steers"))


def _idle(driver: DriverModel) -> Iterator[tuple[str, str]]:
    said = {
        "task": driver.task is not None,
        "eyes_closed": driver.eyes_closed,
        "traffic_density": driver.traffic_density is not None,
    }
    if driver.takeover_time is not None:
        for attribute in (name for name, is_said in said.items() if is_said):
            yield attribute, f"{attribute} has no effect: the takeover time is fixed"
    elif said["traffic_density"] and not any(one.of == "traffic_density" for one in driver.effects):
        yield "traffic_density", "no <effect> defines how the traffic density changes the takeover time"
