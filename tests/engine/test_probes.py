"""Scripted motion and the storyboard against trajectories recorded from esmini 3.6, one action an entity."""

from __future__ import annotations

import csv
import gzip
from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine import slots
from scenario_compiler.engine.state import State, new_state
from scenario_compiler.engine.step import reset, step
from scenario_compiler.roads import load_network
from tests.engine.make import Draft

SHAPES = {"linear": op.SHAPE_LINEAR, "sinusoidal": op.SHAPE_SINUSOIDAL, "cubic": op.SHAPE_CUBIC, "step": op.SHAPE_STEP}
DIMENSIONS = {"time": op.DIMENSION_TIME, "rate": op.DIMENSION_RATE, "distance": op.DIMENSION_DISTANCE}
EDGES = {"none": op.EDGE_NONE, "rising": op.EDGE_RISING}
RULES = {"greaterOrEqual": op.RULE_GREATER_OR_EQUAL, "greaterThan": op.RULE_GREATER}
PRIORITIES = {"overwrite": op.PRIORITY_OVERRIDE, "skip": op.PRIORITY_SKIP, "parallel": op.PRIORITY_PARALLEL}

ENGINE_HAS_NO_WORD = {"N_lo_sin_acc1", "O_lo_cub_acc1", "S_lc_off05", "U3_chain_start"}
"""Probes of lane offsets, of a lane change to an offset, and of a condition on a start transition."""

CAR = (5.0, 2.0, 1.5, 3.1, 1.4, 0.5, 10.0, 10.0, 70.0)


class Probes:
    """The probes' file as a program."""

    def __init__(self, folder: Path, dt: float) -> None:
        root = etree.parse(str(folder / "probes.xosc")).getroot()
        network = load_network(folder / "hw20k.xodr", cache=False)
        assert network is not None
        self.draft = Draft(network, {slots.K_STEP: dt, slots.K_DURATION: 60.0})
        self.names: list[str] = []
        self.lanes: list[int] = []
        for private in root.iterfind(".//Init/Actions/Private"):
            self.entity(private)
        act = self.draft.element(op.ELEMENT_ACT, self.draft.element(op.ELEMENT_STORY))
        self.events: dict[str, int] = {}
        self.waiting: list[tuple[int, str]] = []
        for group in root.iterfind(".//ManeuverGroup"):
            if str(group.get("name"))[3:] not in ENGINE_HAS_NO_WORD:
                self.group(group, act)
        for condition, event in self.waiting:
            self.draft.program.condition_other[condition] = self.events[event]
        self.draft.program.stop_trigger[0] = self.draft.at_time(12.0, rule=op.RULE_GREATER)

    def entity(self, private: etree._Element) -> None:
        """Append an entity with its place and speed of the init."""
        place = private.find(".//LanePosition")
        speed = private.find(".//AbsoluteTargetSpeed")
        assert place is not None
        lane = int(str(place.get("laneId")))
        at = self.draft.position(0, lane, float(str(place.get("s"))), float(place.get("offset", "0")))
        value = 0.0 if speed is None else float(str(speed.get("value")))
        self.draft.entity(op.MOTION_SCRIPTED, at, value, car=CAR)
        self.names.append(str(private.get("entityRef")))
        self.lanes.append(lane)

    def group(self, group: etree._Element, act: int) -> None:
        """Append an entity's events."""
        entity = self.names.index(str(group.get("name"))[3:])
        maneuver = self.draft.element(op.ELEMENT_MANEUVER, self.draft.element(op.ELEMENT_GROUP, act))
        for event in group.iterfind(".//Event"):
            condition = next(event.iterfind(".//Condition"))
            start = self.trigger(condition)
            actions = [self.action(action, entity) for action in event.iterfind("Action")]
            priority = PRIORITIES[str(event.get("priority"))]
            self.events[str(event.get("name"))] = self.draft.event(maneuver, start, *actions, priority=priority)

    def trigger(self, condition: etree._Element) -> int:
        """Append the trigger of an event."""
        time = condition.find(".//SimulationTimeCondition")
        if time is None:
            watched = condition.find(".//StoryboardElementStateCondition")
            assert watched is not None
            row = self.draft.condition(op.CONDITION_ELEMENT_STATE, 1.0 * op.COMPLETE, rule=op.RULE_EQUAL)
            self.waiting.append((row, str(watched.get("storyboardElementRef"))))
            return self.draft.trigger()
        return self.draft.at_time(
            float(str(time.get("value"))),
            rule=RULES[str(time.get("rule"))],
            edge=EDGES[str(condition.get("conditionEdge"))],
            delay=float(str(condition.get("delay"))),
        )

    def action(self, action: etree._Element, entity: int) -> int:
        """Append an action."""
        speed = action.find(".//SpeedAction")
        dynamics = next(e for e in action.iter() if str(e.tag).endswith("Dynamics"))
        value = float(str(dynamics.get("value")))
        how = {
            "shape": SHAPES[str(dynamics.get("dynamicsShape"))],
            "dimension": DIMENSIONS[str(dynamics.get("dynamicsDimension"))],
        }
        if speed is not None:
            target = next(action.iter("AbsoluteTargetSpeed"))
            return self.draft.speed(entity, float(str(target.get("value"))), value, **how)
        target = next(action.iter("AbsoluteTargetLane"))
        return self.draft.lane_change(entity, int(str(target.get("value"))) - self.lanes[entity], value, **how)


@pytest.mark.parametrize(("file", "dt"), [("dt050.csv.gz", 0.05), ("dt010.csv.gz", 0.01)])
def test_the_probes_are_reproduced_to_the_last_printed_digit(golden: Path, file: str, dt: float) -> None:
    probes = Probes(golden / "esmini_probes", dt)
    program, n = probes.draft.done(), probes.draft.network.tables
    state = new_state(program)
    with gzip.open(golden / "esmini_probes" / file, "rt", encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    entities = len({row["name"] for row in rows})
    reset(n, program, state)
    worst: dict[str, float] = {}
    for first in range(0, len(rows), entities):
        if first:
            assert step(n, program, state) == 1, f"stopped before row {first // entities}"
        for row in rows[first : first + entities]:
            name, i = row["name"], probes.names.index(row["name"])
            if name not in ENGINE_HAS_NO_WORD:
                worst[name] = max(worst.get(name, 0.0), deviation(row, state, i))
    assert step(n, program, state) == 0
    assert state.stop[0] == op.STOP_TRIGGER
    assert {name: size for name, size in worst.items() if size > 1.0} == {}


def deviation(row: dict[str, str], st: State, i: int) -> float:
    """Return the largest difference of a row, in units of twice the last printed digit.

    A point on the border of two lanes (half of 3.5 m from either centre) may be reported in either.
    """
    off = float(row["off"])
    border = abs(abs(off) - 1.75) < 0.0005 and abs(abs(st.off[i]) - 1.75) < 0.0005
    return max(
        abs(st.x[i] - float(row["x"])) / 0.002,
        abs(st.y[i] - float(row["y"])) / 0.002,
        abs((st.h[i] - float(row["h"]) + 3.0) % 6.283185307179586 - 3.0) / 0.00002,
        abs(st.v[i] - float(row["v"])) / 0.0002,
        0.0 if border else 2.0 * abs(st.lane[i] - int(row["lane"])),
        abs(st.s[i] - float(row["s"])) / 0.002,
        0.0 if border else abs(st.off[i] - off) / 0.0002,
    )
