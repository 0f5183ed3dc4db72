"""Makes the program of a whole plan, and the rows of its variants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.program.checking import check_program
from scenario_compiler.engine.program.entities import add_entities
from scenario_compiler.engine.program.plan_builder import PlanBuilder
from scenario_compiler.engine.program.run import add_markings, add_run
from scenario_compiler.engine.program.storyboard import add_init, add_storyboard
from scenario_compiler.engine.program.surrogate import add_surrogate
from scenario_compiler.engine.program.takeover import add_takeover
from scenario_compiler.engine.program.world import add_heads, add_world
from scenario_compiler.expressions import Expression, Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads.network import Network
from scenario_compiler.vocabulary.scenario import parameter_values

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def build_program(plan: Plan, network: Network, *, posed: bool = False) -> Program:
    """Lower a plan, with the default values of its parameters; `posed` leaves the ego's motion to another program.

    Raises:
        KeyError: The plan names a road or entity that does not exist; it was made for another map.
        ValueError: The plan has a word without a row.
        ExpressionError: A number depends on a parameter without a default value.
    """
    return lowered(plan, network, posed=posed).program


class Lowered(NamedTuple):
    """A program, and the names that its indices stand for.

    Attributes:
        program: The program.
        signals: Ids of the traffic signals that the plan names, in the program's order.
        texts: The texts that are compared while it runs, in the program's order.
    """

    program: Program
    signals: tuple[str, ...]
    texts: tuple[str, ...]


def lowered(plan: Plan, network: Network, *, posed: bool = False) -> Lowered:
    """Return the program of a plan with the names of its indices; see `build_program`."""
    draft = _drafted(plan, network, posed=posed)
    draft.program.const = draft.row(parameter_values(plan.parameters))
    draft.program.road_count[0] = len(network.road_ids)
    check_program(draft.program)
    return Lowered(draft.program, tuple(draft.signals), tuple(draft.texts))


class Numbers:
    """The numbers of a plan: those that depend on parameters are evaluated for each variant, the others once."""

    def __init__(self, plan: Plan, network: Network) -> None:
        """Collect the numbers of the plan."""
        numbers = _drafted(plan, network, posed=False).numbers
        self._usual = parameter_values(plan.parameters)
        self._row = [0.0 if isinstance(number, Expression) else float(number) for number in numbers]
        self._open = [(slot, number) for slot, number in enumerate(numbers) if isinstance(number, Expression)]

    def rows(self, samples: Sequence[Mapping[str, Value]]) -> NDArray[np.float64]:
        """Return `Program.const` for samples of the parameters, (samples, numbers); missing ones have their defaults.

        Raises:
            ExpressionError: A number has no value.
        """
        import numpy as np

        values = [{**self._usual, **sample} for sample in samples]
        rows = np.tile(np.array(self._row, dtype=np.float64), (len(samples), 1))
        for slot, number in self._open:
            rows[:, slot] = [number.number(of_sample) for of_sample in values]
        return rows


def _drafted(plan: Plan, network: Network, *, posed: bool) -> PlanBuilder:
    draft = PlanBuilder(plan, network)
    add_run(draft)
    if plan.controller is not None:
        add_takeover(draft)
    add_world(draft)
    add_entities(draft, posed=posed)
    add_markings(draft)
    add_init(draft)
    add_storyboard(draft)
    add_heads(draft)
    if plan.perception == "surrogate":
        add_surrogate(draft)
    return draft
