"""The protocol: every call of clients with its arguments, its result, its first version and its handler.

This table checks the arguments of every call before anything else sees them, makes the page of what is served
(docs/carla-server.md), and is what the fuzzing makes calls from. Names and layouts are LibCarla's
(`client/detail/Client.cpp`, `rpc/`); tests hold the names against those in the clients themselves.
"""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any, Literal

from scenario_compiler.carla_server.answers import actors, batch, lights, looking, records, session, vehicles
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.host import Host, described
from scenario_compiler.carla_server.layouts import (
    ACKERMANN,
    ACKERMANN_SETTINGS,
    ACTOR,
    ANYTHING,
    BONES,
    BONES_OUT,
    BOOL,
    BOX,
    BYTES,
    CONTROL,
    DEBUG_SHAPE,
    DEBUG_SHAPE_BEFORE,
    DEFINITION,
    DESCRIPTION,
    GENERATION,
    I8,
    LABELLED_POINT,
    LIGHTS,
    LONG_TEXT,
    MANAGER,
    PHYSICS,
    REAL,
    SETTINGS,
    TEXT,
    TOKEN,
    TRANSFORM,
    U8,
    U16,
    U32,
    U64,
    VECTOR,
    WALKER_CONTROL,
    WEATHER,
    Layout,
    array,
    struct,
)
from scenario_compiler.carla_server.transport import OVERTAKING

How = Literal["answered", "refused", "ignored"]

NOTHING = Layout("nothing", lambda value: value is None)
"""The result of a call that has no other result."""

RESPONSES = Layout("a response for each command", lambda value: type(value) is list)
"""The result of a batch, which is not wrapped in a response of its own."""

MOST_COMMANDS = 1 << 14
"""Greatest number of commands of a batch."""


@dataclass(frozen=True)
class Call:
    """A call.

    Attributes:
        name: Its name on the wire.
        takes: Layouts of its arguments.
        gives: Layout of its result.
        answer: Its handler; None for a call that is refused or ignored.
        why: Why it is refused or ignored, or what its answer leaves out.
        how: Whether it is answered, refused with an error, or accepted without effect.
        since: The version of CARLA from which on there is such a call.
        before: Layouts of its arguments in versions before the latest, where they differ.
    """

    name: str
    takes: tuple[Layout, ...]
    gives: Layout
    answer: Callable[..., Any] | None = None
    why: str = ""
    how: How = "answered"
    since: str = "0.9.15"
    before: tuple[Layout, ...] | None = None

    def arguments(self, version: str) -> tuple[Layout, ...]:
        """Return the layouts of its arguments in a version."""
        return self.before if self.before is not None and version < "0.9.16" else self.takes


def refused(name: str, why: str, takes: tuple[Layout, ...], gives: Layout = NOTHING, since: str = "0.9.15") -> Call:
    """Return a call that is answered with an error."""
    return Call(name, takes, gives, None, why, "refused", since)


def ignored(name: str, why: str, *takes: Layout, since: str = "0.9.15") -> Call:
    """Return a call that is accepted and has no effect."""
    return Call(name, takes, NOTHING, None, why, "ignored", since)


BONELESS = "bodies have no skeleton here"
NO_TEXTURE = "surfaces have no textures here"
NO_ROS = "there is no bridge to ROS here"
NO_BUFFER = "the renderer has no such buffers"
NO_SKID = "a vehicle turns by its wheels alone"
TRANSFORMS = array(TRANSFORM)
TEXTS = array(TEXT)

CALLS = (
    # Session, maps, clock.
    Call("version", (), TEXT, session.version),
    Call("get_episode_info", (), struct("episode info", U64, TOKEN), session.episode_info),
    Call("get_sensor_token", (U32,), TOKEN, session.sensor_token),
    Call("get_episode_settings", (), SETTINGS, session.settings),
    Call("set_episode_settings", (SETTINGS,), U64, session.set_settings),
    Call("tick_cue", (), U64, session.tick),
    Call("get_available_maps", (), TEXTS, session.available_maps),
    Call("get_map_info", (), struct("map info", TEXT, TRANSFORMS), session.map_info),
    Call("get_map_data", (), LONG_TEXT, session.map_data),
    Call("load_new_episode", (TEXT, BOOL, U16), NOTHING, session.load_episode, "layers are not told apart"),
    Call(
        "copy_opendrive_to_file",
        (LONG_TEXT, GENERATION),
        NOTHING,
        session.copy_opendrive,
        "roads are drawn by our own mesh, without walls",
    ),
    ignored("load_map_layer", "a map has one layer", U16),
    ignored("unload_map_layer", "a map has one layer", U16),
    Call("get_required_files", (TEXT,), TEXTS, session.required_files, "there is no navigation mesh"),
    Call("request_file", (TEXT,), BYTES, session.request_file, "no file is served"),
    Call("get_navigation_mesh", (), BYTES, session.navigation_mesh, "there is no navigation mesh"),
    Call("get_actor_definitions", (), array(DEFINITION), session.actor_definitions),
    Call("get_weather_parameters", (), WEATHER, session.weather),
    Call("set_weather_parameters", (WEATHER,), NOTHING, session.set_weather),
    Call("get_imui_gravity", (), REAL, session.gravity, since="0.9.16"),
    Call("set_imui_gravity", (REAL,), NOTHING, session.set_gravity, since="0.9.16"),
    # The Traffic Manager, which lives in a client.
    Call("is_traffic_manager_running", (U16,), BOOL, session.manager_runs),
    Call("get_traffic_manager_running", (U16,), MANAGER, session.manager),
    Call("add_traffic_manager_running", (MANAGER,), BOOL, session.add_manager),
    Call("destroy_traffic_manager", (U16,), BOOL, session.remove_manager),
    # Actors.
    Call("spawn_actor", (DESCRIPTION, TRANSFORM), ACTOR, actors.spawn_actor),
    Call(
        "spawn_actor_with_parent",
        (DESCRIPTION, TRANSFORM, U32, U32, TEXT),
        ACTOR,
        actors.spawn_with_parent,
        "spring arms are stiff, sockets are not known; a vehicle or a walker does not go along",
        before=(DESCRIPTION, TRANSFORM, U32, U32),
    ),
    Call("destroy_actor", (U32,), BOOL, actors.destroy, "lights, signs and the spectator stay: false"),
    Call("get_actors_by_id", (array(U32),), array(ACTOR), actors.actors_by_id),
    Call("get_spectator", (), ACTOR, actors.spectator),
    Call("get_actor_bounding_box", (U32,), BOX, actors.bounding_box, since="0.9.16"),
    Call("set_actor_location", (U32, VECTOR), NOTHING, actors.set_location),
    Call("set_actor_transform", (U32, TRANSFORM), NOTHING, actors.set_transform),
    Call("set_actor_target_velocity", (U32, VECTOR), NOTHING, actors.set_velocity, "along the heading"),
    ignored("set_actor_target_angular_velocity", NO_SKID, U32, VECTOR),
    Call("enable_actor_constant_velocity", (U32, VECTOR), NOTHING, actors.keep_velocity, "along the heading"),
    Call("disable_actor_constant_velocity", (U32,), NOTHING, actors.let_velocity),
    Call("add_actor_impulse", (U32, VECTOR), NOTHING, actors.add_impulse, "along the heading"),
    Call("add_actor_impulse_at_location", (U32, VECTOR, VECTOR), NOTHING, actors.add_impulse, "along the heading"),
    Call("add_actor_force", (U32, VECTOR), NOTHING, actors.add_force, "along the heading"),
    Call("add_actor_force_at_location", (U32, VECTOR, VECTOR), NOTHING, actors.add_force, "along the heading"),
    ignored("add_actor_angular_impulse", NO_SKID, U32, VECTOR),
    ignored("add_actor_torque", NO_SKID, U32, VECTOR),
    Call("set_actor_simulate_physics", (U32, BOOL), NOTHING, actors.simulate_physics, why="no physics moves a prop"),
    Call("set_actor_collisions", (U32, BOOL), NOTHING, actors.collide),
    ignored("set_actor_dead", "a dead actor stays as it is", U32),
    Call(
        "set_actor_enable_gravity", (U32, BOOL), NOTHING, actors.let_weigh, "bodies stay on the road, without traction"
    ),
    ignored("set_actor_autopilot", "the Traffic Manager in the client drives", U32, BOOL),
    refused("get_actor_component_world_transform", BONELESS, (U32, TEXT), TRANSFORM, "0.9.16"),
    refused("get_actor_component_relative_transform", BONELESS, (U32, TEXT), TRANSFORM, "0.9.16"),
    refused("get_actor_bone_world_transforms", BONELESS, (U32,), TRANSFORMS, "0.9.16"),
    refused("get_actor_bone_relative_transforms", BONELESS, (U32,), TRANSFORMS, "0.9.16"),
    refused("get_actor_component_names", BONELESS, (U32,), TEXTS, "0.9.16"),
    refused("get_actor_bone_names", BONELESS, (U32,), TEXTS, "0.9.16"),
    refused("get_actor_socket_world_transforms", BONELESS, (U32,), TRANSFORMS, "0.9.16"),
    refused("get_actor_socket_relative_transforms", BONELESS, (U32,), TRANSFORMS, "0.9.16"),
    refused("get_actor_socket_names", BONELESS, (U32,), TEXTS, "0.9.16"),
    refused("get_vehicle_bone_world_transforms", BONELESS, (U32,), TRANSFORMS, "0.9.16"),
    # Vehicles.
    Call("apply_control_to_vehicle", (U32, CONTROL), NOTHING, vehicles.control),
    Call("apply_ackermann_control_to_vehicle", (U32, ACKERMANN), NOTHING, vehicles.ackermann),
    Call("get_ackermann_controller_settings", (U32,), ACKERMANN_SETTINGS, vehicles.ackermann_settings),
    Call(
        "apply_ackermann_controller_settings",
        (U32, ACKERMANN_SETTINGS),
        NOTHING,
        vehicles.set_ackermann_settings,
        "kept; the target is followed directly",
    ),
    Call("get_physics_control", (U32,), PHYSICS, vehicles.physics),
    Call(
        "apply_physics_control",
        (U32, PHYSICS),
        NOTHING,
        vehicles.set_physics,
        "wheel angle, mass, friction, damping and drag have an effect; all is stored",
    ),
    Call("get_vehicle_light_state", (U32,), LIGHTS, vehicles.lights),
    Call("set_vehicle_light_state", (U32, LIGHTS), NOTHING, vehicles.set_lights),
    Call("get_vehicle_light_states", (), array(struct("light state of a vehicle", U32, U32)), vehicles.all_lights),
    Call("open_vehicle_door", (U32, U8), NOTHING, vehicles.open_door, "kept, not drawn"),
    Call("close_vehicle_door", (U32, U8), NOTHING, vehicles.close_door, "kept, not drawn"),
    Call(
        "set_wheel_steer_direction",
        (U32, U8, REAL),
        NOTHING,
        vehicles.turn_wheel,
        "kept while physics does not move the vehicle, not drawn",
    ),
    Call("get_wheel_steer_angle", (U32, U8), REAL, vehicles.wheel_angle),
    ignored("set_wheel_pitch_angle", "wheels are not drawn turned", U32, U8, REAL, since="0.9.16"),
    refused("get_wheel_pitch_angle", "wheels do not turn about their axles here", (U32, U8), REAL, "0.9.16"),
    Call("get_telemetry_data", (U32,), ANYTHING, vehicles.telemetry, "without its wheels", since="0.9.16"),
    ignored("show_vehicle_debug_telemetry", "there is no window", U32, BOOL),
    ignored("enable_carsim", "CarSim is not part of this server", U32, TEXT),
    ignored("use_carsim_road", "CarSim is not part of this server", U32, BOOL),
    ignored("enable_chrono_physics", "Chrono is not part of this server", U32, U64, REAL, TEXT, TEXT, TEXT, TEXT),
    ignored("restore_physx_physics", "the physics is never changed", U32, since="0.9.16"),
    # Walkers.
    Call("apply_control_to_walker", (U32, WALKER_CONTROL), NOTHING, vehicles.walk, "jumps begin on the ground only"),
    Call("get_bones_transform", (U32,), BONES_OUT, vehicles.bones, "those that were set"),
    Call("set_bones_transform", (U32, BONES), NOTHING, vehicles.set_bones, "kept, not drawn"),
    ignored("blend_pose", BONELESS, U32, REAL),
    ignored("get_pose_from_animation", BONELESS, U32),
    # Traffic lights.
    Call("set_traffic_light_state", (U32, U8), NOTHING, lights.set_state),
    Call("set_traffic_light_green_time", (U32, REAL), NOTHING, lights.set_green),
    Call("set_traffic_light_yellow_time", (U32, REAL), NOTHING, lights.set_yellow),
    Call("set_traffic_light_red_time", (U32, REAL), NOTHING, lights.set_red),
    Call("freeze_traffic_light", (U32, BOOL), NOTHING, lights.freeze),
    Call("reset_traffic_light_group", (U32,), NOTHING, lights.reset_group),
    Call("reset_all_traffic_lights", (), NOTHING, lights.reset_all),
    Call("freeze_all_traffic_lights", (BOOL,), NOTHING, lights.freeze_all),
    Call("get_group_traffic_lights", (U32,), array(U32), lights.group_of),
    Call("get_light_boxes", (U32,), array(BOX), lights.boxes),
    # Recordings.
    Call("start_recorder", (TEXT, BOOL), TEXT, records.start, "in a format of our own"),
    Call("stop_recorder", (), NOTHING, records.stop),
    Call("show_recorder_file_info", (TEXT, BOOL), TEXT, records.info),
    Call("show_recorder_collisions", (TEXT, I8, I8), TEXT, records.collisions),
    Call("show_recorder_actors_blocked", (TEXT, REAL, REAL), TEXT, records.blocked),
    Call(
        "replay_file",
        (TEXT, REAL, REAL, U32, BOOL, TRANSFORM),
        TEXT,
        records.replay,
        "files of this server; without sensors",
        before=(TEXT, REAL, REAL, U32, BOOL),
    ),
    Call("stop_replayer", (BOOL,), NOTHING, records.stop_replay),
    Call("set_replayer_time_factor", (REAL,), NOTHING, records.set_pace),
    Call("set_replayer_ignore_hero", (BOOL,), NOTHING, records.ignore_hero),
    ignored("set_replayer_ignore_spectator", "the spectator is not played", BOOL),
    # Sensors.
    ignored("enable_sensor_for_ros", NO_ROS, U32),
    ignored("disable_sensor_for_ros", NO_ROS, U32),
    refused("is_sensor_enabled_for_ros", NO_ROS, (U32,), BOOL),
    refused("get_gbuffer_token", NO_BUFFER, (U32, U32), BYTES),
    refused("enable_gbuffers", NO_BUFFER, (U32, BOOL), since="0.9.16"),
    refused("are_gbuffers_enabled", NO_BUFFER, (U32,), BOOL, "0.9.16"),
    Call("set_ignored_vehicles", (U32, array(U32)), NOTHING, actors.ignore_vehicles, "for lidars only", since="0.9.16"),
    ignored("send", "messages between vehicles are not simulated", U32, ANYTHING, since="0.9.16"),
    # Batches, drawing, what stands where.
    Call("apply_batch", (array(ANYTHING, MOST_COMMANDS), BOOL), RESPONSES, batch.apply),
    Call(
        "draw_debug_shape",
        (DEBUG_SHAPE,),
        NOTHING,
        session.draw_shape,
        "in pictures of colours; there is no display for strings",
        before=(DEBUG_SHAPE_BEFORE,),
    ),
    Call("clear_debug_shape", (), NOTHING, session.clear_shapes, since="0.9.16"),
    ignored("clear_debug_string", "there is no display for strings", since="0.9.16"),
    Call("query_lights_state", (TEXT,), array(ANYTHING), looking.lamps, "a map has no street lamps"),
    ignored("update_lights_state", "a map has no street lamps", TEXT, array(ANYTHING), BOOL),
    ignored("update_day_night_cycle", "a map has no street lamps", TEXT, BOOL),
    Call(
        "get_all_level_BBs", (U8,), array(BOX), looking.level_boxes, "vehicles, walkers, props, things beside the roads"
    ),
    Call("get_environment_objects", (U8,), array(ANYTHING), looking.environment_objects, "there are none"),
    ignored("enable_environment_objects", "there are no objects beside the roads", array(U64), BOOL),
    Call(
        "project_point",
        (VECTOR, VECTOR, REAL),
        struct("hit", BOOL, LABELLED_POINT),
        looking.project_point,
        "the ground and bodies",
    ),
    Call(
        "cast_ray",
        (VECTOR, VECTOR),
        array(LABELLED_POINT),
        looking.cast_ray,
        "meets the ground, vehicles, walkers and props",
    ),
    Call("get_names_of_all_objects", (), TEXTS, looking.names_of_objects, "vehicles, walkers and props only"),
    refused("apply_color_texture_to_objects", NO_TEXTURE, (ANYTHING, ANYTHING, ANYTHING)),
    refused("apply_float_color_texture_to_objects", NO_TEXTURE, (ANYTHING, ANYTHING, ANYTHING)),
    ignored("set_annotations_traverse_translucency", "nothing is translucent", BOOL, since="0.9.16"),
)
"""Every call, by groups."""


class Protocol:
    """The protocol of one version, answered by a host."""

    def __init__(self, host: Host) -> None:
        """Choose the calls of the host's version."""
        self.host = host
        self.calls = {call.name: call for call in CALLS if call.since <= host.version}

    def answer(self, name: str, arguments: list[Any]) -> Any:
        """Answer a call.

        Args:
            name: Its name.
            arguments: What came with it: whether the client waits for the answer, then its arguments.

        Returns:
            The response as it lies on the wire, or something to wait for that.
        """
        if self.host.beginning is not None and name not in OVERTAKING:
            return self._answer_in_new_episode(self.host.beginning, name, arguments)
        call = self.calls.get(name)
        if call is None:
            self.host.once(f"call '{name[:80]}' is not known")
            return [[0, [f"the call '{name[:80]}' is not known to this server"]]]
        layouts = call.arguments(self.host.version)
        given = arguments[1:]
        meta = arguments[0] if arguments else None
        if type(meta) is not list or len(given) != len(layouts):
            return _failed(call, f"{name}: it takes {len(layouts)} arguments, not {len(given)}")
        for number, (layout, value) in enumerate(zip(layouts, given, strict=True), 1):
            if not layout.holds(value):
                return _failed(call, f"{name}: argument {number} is not of the layout '{layout.name}'")
        if call.answer is None:
            self.host.once(f"call '{name}' is {call.how}: {call.why}")
            return _failed(call, f"{name} is not served: {call.why}") if call.how == "refused" else _done(call, None)
        try:
            found = call.answer(self.host, *given)
        except CallError as fault:
            return _done(call, None) if _about_the_dead(self.host, call, given) else _failed(call, str(fault))
        except Exception as fault:  # a fault of ours ends neither the clock nor the client
            return self._our_fault(call, fault)
        if isinstance(found, Awaitable):
            return self._awaited(call, found)
        return _done(call, found)

    async def _answer_in_new_episode(self, beginning: asyncio.Future[None], name: str, arguments: list[Any]) -> Any:
        await asyncio.wait([beginning])
        found = self.answer(name, arguments)
        return await found if isinstance(found, Awaitable) else found

    async def _awaited(self, call: Call, found: Awaitable[Any]) -> Any:
        try:
            return _done(call, await found)
        except CallError as fault:
            return _failed(call, str(fault))
        except Exception as fault:  # as above
            return self._our_fault(call, fault)

    def _our_fault(self, call: Call, fault: Exception) -> Any:
        self.host.once(f"call '{call.name}' failed {described(fault)}")
        return _failed(call, f"{call.name} failed in the server: {type(fault).__name__}")


def _about_the_dead(host: Host, call: Call, given: list[Any]) -> bool:
    """Return whether a call that only does something is about an actor that has just died.

    Clients make such calls in threads of their own, where an error ends the client.
    """
    return call.gives is NOTHING and bool(given) and type(given[0]) is int and given[0] not in host.stage.actors


def _done(call: Call, value: Any) -> Any:
    if call.gives is RESPONSES:
        return value
    return [[False]] if call.gives is NOTHING else [[1, value]]


def _failed(call: Call, why: str) -> Any:
    if call.gives is RESPONSES:
        return []
    return [[True, [why]]] if call.gives is NOTHING else [[0, [why]]]
