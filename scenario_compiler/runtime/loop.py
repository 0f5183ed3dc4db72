"""The run loop: it steps engine and world, and calls the controller between steps."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from scenario_compiler.controllers.foreign import ControllerError
from scenario_compiler.controllers.named import create_controller
from scenario_compiler.controllers.person import Person, RecordedPerson
from scenario_compiler.diagnostics import suggestion
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State, make_draws
from scenario_compiler.engine.motion.watching import WATCH_MOTION
from scenario_compiler.engine.program.build import build_program, lowered
from scenario_compiler.engine.reference_runs import avoided_by
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.forms.failure import EngineError
from scenario_compiler.plan.model import Plan
from scenario_compiler.randomness import whole_number
from scenario_compiler.recording.break_off import BROKE_OFF, OF_ENTITIES, QUANTITIES, break_off_text
from scenario_compiler.recording.names import (
    MOMENTS,
    SOURCES,
    STOP_REASONS,
    TAKEOVER_STATES,
    WISHES,
    EventKind,
    StopReason,
)
from scenario_compiler.recording.recording import Header, Recording, RecordingBuilder
from scenario_compiler.recording.versions import processor, versions
from scenario_compiler.roads import Network
from scenario_compiler.runtime.engine_fault import ENGINE_BROKE_OFF
from scenario_compiler.runtime.log import EventLog
from scenario_compiler.runtime.messages import Messenger
from scenario_compiler.runtime.pictures import picture_of
from scenario_compiler.runtime.snapshot import entities_of, faults_of
from scenario_compiler.trust import Trust
from scenario_compiler.vocabulary.criteria import references_in
from scenario_compiler.vocabulary.driver import ReferenceName
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.weather import weather_of
from scenario_compiler.worlds import (
    WORLDS,
    EgoCommand,
    EgoState,
    Snapshot,
    World,
    WorldError,
    WorldOptions,
)
from scenario_compiler.worlds.model import UNKNOWN_WORLD

if TYPE_CHECKING:
    from scenario_compiler.controllers.data import Control, SensorData
    from scenario_compiler.controllers.model import ControllerModel

ENTITY_COLUMNS = (
    *("present", "x", "y", "z", "h", "v", "a", "road", "lane", "s", "off"),
    *("pitch", "roll", "throttle", "steer", "brake", "towed_by"),
)
RUN_COLUMNS = {
    "takeover_state": "takeover_state",
    "cause": "cause",
    "confidence_left": "conf_left",
    "confidence_right": "conf_right",
    "sensor_health": "health",
    "sigma": "sigma",
    "blocked_distance": "blocked_distance",
    "blocked_speed": "blocked_speed",
    "lane_end_distance": "lane_end_distance",
    "limit_time": "limit_time",
    "traffic_density": "traffic_density",
    "lane_time_to_collision": "lane_time",
    "lane_width": "lane_width",
    "lane_heading": "path_heading",
    "on_road": "on_road",
}
"""Column of the engine for each recorded column."""

PERSON_COLUMNS = ("person_throttle", "person_brake", "person_steer", "person_wish")
"""Columns of the engine with a person's inputs; they are recorded if a person is at the wheel."""

SOURCE_CODES = {source: code for code, source in SOURCES.items()}
WISH_CODES = {wish: code for code, wish in WISHES.items()}

LANE_COLUMNS = tuple(f"{side}_{name}" for side in ("left", "right") for name in ("y0", "slope", "curvature"))


def open_world(name: str, plan: Plan, network: Network, **options: object) -> World:
    """Open a world; use it in a `with` statement, so that it is closed at the end.

    Args:
        name: Name of the world in WORLDS.
        plan: The plan that will run in it.
        network: The plan's map.
        **options: Options of the world, as its `Options` model declares them.

    Raises:
        pydantic.ValidationError: An option is wrong.
        WorldError: There is no world of that name, or the world cannot be opened.
    """
    if name not in WORLDS:
        raise WorldError(f"there is no world '{name}'{suggestion(name, WORLDS)}", UNKNOWN_WORLD)
    module, _, attribute = WORLDS[name].partition(":")
    found = getattr(importlib.import_module(module), attribute)
    options_of: type[WorldOptions] = found.Options
    given = options_of.model_validate(options) if options else options_of.model_construct()
    world: World = found(plan, network, given)
    return world


def run(
    plan: Plan,
    world: World,
    seed: int = 1,
    *,
    variant: int = 0,
    interpreted: bool = False,
    progress: Callable[[float], None] | None = None,
    trust: Trust | None = None,
    person: Person | None = None,
    ended: Callable[[], bool] | None = None,
) -> Recording:
    """Execute a plan in a world.

    A run ends early if the world is lost, the controller fails or the engine has no result. The stop reason and the
    last event of the recording then give the reason, and the recording has everything up to that time.

    Args:
        plan: The plan.
        world: A world opened for the plan; it can be used for several runs.
        seed: Seed of all random numbers.
        variant: Index of the variant, on which the random numbers depend too.
        interpreted: Whether to use the interpreted engine even if the compiled one is available.
        progress: Called with the time, s, after every step.
        trust: Trusted code that the plan may name as its controller.
        person: The person at the wheel of a plan with a person; without one nobody responds. A recorded person ends the
            run where the user ended the recorded one.
        ended: Asked after every step whether the user has ended the run.

    Raises:
        ValueError: The world has another map than the plan, or a file of the map that has changed since.
        TypeError: The seed or the variant is not a whole number; or the world returns a state of the ego that it does
            not move, or none of one that it moves.
    """
    execution = Execution(plan, world, seed, variant, interpreted=interpreted, trust=trust, person=person)
    while execution.going:
        execution.advance()
        if progress is not None:
            progress(execution.state.clock[0])
        if isinstance(person, RecordedPerson) and person.has_ended_the_run:
            return execution.finish("user")
        if ended is not None and ended():
            return execution.finish("user")
    return execution.finish()


def source_of(st: State, program: Program) -> int:
    """Return the source of the ego's commands, as a code of `SOURCES`."""
    if st.takeover_state[0] in (op.TAKEOVER_MANUAL, op.TAKEOVER_HAND_BACK):
        return SOURCE_CODES["person" if program.person[0] == 1 else "driver model"]
    stopping = st.takeover_state[0] in (op.TAKEOVER_MINIMUM_RISK, op.TAKEOVER_STANDSTILL)
    return SOURCE_CODES["minimum-risk manoeuvre" if stopping else "automation"]


class Execution:
    """A run in progress, step by step; `run` executes one at once, a page executes one in real time."""

    def __init__(
        self,
        plan: Plan,
        world: World,
        seed: int,
        variant: int = 0,
        *,
        interpreted: bool = False,
        trust: Trust | None = None,
        person: Person | None = None,
    ) -> None:
        """Prepare everything for the start of the run; the arguments are those of `run`.

        Raises:
            ValueError: The world has another map than the plan.
            TypeError: The seed or the variant is not a whole number.
        """
        seed, variant = whole_number("seed", seed), whole_number("variant", variant)
        if world.network.sha256 != plan.map.sha256:
            raise ValueError(f"the world's map, {world.network.path}, is not the plan's, {plan.map.file}")
        self.plan = plan
        self.world = world
        self.lowered = lowered(plan, world.network, posed=world.moves_ego)
        self.program = self.lowered.program
        self.program.watches[0] |= WATCH_MOTION
        self.simulation = Simulation(world.network.tables, self.program, interpreted=interpreted)
        self.state = self.simulation.state
        self.weather_changes = self.program.weather_count[0] > 1
        self.log = EventLog(plan, self.program)
        self.messenger = Messenger(plan)
        self.controller: ControllerModel | None = None
        self.control: Control | None = None
        self.seen: SensorData | None = None
        self.lanes = {name: [math.nan] for name in LANE_COLUMNS}
        self.pictured: set[str] = set()
        self.person = person
        self.source = [0]
        self.broken: StopReason = ""
        self.simulation.reset(make_draws(seed, variant))
        self.builder = RecordingBuilder(self._header(seed, variant), world.network.road_ids, self._columns())
        with self._noticing_failures():
            if plan.controller is not None and plan.perception == "camera":
                with self._of_controller():
                    self.controller = create_controller(plan.controller, trust)
                    self.controller.reset(seed)
            world.reset(self.snapshot(), seed)
        self.builder.append(self.state.clock[0])
        self._note_events()

    @property
    def going(self) -> bool:
        """Whether the run continues."""
        return not self.broken and not self.simulation.over

    def advance(self) -> None:
        """Call the controller if this is a control step, then step the engine and the world."""
        with self._noticing_failures():
            if self.person is not None:
                self._let_act(self.person)
            if self.state.frame[0] % self.plan.control_every == 0 and self.controller is not None:
                self._let_control(self.controller)
            if self.simulation.begin():
                self.simulation.move()
                self._step_world()
                self.simulation.end()
                self.source[0] = source_of(self.state, self.program)
                self.builder.append(self.state.clock[0])
            self._note_events()

    def _let_act(self, person: Person) -> None:
        """Write the person's inputs into the state's input columns."""
        st = self.state
        done = person.act(st.clock[0], TAKEOVER_STATES[st.takeover_state[0]])
        st.person_throttle[0], st.person_brake[0], st.person_steer[0] = done.throttle, done.brake, done.steer
        st.person_wish[0] = WISH_CODES[done.wish]

    def _step_world(self) -> None:
        st = self.state
        command = EgoCommand(0.0, 0.0, 0.0)
        ego = self.program.ego[0]
        if ego >= 0:
            path = () if self.control is None else self.control.trajectory
            command = EgoCommand(st.command_throttle[ego], st.command_steer[ego], st.command_brake[ego], path)
        moved = self.world.step(self.snapshot(self.plan.step), command)
        if (moved is not None) != (self.world.moves_ego and ego >= 0):
            returned = "no state" if moved is None else "a state"
            reason = f"its moves_ego is {self.world.moves_ego}" if ego >= 0 else "the plan has no automated vehicle"
            raise TypeError(f"the world {self.world.name} returned {returned} of the ego, but {reason}")
        if moved is not None:
            self._pose_ego(ego, moved)
        for event in self.world.events():
            self.builder.event(event.t, event.kind, entity=event.entity, message=event.message)
            if event.kind == "world_collision":
                ids = [entity.id for entity in self.plan.entities]
                self.simulation.crash(ids.index(event.entity) if event.entity in ids else None)

    def _pose_ego(self, ego: int, moved: EgoState) -> None:
        st = self.state
        self.simulation.pose(ego, moved.pose, moved.speed)
        st.steer[ego], st.throttle[ego], st.brake[ego] = moved.steering, moved.throttle, moved.brake

    @contextmanager
    def _noticing_failures(self) -> Iterator[None]:
        """End the run if the world, the controller or the engine fails, and record the reason as its last event."""
        try:
            yield
        except WorldError as error:
            self._break_off("world_lost", error.code.id, str(error))
        except ControllerError as error:
            self._break_off("controller_failed", error.code.id, str(error))
        except EngineError as error:
            self._break_off("error", ENGINE_BROKE_OFF.id, str(error))

    def _break_off(self, reason: StopReason, code: str, message: str) -> None:
        self.broken = reason
        self._note_events()
        self.builder.event(self.state.clock[0], "broken_off", cause=code, message=message)

    @contextmanager
    def _of_controller(self) -> Iterator[None]:
        """Turn any exception of a controller into a failure of the controller."""
        try:
            yield
        except ControllerError:
            raise
        except (Exception, SystemExit) as error:
            name = "" if self.plan.controller is None else self.plan.controller.model
            raise ControllerError.of(name, error) from error

    def snapshot(self, moved_for: float = 0.0) -> Snapshot:
        """Return the present states of the entities, `moved_for` s after the end of the last step."""
        st = self.state
        return Snapshot(
            st.clock[0],
            st.frame[0],
            entities_of(st, moved_for),
            st.sigma[0],
            faults_of(self.program, st),
            weather_of(st.weather) if self.weather_changes else None,
            self._signals(),
            st.hazard_lights[0] == 1,
        )

    def _signals(self) -> tuple[tuple[str, str], ...]:
        """Return the state of each traffic signal that the scenario names."""
        texts = self.lowered.texts
        states = zip(self.lowered.signals, self.state.signal_state, strict=True)
        return tuple((name, texts[state] if state >= 0 else "") for name, state in states)

    def note(self, kind: EventKind, *, cause: str = "", message: str = "") -> None:
        """Record an event that does not come from the engine."""
        self.builder.event(self.state.clock[0], kind, cause=cause, message=message)

    def finish(self, ended: StopReason = "") -> Recording:
        """Return the recording; `ended` is the reason if the run was ended from outside."""
        st = self.state
        reason = self.broken or STOP_REASONS[st.stop[0]] or ended
        if st.flag[0]:
            at = st.flag_at[0]
            ids = [entity.id for entity in self.plan.entities]
            values = {name: getattr(st, name)[at] for name in QUANTITIES} if 0 <= at < len(ids) else {}
            why = break_off_text(st.flag[0], at, ids, values, st.clock[0])
            entity = ids[at] if st.flag[0] in OF_ENTITIES and 0 <= at < len(ids) else ""
            self.builder.event(st.clock[0], "broken_off", entity=entity, cause=BROKE_OFF.id, message=why)
        self.builder.event(st.clock[0], "stop", message=reason)
        return self.builder.finish(reason, st.flag[0])

    def _let_control(self, controller: ControllerModel) -> None:
        from scenario_compiler.controllers.data import VehicleState  # a run without a controller does without it

        st, ego = self.state, self.plan.ego.vehicle
        outlook = self.simulation.look_out()
        seen = self.seen
        if seen is None or st.frame[0] % self.program.image_every[0] == 0:
            seen = self.world.observe(self.snapshot())
        self.seen = seen = replace(
            seen,
            lead_gap=None if outlook.gap >= op.FAR else outlook.gap,
            lead_speed=0.0 if outlook.gap >= op.FAR else outlook.lead_speed,
            route=outlook.way,
            route_widths=outlook.widths,
            route_heights=outlook.heights,
            route_banks=outlook.banks,
            junction=None if outlook.junction >= op.FAR else outlook.junction,
            bend_speed=math.inf if outlook.bend_speed >= op.FAR else outlook.bend_speed,
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
        with self._of_controller():
            control = controller.control(seen, st.v[0], vehicle)
            asks = int(controller.initiate_takeover())
        self.control = control
        st.auto_throttle[0], st.auto_steer[0], st.auto_brake[0] = control.throttle, control.steer, control.brake
        st.conf_left[0], st.conf_right[0] = control.confidence_left, control.confidence_right
        st.health[0] = control.sensor_health
        st.auto_request[0] = asks
        lanes = control.lanes
        seen_lanes = {} if lanes is None else {"left": lanes.left.as_parabola(), "right": lanes.right.as_parabola()}
        for column in LANE_COLUMNS:
            side, _, name = column.partition("_")
            self.lanes[column][0] = getattr(seen_lanes.get(side), name, math.nan)

    def _note_events(self) -> None:
        """Record the events that the engine has logged since the last call, and the messages to the driver."""
        for told in self.messenger.come(self.state.clock[0]):
            self.builder.add(told)
        for row in self.log.news(self.state):
            self.builder.add(row)
            for told in self.messenger.heed(row):
                self.builder.add(told)
            self._picture(row.t, row.kind, row.cause)

    def _header(self, seed: int, variant: int) -> Header:
        return Header.model_construct(
            plan_digest=self.plan.digest,
            plan_name=self.plan.name,
            seed=seed,
            variant=variant,
            parameters=parameter_values(self.plan.parameters),
            avoided=self._avoided(seed, variant),
            step=self.plan.step,
            entities=tuple(entity.id for entity in self.plan.entities),
            perception=self.plan.perception,
            world=self.world.name,
            choices=dict(getattr(self.world, "choices", {})),
            versions={**versions(), **self.world.versions},
            processor=processor(),
        )

    def _avoided(self, seed: int, variant: int) -> dict[ReferenceName, bool]:
        """Return whether each reference driver that a criterion names has no collision."""
        names = references_in(self.plan.criteria)
        if not names:
            return {}
        network, limit = self.world.network, self.plan.step_limit
        program = build_program(self.plan, network)
        rows, draws = [list(program.const)], [make_draws(seed, variant)]
        return {name: avoided_by(name, network.tables, program, rows, draws, limit)[0] for name in names}

    def _columns(self) -> dict[str, list[float] | list[int]]:
        """Return the live columns of the engine's state that are recorded."""
        st = self.state
        columns: dict[str, list[float] | list[int]] = {name: getattr(st, name) for name in ENTITY_COLUMNS}
        if self.plan.controller is not None:
            columns |= {name: getattr(st, column) for name, column in RUN_COLUMNS.items()}
            columns |= {"control": self.source}
            if self.program.person[0] == 1:
                columns |= {name: getattr(st, name) for name in PERSON_COLUMNS}
        return columns | self.lanes

    def _picture(self, t: float, kind: str, cause: str) -> None:
        """Keep the first picture of each kind of event that reports show, but none once the run has broken off."""
        if self.broken or self.seen is None or self.control is None or self.controller is None:
            return
        if kind not in MOMENTS or kind in self.pictured:
            return
        self.pictured.add(kind)
        view = self.world.picture(self.snapshot())
        speed = self.state.v[0]
        png = picture_of(self.plan, view, self.seen, self.controller, self.control, speed, kind, cause)
        self.builder.frame(t, kind, png)
