"""`Simulation`: the one way to run a program, in either form of the engine."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

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
"""Greatest number of pairs of entities in contact that are found."""


class Outlook(NamedTuple):
    """The road ahead of the ego.

    Attributes:
        gap: Distance from the front bumper to the leader that the forward sensor sees, m; FAR if there is none.
        lead_speed: Its speed along the route, m/s.
        junction: Distance along the route to the next junction, m; FAR if there is none in reach.
        bend_speed: Greatest speed from which comfortable braking suffices for the bends ahead, m/s; FAR if none
            limits it.
        way: Points of the planned route, 1 m apart, as (x ahead, y left) of the reference point, m.
        widths: Width of the lane at each of them, m.
        heights: Height of each above the plane of the road at the first, m.
        banks: By how much the road rises to the left there per metre, against that plane.
    """

    gap: float
    lead_speed: float
    junction: float
    bend_speed: float
    way: tuple[tuple[float, float], ...]
    widths: tuple[float, ...]
    heights: tuple[float, ...]
    banks: tuple[float, ...]


class Simulation:
    """A program that is run once or many times.

    Attributes:
        form: The form of the engine that runs it.
        program: The program in that form, with lists or arrays; a sweep overwrites its numbers.
        state: The present state.
    """

    def __init__(
        self,
        tables: RoadTables,
        program: Program,
        *,
        interpreted: bool = False,
        machine_code: MachineCode | None = None,
    ) -> None:
        """Prepare a program for the compiled form, or for the interpreted one if there is no machine code.

        Args:
            tables: The roads.
            program: The program.
            interpreted: Whether to use the interpreted form in any case.
            machine_code: A library to use instead of the packaged one.
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
        """Set the state to the row of t = 0; `draws` are DRAWS_PER_RUN numbers (see `make_draws`).

        Raises:
            ValueError: There are more or fewer draws.
        """
        if len(draws) != op.DRAWS_PER_RUN:
            raise ValueError(f"a run needs {op.DRAWS_PER_RUN} draws, not {len(draws)}")
        for k, value in enumerate(draws):
            self.state.draw[k] = value
        self.form.enter("reset")

    @property
    def over(self) -> bool:
        """Whether the run has ended."""
        return self.state.stop[0] != op.STOP_NONE

    def begin(self) -> bool:
        """Begin a step: the storyboard, and at control steps the ego's commands; return False if the run is over.

        `move` and `end` then complete the step's row.
        """
        return bool(self.form.enter("begin_step"))

    def move(self) -> None:
        """Advance time and all that the engine moves; a vehicle that is posed from outside is posed after this."""
        self.form.enter("move_step")

    def end(self) -> None:
        """Take stock after all have moved: road positions, collisions, and whether this row is the last."""
        self.form.enter("end_step")

    def step(self) -> bool:
        """Do a whole step; return False if the run was over before it."""
        return bool(self.form.enter("step"))

    def set_step(self, step: float) -> None:
        """Set the length of the time steps from the next one on, s.

        The column `clock` is the number of steps times this length, so a host with steps of several lengths keeps the
        time itself.
        """
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
        """Let an entity appear as a vehicle, at the height and slope of the road if it stands on one.

        Args:
            entity: Its index; an entity that was there before is replaced.
            vehicle: The vehicle that it becomes.
            pose: Pose of its reference point, OpenDRIVE axes.
            speed: Its speed, m/s.
            posed: Whether it is moved by `pose` instead of commands.
            steer_rate: Greatest rate of its front wheels' angle, rad/s.

        Raises:
            IndexError: There is no entity with this index; so also `remove`, `command`, `pose`, `touched` and
                `crash`.
        """
        program = self.program
        block = program.entity_const[self._index(entity)]
        for k, number in enumerate(vehicle_numbers(vehicle)):
            program.const[block + k] = number
        self.let_pose(entity, posed=posed)
        self.state.steer_rate[entity] = steer_rate
        self.form.enter("spawn_entity", entity, pose.x, pose.y, pose.z, pose.heading, speed)

    def let_pose(self, entity: int, *, posed: bool) -> None:
        """Set whether a spawned entity is moved by `pose` or by commands."""
        self.program.entity_motion[self._index(entity)] = op.MOTION_POSED if posed else op.MOTION_BICYCLE

    def remove(self, entity: int) -> None:
        """Let an entity disappear; an absent one stays absent."""
        self.form.enter("delete_entity", self._index(entity))

    def command(self, entity: int, throttle: float, steer: float, brake: float, *, reverse: bool = False) -> None:
        """Set the commands of a vehicle, which hold until the next call.

        Args:
            entity: Its index.
            throttle: 0 to 1.
            steer: -1 to 1 of its greatest steering angle, positive to the left.
            brake: 0 to 1.
            reverse: Whether the throttle drives it backwards.
        """
        st, entity = self.state, self._index(entity)
        st.command_throttle[entity], st.command_steer[entity] = throttle, steer
        st.command_brake[entity], st.command_reverse[entity] = brake, int(reverse)

    def pose(self, entity: int, pose: Pose, speed: float) -> None:
        """Set the pose and speed (m/s) of an entity between `move` and `end`; `end` finds its road and lane."""
        st, entity = self.state, self._index(entity)
        st.x[entity], st.y[entity], st.z[entity] = pose.x, pose.y, pose.z
        st.h[entity], st.pitch[entity], st.roll[entity] = pose.heading % math.tau, pose.pitch, pose.roll
        st.v[entity] = speed

    def _index(self, entity: int) -> int:
        """Return an index at which there is an entity; machine code would write beyond its columns at another one."""
        if not 0 <= entity < self.program.entity_count[0]:
            raise IndexError(f"there is no entity {entity}: the program has {self.program.entity_count[0]}")
        return entity

    def column(self, name: str) -> NDArray[Any]:
        """Return a column of the state as a read-only array of float64 or int64.

        In the compiled form it is a view that changes with the run; in the interpreted form it is a copy.
        """
        import numpy as np

        values = getattr(self.state, name)
        made = np.frombuffer(values, np.dtype(values.format)) if isinstance(values, memoryview) else np.array(values)
        made.flags.writeable = False
        return made

    def touched(self, entity: int) -> int | None:
        """Return an entity whose box overlaps that of the given one at the present poses, or None."""
        found: int = self.form.enter("find_touched", self._index(entity))
        return None if found == op.NONE else found

    def crash(self, other: int | None) -> None:
        """Report, between `move` and `end`, a collision that the world's own physics found of the reported vehicle.

        Args:
            other: The other entity; None if it is something of the world that the program does not know.
        """
        self.form.enter("note_world_collision", op.NONE if other is None else self._index(other))

    def contacts(self) -> list[tuple[int, int]]:
        """Return the pairs of entities whose boxes overlap, lower index first, each pair once."""
        pairs = array("q", bytes(16 * CONTACTS))
        count = self.form.enter("find_contacts", pairs)
        return sorted(zip(pairs[0 : 2 * count : 2], pairs[1 : 2 * count : 2], strict=True))

    def look_out(self) -> Outlook:
        """Return the road ahead of the ego, as its controller receives it."""
        out = array("d", bytes(8 * op.OUTLOOK_SIZE))
        count = self.form.enter("look_out", out)
        x, y, *others = (out[op.OUTLOOK_HEAD + k :: op.OUTLOOK_POINT][:count] for k in range(op.OUTLOOK_POINT))
        widths, heights, banks = (tuple(one) for one in others)
        return Outlook(out[0], out[1], out[2], out[3], tuple(zip(x, y, strict=True)), widths, heights, banks)

    def look_at_view(self) -> NDArray[np.float64] | None:
        """Return the features of surrogate perception, (2, VIEW_SIZE), for the left and for the right side.

        None if the ego is on no lane.
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
            draws: The draws of each variant, (variants, DRAWS_PER_RUN).
            limit: Greatest number of steps of a run.
            trace_rows: Greatest number of rows of a trace; 0 for no traces.
            every: Number of steps from one row of a trace to the next.

        Returns:
            The summaries, (variants, SUMMARY_SIZE), and the traces, (variants, trace_rows * trace_width). The memory of
            the traces is used again by the next call and is not cleared; rows beyond the end of a run are invalid.

        Raises:
            EngineError: An arithmetic operation of the engine had no result.
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
