"""The storyboard: triggers, and the states of stories, acts, groups, maneuvers, events and actions.

A frame has two passes. `run_triggers` visits the elements in document order, parents before children, on the states
before the step; actions that start there have an effect in the same frame. `run_actions` (in `running`) advances the
running actions and calls `action_done`, which completes parents at once. A transition leaves a mark, by which
conditions see it for one frame (see `conditions`): in a pass of triggers the mark is twice the frame plus one, while
actions are executed it is twice the next frame. After esmini 3.6.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import HOLDS_LANE, HOLDS_SPEED
from scenario_compiler.engine.moves.table import ENDS, HOLDS
from scenario_compiler.engine.story.acting import end_action, start_action
from scenario_compiler.engine.story.conditions import condition_fires
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def trigger_fires(n: RoadTables, p: Program, st: State, trigger: int) -> int:
    """Return 1 if all conditions of any group of a trigger fire; a trigger without groups never fires.

    All groups are evaluated. After a false condition, the following ones of its group are not evaluated unless they
    have a delay, so their memory of edges becomes outdated (esmini 3.6). A trigger that fires forgets the previous
    values of its conditions.
    """
    fires = 0
    for g in range(p.trigger_first[trigger], p.trigger_first[trigger + 1]):
        all_fire = 1
        for c in range(p.group_first[g], p.group_first[g + 1]):
            if (all_fire == 1 or p.condition_ring[c] >= 0) and condition_fires(n, p, st, c) == 0:
                all_fire = 0
        if all_fire == 1:
            fires = 1
    if fires == 1:
        forget_edges(p, st, trigger)
    return fires


@compiled
def forget_edges(p: Program, st: State, trigger: int) -> None:
    """Make the conditions of a trigger forget their previous values, so that an edge needs two evaluations again."""
    last = p.group_first[p.trigger_first[trigger + 1]]
    for c in range(p.group_first[p.trigger_first[trigger]], last):
        st.condition_before[c] = op.NONE


@compiled
def forget_records(p: Program, st: State, trigger: int) -> None:
    """Make the conditions of a trigger forget the records for their delays."""
    last = p.group_first[p.trigger_first[trigger + 1]]
    for c in range(p.group_first[p.trigger_first[trigger]], last):
        if p.condition_ring[c] >= 0:
            st.ring_size[p.condition_ring[c]] = 0


@compiled
def start_element(st: State, e: int, mark: int) -> None:
    """Set an element to running."""
    st.element_state[e] = op.RUNNING
    st.element_runs[e] += 1
    st.element_started[e] = mark


@compiled
def stop_below(p: Program, st: State, e: int, mark: int) -> None:
    """Stop an element and all below it that are running, including actions, or are events in standby.

    "Transition between the running or standby states to the complete state" (stopTransition, ASAM OpenSCENARIO). What
    is below an element that is itself in standby has not been started, so it makes no transition.
    """
    executing = st.element_state[e] == op.RUNNING
    st.element_stopped[e] = mark
    for k in range(e, p.element_end[e]):
        if executing and st.element_state[k] == op.STANDBY and p.element_kind[k] == op.ELEMENT_EVENT:
            st.element_stopped[k] = mark
        if st.element_state[k] == op.RUNNING:
            st.element_stopped[k] = mark
            if p.element_kind[k] == op.ELEMENT_EVENT:
                st.element_busy[p.element_parent[k]] -= 1
            if p.element_kind[k] == op.ELEMENT_ACTION and p.element_action[k] >= 0:
                end_action(p, st, p.element_action[k])
        st.element_state[k] = op.COMPLETE


@compiled
def rest_below(p: Program, st: State, e: int) -> None:
    """Set everything below an element to standby without executions, for its next execution.

    The delays of its own trigger and of those below start again: an execution does not depend on the previous one.
    """
    for k in range(e, p.element_end[e]):
        if p.element_start[k] >= 0:
            forget_records(p, st, p.element_start[k])
        if k > e:
            st.element_state[k] = op.STANDBY
            st.element_runs[k] = 0


@compiled
def children_complete(p: Program, st: State, e: int) -> int:
    """Return 1 if all children of an element are complete."""
    k = e + 1
    while k < p.element_end[e]:
        if st.element_state[k] != op.COMPLETE:
            return 0
        k = p.element_end[k]
    return 1


@compiled
def parent_done(p: Program, st: State, e: int) -> int:
    """Return the running parent of a complete element if all children of the parent are complete, else NONE."""
    parent = p.element_parent[e]
    if parent < 0 or st.element_state[parent] != op.RUNNING:
        return op.NONE
    after = p.element_end[e]
    if after < p.element_end[parent] and st.element_state[after] != op.COMPLETE:
        return op.NONE
    return parent if children_complete(p, st, parent) == 1 else op.NONE


@compiled
def complete_element(p: Program, st: State, e: int, mark: int) -> None:
    """End an element, and then each parent whose children are all complete.

    An event or group with executions left returns to standby instead.
    """
    at = e
    while at >= 0:
        st.element_ended[at] = mark
        kind = p.element_kind[at]
        if kind == op.ELEMENT_EVENT:
            st.element_busy[p.element_parent[at]] -= 1
            log_event(st, op.EVENT_STORYBOARD_END, 1.0 * at)
        again = kind in (op.ELEMENT_EVENT, op.ELEMENT_GROUP)
        if again and st.element_runs[at] < p.element_limit[at]:
            st.element_state[at] = op.STANDBY
            rest_below(p, st, at)
            return
        st.element_state[at] = op.COMPLETE
        at = parent_done(p, st, at)


@compiled
def action_done(p: Program, st: State, k: int, mark: int) -> None:
    """End an action of the story or the init, and complete its element and parents."""
    end_action(p, st, k)
    e = st.action_element[k]
    if e >= 0 and st.element_state[e] == op.RUNNING:
        complete_element(p, st, e, mark)


@compiled
def take_over(p: Program, st: State, k: int, mark: int) -> None:
    """End an action because another one takes over: it is stopped, and, as in esmini 3.6, also at its end."""
    e = st.action_element[k]
    if e >= 0:
        st.element_stopped[e] = mark
    action_done(p, st, k, mark)


@compiled
def domains_of(p: Program, k: int) -> int:
    """Return the domains of its entity's motion that action k controls, as bits."""
    holds = HOLDS[p.action_op[k]]
    if p.action_flags[k] & op.FLAG_TIMED != 0:
        holds = holds | HOLDS_SPEED
    return holds


@compiled
def displace(p: Program, st: State, k: int, mark: int) -> None:
    """End the actions that control the domains (speed, lane) that action k takes over from its entity.

    All actions of the init make one state: there, mark 0, only an action on the same domains takes over.
    """
    i = p.action_entity[k]
    holds = domains_of(p, k)
    takes = holds
    if mark > 0:
        takes = takes | ENDS[p.action_op[k]]
        if i < 0 and takes != 0:
            i = p.action_other[k]
    if i < 0:
        return
    older = st.longitudinal[i]
    if takes & HOLDS_SPEED != 0 and older >= 0 and older != k and (mark > 0 or domains_of(p, older) == holds):
        take_over(p, st, older, mark)
    older = st.lateral[i]
    if takes & HOLDS_LANE == 0 or older < 0 or older == k or older >= p.action_count[0]:
        return
    if mark > 0 or domains_of(p, older) == holds:
        take_over(p, st, older, mark)


@compiled
def start_event(n: RoadTables, p: Program, st: State, e: int, mark: int) -> None:
    """Start an event and its actions in order; each of them ends the actions that control its entity's domains."""
    start_element(st, e, mark)
    st.element_busy[p.element_parent[e]] += 1
    log_event(st, op.EVENT_STORYBOARD_START, 1.0 * e)
    for c in range(e + 1, p.element_end[e]):
        start_element(st, c, mark)
        k = p.element_action[c]
        if k >= 0:
            displace(p, st, k, mark)
            start_action(n, p, st, k, c)


@compiled
def child_at(p: Program, parent: int, e: int) -> int:
    """Return the child of `parent` whose subtree contains element e."""
    at = e
    while p.element_parent[at] != parent:
        at = p.element_parent[at]
    return at


@compiled
def stop_siblings(p: Program, st: State, e: int, mark: int) -> None:
    """Stop the other running events of the same maneuver, without the executions that they have left.

    The search goes backwards from the event and then forwards, because usually the previous event is the running one.
    """
    parent = p.element_parent[e]
    k = e - 1
    while k > parent and st.element_busy[parent] > 0:
        k = child_at(p, parent, k)
        if st.element_state[k] == op.RUNNING:
            stop_below(p, st, k, mark)
        k = k - 1
    k = p.element_end[e]
    while k < p.element_end[parent] and st.element_busy[parent] > 0:
        if st.element_state[k] == op.RUNNING:
            stop_below(p, st, k, mark)
        k = p.element_end[k]


@compiled
def try_event(n: RoadTables, p: Program, st: State, e: int, mark: int) -> None:
    """Start an event in standby if its trigger fires and its priority allows it."""
    trigger = p.element_start[e]
    if trigger >= 0 and trigger_fires(n, p, st, trigger) == 0:
        return
    priority = p.element_priority[e]
    if priority == op.PRIORITY_SKIP and st.element_busy[p.element_parent[e]] > 0:
        st.element_skipped[e] = mark
        return
    if priority == op.PRIORITY_OVERRIDE:
        stop_siblings(p, st, e, mark)
    start_event(n, p, st, e, mark)
    if p.element_end[e] == e + 1:
        complete_element(p, st, e, mark)


@compiled
def try_stop(n: RoadTables, p: Program, st: State, e: int, mark: int) -> None:
    """Stop an act, running or in standby, if its stop trigger fires.

    This counts as an end of the act too (esmini 3.6): conditions see both transitions.
    """
    if trigger_fires(n, p, st, p.element_stop[e]) == 0:
        return
    stop_below(p, st, e, mark)
    st.element_ended[e] = mark
    parent = parent_done(p, st, e)
    if parent >= 0:
        complete_element(p, st, parent, mark)


@compiled
def run_triggers(n: RoadTables, p: Program, st: State) -> None:
    """Visit all elements in document order, except those below an element that does not run.

    An element without a start trigger runs as soon as its parent does, and one without children is complete as soon as
    it runs: "a ManeuverGroup is executed by running its nested Maneuver instances (0..*)" (Execution, ASAM
    OpenSCENARIO). A stop trigger is evaluated from the frame after
    the one in which the start trigger has fired (esmini 3.6). It also stops an act that still waits for its start.
    """
    e = 0
    mark = 2 * st.frame[0] + 1
    st.acting[0] = 0
    count = p.element_count[0]
    while e < count:
        kind = p.element_kind[e]
        if st.element_state[e] == op.STANDBY and kind != op.ELEMENT_EVENT and p.element_start[e] < 0:
            start_element(st, e, mark)
        if st.element_state[e] == op.RUNNING:
            if p.element_stop[e] >= 0:
                try_stop(n, p, st, e, mark)
        elif st.element_state[e] == op.STANDBY:
            if kind == op.ELEMENT_EVENT:
                try_event(n, p, st, e, mark)
            elif trigger_fires(n, p, st, p.element_start[e]) == 1:
                start_element(st, e, mark)
            elif p.element_stop[e] >= 0:
                try_stop(n, p, st, e, mark)
        if st.element_state[e] == op.RUNNING and p.element_end[e] == e + 1 and kind != op.ELEMENT_EVENT:
            complete_element(p, st, e, mark)
        state = st.element_state[e]
        if state != op.RUNNING:
            e = p.element_end[e]
        elif kind == op.ELEMENT_EVENT:
            st.acting[0] = 1
            e = p.element_end[e]
        else:
            e = e + 1
