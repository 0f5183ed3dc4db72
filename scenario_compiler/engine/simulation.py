"""`Simulation`: the one way to run a program, in whichever form of the engine there is."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import STEER_RATE, State, new_state
from scenario_compiler.engine.columns.totals import SUMMARY_SIZE, Totals
from scenario_compiler.engine.columns.trace import trace_width
from scenario_compiler.engine.columns.view import SIDE_SIZE, V_BOTH
from scenario_compiler.engine.program.entities import vehicle_numbers
from scenario_compiler.forms.declaration import at_start
from scenario_compiler.forms.form import form_of
from scenario_compiler.forms.machine_code import MachineCode
from scenario_compiler.roads.positions import Pose
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.vocabulary.entities import Vehicle

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

CONTACTS = 1024
"""Pairs of entities in contact that are found at most."""


@dataclass(frozen=True, slots=True)
class Outlook:
    """The road ahead of the ego.

    Attributes:
        gap: Distance from the front bumper to the leader that the forward sensor sees, m; FAR without one.
        lead_speed: Its speed along the way, m/s.
        junction: Distance along the way to the next junction, m; FAR where there is none in reach.
        way: Points of the planned way 1 m apart, (x ahead, y left) of the reference point, m.
    """

    gap: float
    lead_speed: float
    junction: float
    way: tuple[tuple[float, float], ...]


class Simulation:
    """A program that is run, once or many times.

    Attributes:
        form: The form of the engine that runs it.
        program: The program as that form has it, lists or arrays; a sweep writes its numbers.
        state: The state now.
    """

    def __init__(
        self,
        tables: RoadTables,
        program: Program,
        *,
        interpreted: bool = False,
        machine_code: MachineCode | None = None,
    ) -> None:
        """Prepare a program, for the compiled form or, where there is no machine code, for the interpreted one.

        Args:
            tables: The roads.
            program: The program.
            interpreted: Whether the interpreted form is asked for.
            machine_code: The library to use in place of the package's own.
        """
        self.form = form_of(
            "scenario_compiler.engine.entries",
            interpreted=interpreted,
            machine_code=machine_code,
            n=tables,
            p=program,
            st=new_state(program),
            m=at_start(Totals, program),
        )
        self.program: Program = self.form.containers["p"]
        self.state: State = self.form.containers["st"]
        self._width = trace_width(program)
        self._trace: Any = None

    def reset(self, draws: Sequence[float]) -> None:
        """Put the state to the row of t = 0; `draws` are DRAWS_PER_RUN numbers (see `make_draws`)."""
        for k, value in enumerate(draws):
            self.state.draw[k] = value
        self.form.enter("reset")

    @property
    def over(self) -> bool:
        """Whether the run has ended."""
        return self.state.stop[0] != op.STOP_NONE

    def begin(self) -> bool:
        """Begin a step: the storyboard, and at control steps the ego's commands; return False where the run is over.

        After it, `move` and `end` make the step's row.
        """
        return bool(self.form.enter("begin_step"))

    def move(self) -> None:
        """Move time and all that the engine moves; a vehicle that is posed from outside is posed after this."""
        self.form.enter("move_step")

    def end(self) -> None:
        """Take stock of where all are now: places on the road, collisions, and whether this row is the last."""
        self.form.enter("end_step")

    def step(self) -> bool:
        """Do a whole step; return False where the run was over before it."""
        return bool(self.form.enter("step"))

    def set_step(self, step: float) -> None:
        """Set the length of the time steps from the next one on, s."""
        self.program.const[slot.K_STEP] = step

    def spawn(
        self,
        entity: int,
        vehicle: Vehicle,
        pose: Pose,
        speed: float = 0.0,
        *,
        posed: bool = False,
        steer_rate: float = STEER_RATE,
    ) -> None:
        """Let an entity appear as a vehicle, at the height and the slope of the road where it stands on one.

        Args:
            entity: Its number; what was there in its place is gone.
            vehicle: What it is from now on.
            pose: Pose of its reference point, OpenDRIVE axes.
            speed: Its speed, m/s.
            posed: Whether it is moved by `pose`, not by commands.
            steer_rate: Greatest rate of its front wheels' angle, rad/s.
        """
        program = self.program
        block = program.entity_const[entity]
        for k, number in enumerate(vehicle_numbers(vehicle)):
            program.const[block + k] = number
        self.let_pose(entity, posed=posed)
        self.state.steer_rate[entity] = steer_rate
        self.form.enter("spawn_entity", entity, pose.x, pose.y, pose.z, pose.heading, speed)

    def let_pose(self, entity: int, *, posed: bool) -> None:
        """Say whether a spawned entity is moved by `pose` or by commands."""
        self.program.entity_motion[entity] = op.MOTION_POSED if posed else op.MOTION_BICYCLE

    def remove(self, entity: int) -> None:
        """Let an entity disappear; one that is not there stays so."""
        self.form.enter("delete_entity", entity)

    def command(self, entity: int, throttle: float, steer: float, brake: float, *, reverse: bool = False) -> None:
        """Drive a vehicle, until the next command.

        Args:
            entity: Its number.
            throttle: 0 to 1.
            steer: -1 to 1 of its greatest steering angle, positive to the left.
            brake: 0 to 1.
            reverse: Whether the throttle drives it backwards.
        """
        st = self.state
        st.command_throttle[entity], st.command_steer[entity] = throttle, steer
        st.command_brake[entity], st.command_reverse[entity] = brake, int(reverse)

    def pose(self, entity: int, pose: Pose, speed: float) -> None:
        """Put an entity to a pose of its reference point, between `move` and `end`; `end` finds the road below it."""
        st = self.state
        st.x[entity], st.y[entity], st.z[entity] = pose.x, pose.y, pose.z
        st.h[entity], st.pitch[entity], st.roll[entity] = pose.heading % math.tau, pose.pitch, pose.roll
        st.v[entity] = speed

    def column(self, name: str) -> NDArray[Any]:
        """Return a column of the state as an array that cannot be written: float64 or int64.

        What it holds is of this moment in the interpreted form; in the compiled form it goes with the run.
        """
        import numpy as np

        values = getattr(self.state, name)
        made = np.frombuffer(values, np.dtype(values.typecode)) if isinstance(values, array) else np.array(values)
        made.flags.writeable = False
        return made

    def touched(self, entity: int) -> int | None:
        """Return an entity whose box overlaps that of another at their present poses, or None."""
        found: int = self.form.enter("find_touched", entity)
        return None if found == op.NONE else found

    def contacts(self) -> list[tuple[int, int]]:
        """Return the pairs of entities whose boxes overlap, lower number first, each pair once."""
        pairs = array("q", bytes(16 * CONTACTS))
        count = self.form.enter("find_contacts", pairs)
        return sorted(zip(pairs[0 : 2 * count : 2], pairs[1 : 2 * count : 2], strict=True))

    def look_out(self) -> Outlook:
        """Return what lies ahead of the ego, as its controller gets it."""
        out = array("d", bytes(8 * op.OUTLOOK_SIZE))
        count = self.form.enter("look_out", out)
        points = tuple(zip(out[op.OUTLOOK_HEAD :: 2][:count], out[op.OUTLOOK_HEAD + 1 :: 2][:count], strict=True))
        return Outlook(out[0], out[1], out[2], points)

    def look_at_view(self) -> NDArray[np.float64] | None:
        """Return what surrogate perception would go by, (2, VIEW_SIZE), as the network takes it for the left and right.

        None where the ego is on no lane.
        """
        import numpy as np

        if not self.form.enter("look_at_view"):
            return None
        left, right, both = np.split(self.column("view").astype(float), [SIDE_SIZE, V_BOTH])
        return np.stack([np.concatenate([left, right, both]), np.concatenate([right, left, both])])

    def sweep(
        self,
        rows: Sequence[Sequence[float]] | NDArray[np.float64],
        draws: Sequence[Sequence[float]] | NDArray[np.float64],
        limit: int,
        trace_rows: int = 0,
        every: int = 1,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Run many variants of the program.

        Args:
            rows: The numbers of each variant, (variants, len(Program.const)).
            draws: The draws of each, (variants, DRAWS_PER_RUN).
            limit: Steps that a run has at most.
            trace_rows: Rows that a trace has room for; 0 for no traces.
            every: Steps from one row of a trace to the next.

        Returns:
            The summaries, (variants, SUMMARY_SIZE), and the traces, (variants, trace_rows * trace_width). The traces'
            memory is used again by the next call and is not cleared: only a run's own rows count.

        Raises:
            EngineError: The engine's arithmetic had no result.
        """
        import numpy as np

        count = len(rows)
        numbers = np.ascontiguousarray(rows, dtype=np.float64).reshape(-1)
        drawn = np.ascontiguousarray(draws, dtype=np.float64).reshape(-1)
        if numbers.size != count * len(self.program.const) or drawn.size != count * op.DRAWS_PER_RUN:
            raise ValueError("rows or draws do not have the width of the program")
        stride = trace_rows * self._width
        out = np.zeros(count * SUMMARY_SIZE)
        if self._trace is None or self._trace.size < count * stride:
            self._trace = np.zeros(max(count * stride, 1))
        trace = self._trace
        steps = every if trace_rows else 0
        self.form.enter("sweep", count, numbers, drawn, limit, trace, stride, steps, out)
        return out.reshape(count, SUMMARY_SIZE), trace[: count * stride].reshape(count, stride)
