"""The one loop: engine and world step by step, with the controller between steps."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable
from dataclasses import replace

from scenario_compiler.controllers import (
    Control,
    ControllerError,
    ControllerModel,
    SensorData,
    VehicleState,
    create_controller,
)
from scenario_compiler.engine.camera_health import BLUR_AT_ONE
from scenario_compiler.engine.following import leader_gap
from scenario_compiler.engine.opcodes import (
    ELEMENT_EVENT,
    FAILURE_BLACKOUT,
    FAILURE_BLUR,
    FAILURE_DIRT,
    FAR,
    SEEN_IN_PICTURES,
    STOP_NONE,
)
from scenario_compiler.engine.presence import there_for
from scenario_compiler.engine.program import Program, build_program
from scenario_compiler.engine.sensor import look_ahead
from scenario_compiler.engine.slots import K_FIELD_OF_VIEW, K_SENSOR_RANGE
from scenario_compiler.engine.state import State, make_draws, new_state
from scenario_compiler.engine.step import reset, step
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.break_off import QUANTITIES, BreakOff, engine_break_off
from scenario_compiler.recording.names import BY_HAND, CAUSES, EVENT_KINDS, FAILURES, STOP_REASONS
from scenario_compiler.recording.recording import Header, Recording, RecordingBuilder
from scenario_compiler.recording.versions import processor, versions
from scenario_compiler.roads import Network, Pose
from scenario_compiler.runtime.action_events import OF_ACTIONS, action_text, actions_of
from scenario_compiler.runtime.messages import messages
from scenario_compiler.runtime.pictures import PICTURED, picture_of
from scenario_compiler.runtime.route_ahead import route_ahead
from scenario_compiler.trust import Trust
from scenario_compiler.vocabulary.actions import MessageAction
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.weather import weather_of
from scenario_compiler.worlds import WORLDS, CameraFaults, Snapshot, World

ENTITY_COLUMNS = ("present", "x", "y", "z", "h", "v", "a", "road", "lane", "s", "off", "throttle", "steer", "brake")
RUN_COLUMNS = {
    "takeover_state": "takeover_state",
    "cause": "cause",
    "confidence_left": "conf_left",
    "confidence_right": "conf_right",
    "sensor_health": "health",
    "sigma": "sigma",
    "blocked_distance": "blocked_distance",
    "lane_end_distance": "lane_end_distance",
}
"""Recorded column to the engine's."""

LANE_COLUMNS = tuple(f"{side}_{name}" for side in ("left", "right") for name in ("y0", "slope", "curvature"))


def open_world(name: str, plan: Plan, network: Network) -> World:
    """Open a world by its name in WORLDS; KeyError when there is none of that name."""
    module, _, attribute = WORLDS[name].partition(":")
    world: World = getattr(importlib.import_module(module), attribute)(plan, network)
    return world


def run(
    plan: Plan,
    world: World,
    seed: int = 1,
    *,
    variant: int = 0,
    progress: Callable[[float], None] | None = None,
    trust: Trust | None = None,
) -> Recording:
    """Execute a plan in a world.

    Args:
        plan: The plan.
        world: A world opened for the plan; it can be used for several runs.
        seed: Seed of all that is drawn.
        variant: Index of the variant, which the draws depend on too.
        progress: Called with the time, s, after every step.
        trust: Code of the user's own that the plan may name as its controller.

    Raises:
        ControllerError: The controller cannot be had, so there is no run. One that fails later ends the run, and the
            recording says why.
    """
    execution = _Execution(plan, world, seed, variant, trust)
    while execution.going:
        try:
            execution.advance()
        except ControllerError as fault:
            return execution.break_off(fault)
        if progress is not None:
            progress(execution.state.clock[0])
    return execution.finish()


def faults_of(state: State) -> CameraFaults:
    """Return what is wrong with the camera beside its noise, from the engine's state."""
    now = state.failure_now
    return CameraFaults(
        dark=now[FAILURE_BLACKOUT],
        blur=BLUR_AT_ONE * now[FAILURE_BLUR],
        dirt=now[FAILURE_DIRT],
        missing=state.missing[0] == 1,
        frozen=state.frozen[0] == 1,
    )


CAUSED = frozenset({"warning", "request", "escalation", "minimum_risk"})
"""Kinds of events that have a cause."""

NAMED = frozenset({"storyboard_start", "storyboard_end"})
"""Kinds of events that tell of an event of the storyboard."""


def named_events(plan: Plan, program: Program) -> dict[int, tuple[str, str]]:
    """Return the name of each event of the storyboard, and who does it where that is one, by the event's element."""
    elements = (at for at, kind in enumerate(program.element_kind) if kind == ELEMENT_EVENT)
    events = (
        (event.name, group.actors[0] if len(group.actors) == 1 else "") for group, event in plan.storyboard.events()
    )
    return dict(zip(elements, events, strict=True))


class _Execution:
    """One run under way."""

    def __init__(self, plan: Plan, world: World, seed: int, variant: int, trust: Trust | None) -> None:
        self.plan = plan
        self.world = world
        self.tables = world.network.tables
        self.program = build_program(plan, world.network)
        self.state = new_state(self.program)
        self.weather_changes = self.program.weather_count[0] > 1
        self.told = [word for word in walk(plan.storyboard) if isinstance(word, MessageAction)]
        self.named = named_events(plan, self.program)
        self.actions = list(actions_of(plan))
        self.state.draw[:] = make_draws(seed, variant)
        self.controller: ControllerModel | None = None
        if plan.controller is not None and plan.perception == "camera":
            self.controller = create_controller(plan.controller, trust)
            self.controller.reset(seed)
        self.control: Control | None = None
        self.seen: SensorData | None = None
        self.lanes = {name: [math.nan] for name in LANE_COLUMNS}
        self.logged = 0
        self.pictured: set[str] = set()
        reset(self.tables, self.program, self.state)
        world.reset(self.snapshot(), seed)
        self.builder = RecordingBuilder(self._header(seed, variant), world.network.road_ids, self._columns())
        self.builder.append(self.state.clock[0])
        self._note_events()

    @property
    def going(self) -> bool:
        """Whether the run goes on."""
        return self.state.stop[0] == STOP_NONE

    def advance(self) -> None:
        """Let the controller act where a control step is due, then step the engine and the world."""
        if self.state.frame[0] % self.plan.control_every == 0 and self.controller is not None:
            self._let_control(self.controller)
        before = self.state.clock[0]
        step(self.tables, self.program, self.state)
        if self.state.clock[0] > before:
            self.world.step(self.snapshot())
            self.builder.append(self.state.clock[0])
        self._note_events()

    def snapshot(self) -> Snapshot:
        """Return the entities' states now."""
        st = self.state
        poses = map(Pose, st.x, st.y, st.z, st.h, st.pitch, st.roll)
        weather = weather_of(st.weather) if self.weather_changes else None
        present = tuple(there_for(st, i, SEEN_IN_PICTURES) == 1 for i in range(len(st.present)))
        moving = tuple(poses), tuple(st.v)
        return Snapshot(st.clock[0], st.frame[0], present, *moving, st.sigma[0], faults_of(st), weather)

    def finish(self) -> Recording:
        """Return the recording."""
        st = self.state
        reason = STOP_REASONS[st.stop[0]]
        self.builder.event(st.clock[0], "stop", message=reason)
        columns = {name: getattr(st, name) for name in QUANTITIES}
        ids = [entity.id for entity in self.plan.entities]
        why = engine_break_off(st.flag[0], st.flag_at[0], ids, columns, st.clock[0])
        return self.builder.finish(reason, st.flag[0], why)

    def break_off(self, fault: ControllerError) -> Recording:
        """Return the recording up to where the controller failed."""
        self.builder.event(self.state.clock[0], "stop", message="controller_failed")
        why = BreakOff(code=fault.code.id, message=str(fault), file=fault.place.file, line=fault.place.line)
        return self.builder.finish("controller_failed", broke_off=why)

    def _let_control(self, controller: ControllerModel) -> None:
        st, ego = self.state, self.plan.ego.vehicle
        const = self.program.const
        look_ahead(self.tables, self.program, st, 0, const[K_SENSOR_RANGE], const[K_FIELD_OF_VIEW])
        gap, lead = leader_gap(self.program, st, 0, 0.0, 1, -FAR)
        seen = self.seen
        if seen is None or st.frame[0] % self.program.image_every[0] == 0:
            seen = self.world.observe(self.snapshot())
        route, junction = route_ahead(self.tables, self.program, st)
        self.seen = replace(
            seen,
            lead_gap=None if gap >= FAR else gap,
            lead_speed=0.0 if gap >= FAR else lead,
            route=route,
            junction=junction,
        )
        vehicle = VehicleState(
            x=st.x[0],
            y=st.y[0],
            heading=st.h[0],
            wheelbase=ego.wheelbase,
            center=ego.center,
            max_steer=math.radians(ego.max_steer),
            max_acceleration=ego.max_acceleration,
            max_deceleration=ego.max_deceleration,
            desired_speed=st.target_speed[0],
            period=self.plan.step * self.plan.control_every,
        )
        self.control = control = controller.control(self.seen, st.v[0], vehicle)
        st.auto_throttle[0], st.auto_steer[0], st.auto_brake[0] = control.throttle, control.steer, control.brake
        st.conf_left[0], st.conf_right[0] = control.confidence_left, control.confidence_right
        st.health[0] = control.sensor_health
        st.auto_request[0] = int(controller.initiate_takeover())
        for column in LANE_COLUMNS:
            side, _, name = column.partition("_")
            boundary = getattr(control.lanes, side, None)
            self.lanes[column][0] = getattr(boundary, name, math.nan)

    def _note_events(self) -> None:
        """Take down what the engine logged since the last time, and what the driver is told of it."""
        st = self.state
        kept = min(st.log_count[0], len(st.log_kind))
        for at in range(self.logged, kept):
            kind, value = EVENT_KINDS[st.log_kind[at]], st.log_value[at]
            cause = self._cause(kind, value)
            if kind in NAMED:
                name, entity = self.named[int(value)]
                self.builder.event(st.log_time[at], kind, entity=entity, message=name)
            elif kind == "contact":
                one, other = divmod(int(value), len(self.plan.entities))
                struck = self.plan.entities
                self.builder.event(st.log_time[at], kind, entity=struck[one].id, message=struck[other].id)
            elif kind in OF_ACTIONS:
                action, entity = self.actions[int(value)]
                about, text = action_text(action)
                self.builder.event(st.log_time[at], kind, entity=entity, cause=about, message=text)
            elif kind != "message":
                told = value if kind == "hazard_lights" else None
                self.builder.event(st.log_time[at], kind, entity=self._entity(kind, value), cause=cause, value=told)
            for modality, text in self._messages(kind, cause, value):
                self.builder.event(st.log_time[at], "message", cause=modality, message=text)
            self._picture(st.log_time[at], kind, cause)
        self.logged = kept

    def _cause(self, kind: str, value: float) -> str:
        """Return why something happened: the cause of a request, the kind of a failure, who stopped; else empty."""
        if kind == "standstill":
            return BY_HAND if value > 0.0 else ""
        if kind in ("failure", "failure_end"):
            return FAILURES[int(value)]
        return CAUSES[self.state.cause[0]] if kind in CAUSED else ""

    def _messages(self, kind: str, cause: str, value: float) -> list[tuple[str, str]]:
        """Return (modality, text) of what the driver is told: by the policy, or by an action."""
        if kind == "message":
            action = self.told[int(value)]
            return [(modality, action.text) for modality in action.modality]
        return messages(self.plan.takeover, kind, cause)

    def _entity(self, kind: str, value: float) -> str:
        """Return whom an event concerns: at a collision what was hit, else the vehicle that reports are about."""
        return self.plan.entities[int(value) if kind == "collision" else 0].id if self.plan.entities else ""

    def _header(self, seed: int, variant: int) -> Header:
        return Header(
            plan_digest=self.plan.digest,
            plan_name=self.plan.name,
            seed=seed,
            variant=variant,
            parameters=parameter_values(self.plan.parameters),
            step=self.plan.step,
            entities=tuple(entity.id for entity in self.plan.entities),
            perception=self.plan.perception,
            world=self.world.name,
            versions=versions(),
            processor=processor(),
        )

    def _columns(self) -> dict[str, list[float] | list[int]]:
        """Return the live columns of the engine's state that are recorded."""
        st = self.state
        columns: dict[str, list[float] | list[int]] = {name: getattr(st, name) for name in ENTITY_COLUMNS}
        if self.plan.controller is not None:
            columns |= {name: getattr(st, column) for name, column in RUN_COLUMNS.items()}
        return columns | self.lanes

    def _picture(self, t: float, kind: str, cause: str) -> None:
        """Keep the first picture of each kind of event that reports show."""
        if self.seen is None or self.control is None or self.controller is None:
            return
        if kind not in PICTURED or kind in self.pictured:
            return
        self.pictured.add(kind)
        view = self.world.picture(self.snapshot())
        speed = self.state.v[0]
        png = picture_of(self.plan, view, self.seen, self.controller, self.control, speed, kind, cause)
        self.builder.frame(t, kind, png)
