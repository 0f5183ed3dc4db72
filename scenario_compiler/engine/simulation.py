"""`Simulation`: the one way to run a program, in whichever form of the engine there is."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State, new_state
from scenario_compiler.engine.columns.totals import SUMMARY_SIZE, Totals
from scenario_compiler.engine.columns.trace import trace_width
from scenario_compiler.forms.declaration import at_start
from scenario_compiler.forms.form import form_of
from scenario_compiler.forms.machine_code import MachineCode
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Outlook:
    """What lies ahead of the ego.

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

    def look_out(self) -> Outlook:
        """Return what lies ahead of the ego, as its controller gets it."""
        out = array("d", bytes(8 * op.OUTLOOK_SIZE))
        count = self.form.enter("look_out", out)
        points = tuple(zip(out[op.OUTLOOK_HEAD :: 2][:count], out[op.OUTLOOK_HEAD + 1 :: 2][:count], strict=True))
        return Outlook(out[0], out[1], out[2], points)

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
