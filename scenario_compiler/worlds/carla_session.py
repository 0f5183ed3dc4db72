"""A CARLA server that a run has for itself: its address, map, clock and settings."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Literal

from scenario_compiler.diagnostics import Code, Diagnostics
from scenario_compiler.document import read_document
from scenario_compiler.frames import carla_from_pose
from scenario_compiler.plan.model import Plan
from scenario_compiler.records import field
from scenario_compiler.roads import Network
from scenario_compiler.roads.export_carla import export_for_carla
from scenario_compiler.worlds.model import WorldError, WorldOptions

CANNOT_OPEN = Code(
    "SC524",
    "carla-cannot-be-used",
    "CARLA cannot be used for this run: its client is not installed, no server answers at the address, the versions "
    "of server and client differ, the server's map is not the plan's, or the scenario has no entity. The versions "
    "must be equal because their layouts differ.\n\n"
    "    pip install 'scenario-compiler[carla]'\n"
    "    scenario-compiler serve-carla &            or CarlaUE4.sh\n"
    "    scenario-compiler run obstacle_ahead --world carla --carla-port 2000",
)

LONGEST_STEP = 0.1
"""Longest time step of CARLA's physics, s."""

SAME_PLACE = 0.25
"""Greatest distance between the server's lanes and the plan's, m."""

TAKEN: set[tuple[str, int]] = set()
"""Addresses of the servers in use by runs of this program: each server serves one run at a time."""


class CarlaOptions(WorldOptions):
    """Options of the world `carla`."""

    host: str = field(default="127.0.0.1", description="Address of the server.")
    port: int = field(default=2000, ge=1, le=65535, description="Port of the server.")
    timeout: float = field(default=10.0, gt=0.0, description="Longest time to wait for an answer, s.")
    ego: Literal["physics", "kinematic"] = field(
        default="physics", description="`physics` if CARLA's physics moves the ego, `kinematic` if the engine does."
    )
    camera: Literal["carla", "built-in"] | None = field(
        default=None,
        description="Camera of the automation; by default CARLA's, if it can show the paint and the mounting.",
    )
    recording: str = field(default="", description="Name of a recording that the server makes; none if empty.")


class CarlaSession:
    """The server of a run, in synchronous mode and with the plan's map.

    Attributes:
        carla: The client's module.
        client: The client.
        world: The server's world.
        library: Its blueprints.
        versions: Versions of client and server, and the name of the server's map.
    """

    def __init__(self, plan: Plan, network: Network, options: CarlaOptions) -> None:
        """Connect, load the map and set the server to synchronous mode.

        Raises:
            WorldError: CARLA cannot be used for the plan; the code's page says why.
        """
        try:
            import carla
        except ModuleNotFoundError:
            raise WorldError(
                "CARLA's client is not installed: pip install 'scenario-compiler[carla]'", CANNOT_OPEN
            ) from None
        self.carla, self._options = carla, options
        self._address = (options.host, options.port)
        if plan.step > LONGEST_STEP:
            raise WorldError(f"the time step is {plan.step:g} s; CARLA takes {LONGEST_STEP:g} s at most", CANNOT_OPEN)
        if self._address in TAKEN:
            raise WorldError(f"another run is in the CARLA server at {self.place}: one at a time", CANNOT_OPEN)
        TAKEN.add(self._address)
        self._open = True
        self._before: Any = None
        try:
            self._connect()
            self._load_map(plan, network)
            self._take_the_clock(plan.step)
            self.versions["carla_map"] = self.world.get_map().name
        except RuntimeError as fault:
            self.close()
            raise WorldError(f"CARLA at {self.place}: {fault}", CANNOT_OPEN) from None
        except BaseException:
            self.close()
            raise

    @property
    def place(self) -> str:
        """The server's address."""
        return f"{self._options.host}:{self._options.port}"

    def _connect(self) -> None:
        self.client = self.carla.Client(*self._address)
        self.client.set_timeout(self._options.timeout)
        client, server = self.client.get_client_version(), self.client.get_server_version()
        if client.split("-")[0] != server.split("-")[0]:
            raise WorldError(f"the client is CARLA {client}, the server at {self.place} is {server}", CANNOT_OPEN)
        self.versions = {"carla_client": client, "carla_server": server}
        self.world = self.client.get_world()
        self._before = self.world.get_settings()
        self._before.synchronous_mode = False

    def _load_map(self, plan: Plan, network: Network) -> None:
        name = Path(plan.map.name).stem
        known = {one.rpartition("/")[2] for one in self.client.get_available_maps()}
        if name in known:
            self.world = self.client.load_world(name)
            if self._has_lanes_of(plan, network):
                return
        document = read_document(Path(plan.map.file), Diagnostics())
        if document is None:
            raise WorldError(f"the map '{plan.map.file}' cannot be read", CANNOT_OPEN)
        encoding = document.root.getroottree().docinfo.encoding or "utf-8"
        text = export_for_carla(document, network).decode(encoding)
        self.world = self.client.generate_opendrive_world(text)
        if not self._has_lanes_of(plan, network):
            raise WorldError("the server's map has its lanes elsewhere than the plan's", CANNOT_OPEN)

    def _has_lanes_of(self, plan: Plan, network: Network) -> bool:
        """Return whether the entities' starts lie on lanes where the plan has them."""
        map_ = self.world.get_map()
        for start in plan.derived.values():
            for place in network.locate(start.x, start.y)[:1]:
                there = carla_from_pose(network.lane_pose(place.road, place.lane, place.s))
                at = self.carla.Location(*there[:3])
                found = map_.get_waypoint(at, project_to_road=True, lane_type=self.carla.LaneType.Any)
                if (
                    found is None
                    or math.dist((found.transform.location.x, found.transform.location.y), there[:2]) > SAME_PLACE
                ):
                    return False
        return True

    def _take_the_clock(self, step: float) -> None:
        settings = self.world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, step
        self.world.apply_settings(settings)
        self.library = self.world.get_blueprint_library()
        if self._options.recording:
            self.client.start_recorder(self._options.recording)

    @contextlib.contextmanager
    def answering(self) -> Iterator[None]:
        """Turn exceptions of the client into a WorldError."""
        try:
            yield
        except RuntimeError as fault:
            raise WorldError(f"CARLA at {self.place}: {fault}") from None

    def close(self, clear: Callable[[], None] = lambda: None) -> None:
        """Restore the settings; `clear` destroys the actors of the run before.

        A server that does not respond does both later, if it responds again.
        """
        if not self._open:
            return
        self._open = False
        TAKEN.discard(self._address)
        if self._before is None:
            return
        self.client.set_timeout(min(self._options.timeout, 2.0))
        for undo in (clear, self._stop_recorder, lambda: self.world.apply_settings(self._before)):
            with contextlib.suppress(RuntimeError):
                undo()

    def _stop_recorder(self) -> None:
        if self._options.recording:
            self.client.stop_recorder()
