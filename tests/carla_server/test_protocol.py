"""The table of calls: it has every name that clients call, and checks every argument before anything else sees it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from scenario_compiler.carla_server.host import Host
from scenario_compiler.carla_server.protocol import CALLS, NOTHING, Protocol
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.carla_server.towns import load_town
from tests.carla_server.values import value_of

ASIDE = ("GetCacheFile", "GetClientVersion", "GetEndpoint", "GetTimeout", "SetFilesBaseFolder", "SetTimeout")
"""Functions of the client that call nothing themselves."""

ENDS = ("UnSubscribeFromStream",)
"""A function that ends a connection."""

NAMED_OTHERWISE = {
    "ApplyBatchSync": "apply_batch",
    "ApplyPhysicsControlToVehicle": "apply_physics_control",
    "AreGBuffersEnabled": "are_gbuffers_enabled",
    "CopyOpenDriveToServer": "copy_opendrive_to_file",
    "DisableForROS": "disable_sensor_for_ros",
    "EnableCarSim": "enable_carsim",
    "EnableForROS": "enable_sensor_for_ros",
    "EnableGBuffers": "enable_gbuffers",
    "GetIMUISensorGravity": "get_imui_gravity",
    "GetLevelBBs": "get_all_level_BBs",
    "GetServerVersion": "version",
    "GetVehiclePhysicsControl": "get_physics_control",
    "GetVehicleTelemetryData": "get_telemetry_data",
    "GetVehiclesLightStates": "get_vehicle_light_states",
    "IsEnabledForROS": "is_sensor_enabled_for_ros",
    "LoadEpisode": "load_new_episode",
    "LoadLevelLayer": "load_map_layer",
    "QueryLightsStateToServer": "query_lights_state",
    "RestorePhysXPhysics": "restore_physx_physics",
    "SendTickCue": "tick_cue",
    "SetIMUISensorGravity": "set_imui_gravity",
    "SetLightStateToVehicle": "set_vehicle_light_state",
    "SubscribeToGBuffer": "get_gbuffer_token",
    "SubscribeToStream": "get_sensor_token",
    "UnSubscribeFromGBuffer": "get_gbuffer_token",
    "UnloadLevelLayer": "unload_map_layer",
    "UpdateServerLightsState": "update_lights_state",
    "UseCarSimRoad": "use_carsim_road",
}
"""Calls that are not the function's name in small letters (LibCarla's `client/detail/Client.cpp`)."""

SECOND = {"add_actor_force_at_location", "add_actor_impulse_at_location", "apply_float_color_texture_to_objects"}
"""Calls of functions of the same name that take other types."""

COUNTS = {"0.9.15": (110, 104), "0.9.16": (134, 128)}
"""Functions of the client, without constructor and destructor, and calls that they make, by its version."""


@pytest.fixture(scope="module")
def library() -> bytes:
    """The machine code of CARLA's client."""
    carla = pytest.importorskip("carla", reason="the CARLA client has no wheel for this Python")
    return next(Path(carla.__file__).parent.glob("*.so")).read_bytes()


def functions_of(library: bytes) -> set[str]:
    """Return the functions of the class that makes all calls, from the mangled names in the library."""
    mangled = re.finditer(rb"_ZNK?5carla6client6detail6Client(\d+)(\w+)", library)
    return {one[2][: int(one[1])].decode() for one in mangled} - {"Pimpl"}


def call_of(function: str) -> str:
    """Return the name of the call that a function makes."""
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", function).lower()
    return NAMED_OTHERWISE.get(function, words)


def test_the_table_has_what_the_client_can_call_and_nothing_else(library: bytes, client_version: str) -> None:
    functions = functions_of(library)
    calls = {call_of(one) for one in functions - {*ASIDE, *ENDS}} | SECOND
    assert calls == {call.name for call in CALLS if call.since <= client_version}
    assert (len(functions), len(calls)) == COUNTS[client_version]


def test_every_name_of_the_table_is_in_the_client(library: bytes, client_version: str) -> None:
    """Names of a few characters stand in instructions, eight at a time, so that is what is looked for of each."""
    names = [call.name for call in CALLS if call.since <= client_version]
    assert [name for name in names if name.encode()[:8] not in library] == []


def test_names_and_reasons() -> None:
    assert len({call.name for call in CALLS}) == len(CALLS)
    for call in CALLS:
        assert (call.answer is None) == (call.how != "answered")
        assert call.answer is not None or call.why
        assert call.how != "ignored" or call.gives is NOTHING


class Quiet:
    """Takes the log."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def __call__(self, line: str) -> None:
        """Keep a line."""
        self.lines.append(line)


@pytest.fixture(params=["0.9.15", "0.9.16"])
def protocol(request: pytest.FixtureRequest, tmp_path: Path) -> Protocol:
    town = load_town("open_ground", ())
    return Protocol(Host(request.param, (), tmp_path, 2001, Quiet(), Stage(town, request.param)))


def failed(response: Any) -> bool:
    """Return whether a response is one of CARLA's error forms."""
    return response == [] or response[0][0] == 0 or response[0][0] is True


def test_a_wrong_layout_gets_carlas_error_form(protocol: Protocol) -> None:
    for call in protocol.calls.values():
        layouts = call.arguments(protocol.host.version)
        assert failed(protocol.answer(call.name, [[False], *([0] * (len(layouts) + 1))])), call.name
        assert failed(protocol.answer(call.name, [])), call.name
        for wrong in range(len(layouts)):
            given = [value_of(layout.name) for layout in layouts]
            given[wrong] = {"neither": None}
            if layouts[wrong].name != "anything":
                assert failed(protocol.answer(call.name, [[False], *given])), (call.name, wrong)


def test_numbers_that_are_none_are_refused(protocol: Protocol) -> None:
    for bad in (float("nan"), float("inf"), 1e39, "1", True, None):
        answer = protocol.answer("set_actor_location", [[True], 24, [0.0, bad, 0.0]])
        assert answer[0][0] is True, bad


def test_what_is_refused_says_so_and_why(protocol: Protocol) -> None:
    for call in protocol.calls.values():
        if call.how == "refused":
            given = [value_of(layout.name) for layout in call.arguments(protocol.host.version)]
            assert call.why in str(protocol.answer(call.name, [[False], *given]))
    told = protocol.answer("fly_to_the_moon", [[False]])
    assert told == [[0, ["the call 'fly_to_the_moon' is not known to this server"]]]


def test_answers_have_the_layout_of_the_table(protocol: Protocol) -> None:
    for name in (
        *("version", "get_episode_info", "get_episode_settings", "get_available_maps", "get_map_info", "get_map_data"),
        *("get_actor_definitions", "get_weather_parameters", "get_spectator", "get_vehicle_light_states"),
    ):
        ((kind, value),) = protocol.answer(name, [[False]])
        assert kind == 1
        assert protocol.calls[name].gives.holds(value), name


def test_the_first_call_of_a_version_is_unknown_to_the_one_before(protocol: Protocol) -> None:
    known = "is not known" not in str(protocol.answer("get_actor_bounding_box", [[False], 24]))
    assert known == (protocol.host.version >= "0.9.16")
