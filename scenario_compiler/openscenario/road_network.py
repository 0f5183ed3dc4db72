"""<RoadNetwork>: the OpenDRIVE file, and the traffic signal controllers with their phases."""

from __future__ import annotations

from pathlib import PureWindowsPath

from scenario_compiler.markup import names
from scenario_compiler.openscenario.codes import NO_ROAD
from scenario_compiler.openscenario.node import Node
from scenario_compiler.vocabulary.signals import SignalController, SignalPhase, SignalState

OPEN_GROUND = "open_ground"
"""Name of the packaged map without roads."""


def read_map(root: Node) -> str:
    """Return the road file as the scenario names it; if it names none, report it and return the plane without roads."""
    network = root.child("RoadNetwork")
    logic = None if network is None else network.child("LogicFile", "Logics")
    if network is not None:
        for scene in network.children("SceneGraphFile", "SceneGraph", "UsedArea"):
            scene.read_whole()
    if logic is None:
        place = network or root
        place.report(NO_ROAD, "the scenario names no road file (RoadNetwork/LogicFile)")
        return OPEN_GROUND
    written = logic.text("filepath", "").strip()
    if not written:
        logic.report(NO_ROAD, "the name of the road file is empty")
        return OPEN_GROUND
    return PureWindowsPath(written).as_posix() if "\\" in written else written


def read_signal_controllers(root: Node) -> tuple[SignalController, ...]:
    """Return the traffic signal controllers."""
    network = root.child("RoadNetwork")
    signals = [] if network is None else network.children("TrafficSignals")
    found: dict[str, SignalController] = {}
    for node in [one for group in signals for one in group.children("TrafficSignalController")]:
        controller = _controller(node)
        if controller.name in found:
            message = f"a controller of traffic signals named '{controller.name}' already exists"
            first = names.first_at(found[controller.name].origin)
            node.report(names.DUPLICATE_NAME, message, "name", related=first)
        found.setdefault(controller.name, controller)
    return tuple(found.values())


def _controller(node: Node) -> SignalController:
    return SignalController.model_construct(
        name=node.text("name"),
        delay=node.number("delay", 0.0),
        reference=node.text("reference", ""),
        phases=tuple(_phase(phase) for phase in node.children("Phase")),
    ).written_at(node.origin)


def _phase(node: Node) -> SignalPhase:
    states = [
        SignalState.model_construct(signal=one.text("trafficSignalId"), state=one.text("state")).written_at(one.origin)
        for one in node.children("TrafficSignalState")
    ]
    groups = [*node.children("TrafficSignalGroupState"), *node.children("TrafficeSignalGroupState")]
    return SignalPhase.model_construct(
        name=node.text("name"),
        duration=node.number("duration"),
        state=groups[0].text("state") if groups else "",
        states=tuple(states),
    ).written_at(node.origin)
