"""<Entities>: scenario objects in document order, their kinds, their controllers, and entity selections."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from scenario_compiler.diagnostics import Severity, did_you_mean
from scenario_compiler.markup import codes as form
from scenario_compiler.markup import names
from scenario_compiler.openscenario.actions.control import read_held
from scenario_compiler.openscenario.catalogs import given
from scenario_compiler.openscenario.codes import EXTERNAL_OBJECT, NO_OBJECT
from scenario_compiler.openscenario.node import Known, Node, ObjectType
from scenario_compiler.openscenario.vehicles import OBJECTS, read_vehicle, usual_car
from scenario_compiler.vocabulary.actions import ConnectTrailerAction
from scenario_compiler.vocabulary.entities import Dynamic, Vehicle
from scenario_compiler.vocabulary.storyboard import InitAction

MOST_TRAILERS = 20
"""Greatest number of trailers in a row."""


@dataclass
class Entities:
    """The entities of a scenario.

    Attributes:
        actors: In document order; a trailer comes after its towing vehicle.
        vehicles: Their vehicles, by unique names.
        first: Actions that come before those of the init.
    """

    actors: list[Dynamic] = field(default_factory=list)
    vehicles: dict[str, Vehicle] = field(default_factory=dict)
    first: list[InitAction] = field(default_factory=list)

    def add_vehicle(self, vehicle: Vehicle) -> str:
        """Return the name under which a vehicle is registered; a name of another vehicle gets a number."""
        name, number = vehicle.name, 1
        while name in self.vehicles and self.vehicles[name] != vehicle.model_copy(update={"name": name}):
            number += 1
            name = f"{vehicle.name}#{number}"
        self.vehicles.setdefault(name, vehicle.model_copy(update={"name": name}).written_at(vehicle.origin))
        return name


def read_entities(root: Node) -> Entities:
    """Return the entities, and register their names for everything that is read afterwards."""
    found = Entities()
    known = root.reading.known
    objects = [one for group in root.children("Entities") for one in group.children("ScenarioObject")]
    trailers: list[tuple[str, Node]] = []
    for one in objects:
        _add_object(one, one.text("name"), found, known, trailers, 0)
    for group in root.children("Entities"):
        for selection in group.children("EntitySelection"):
            _add_selection(selection, known)
    for entity, reference in trailers:
        trailer = reference.entity("entityRef", "")
        if trailer in known.entities:
            action = ConnectTrailerAction.model_construct(trailer=trailer).written_at(reference.origin)
            found.first.append(InitAction.model_construct(entity=entity, action=action).written_at(reference.origin))
    return found


def _add_object(
    node: Node, name: str, found: Entities, known: Known, trailers: list[tuple[str, Node]], depth: int
) -> None:
    if name in known.entities:
        node.read_whole()
        node.report(
            names.DUPLICATE_NAME,
            f"there is already an entity named '{name}'",
            "name",
            related=names.first_at(known.places.get(name)),
        )
        return
    known.places[name] = node.place("name")
    described = _described(node)
    kind: ObjectType = "external"
    if described is None:
        vehicle = usual_car(name)
    else:
        kind, vehicle = OBJECTS[described.tag], read_vehicle(described)
    known.entities[name] = kind
    model = found.add_vehicle(vehicle)
    found.actors.append(Dynamic.model_construct(id=name, model=model).written_at(node.origin))
    for trailer in [] if described is None else described.children("Trailer"):
        _add_trailer(name, trailer, found, known, trailers, depth)
    for held in node.children("ObjectController"):
        controller = given(held, "Controller", severity=Severity.WARNING)
        if controller is not None:
            found.first.append(
                InitAction.model_construct(entity=name, action=read_held(held, controller)).written_at(held.origin)
            )


def _add_trailer(
    entity: str, node: Node, found: Entities, known: Known, trailers: list[tuple[str, Node]], depth: int
) -> None:
    """Add a vehicle's trailer; one from a catalog gets its vehicle's name and a +, as in esmini."""
    reference = node.child("TrailerRef")
    if reference is not None and reference.has("entityRef") and reference.text("entityRef"):
        trailers.append((entity, reference))
    hitched = node.child("Trailer")
    if hitched is not None and depth < MOST_TRAILERS:
        name = hitched.text("name")
        if hitched.reading.within is not None:
            name = f"{entity}+"
        _add_object(hitched, name, found, known, trailers, depth + 1)
        action = ConnectTrailerAction.model_construct(trailer=name).written_at(hitched.origin)
        found.first.append(InitAction.model_construct(entity=entity, action=action).written_at(hitched.origin))


def _described(node: Node) -> Node | None:
    """Return the element that describes an entity, in the file or in a catalog; report it if there is none."""
    external = node.child("ExternalObjectReference")
    if external is not None:
        name = external.text("name")
        external.report(EXTERNAL_OBJECT, f"'{name}' is described outside this file; a car is used for it")
        return None
    found = given(node, *OBJECTS)
    if found is None and node.child("CatalogReference") is None:
        node.report(NO_OBJECT, "the entity has no kind; a car is used for it")
    return found


def _add_selection(node: Node, known: Known) -> None:
    name = node.text("name")
    if name in known.entities or name in known.selections:
        message = f"there is already an entity or selection named '{name}'"
        node.report(names.DUPLICATE_NAME, message, "name", related=names.first_at(known.places.get(name)))
        return
    known.places[name] = node.place("name")
    members = [entity for group in node.children("Members") for entity in _members(group, known)]
    known.selections[name] = tuple(dict.fromkeys(members))


def _members(group: Node, known: Known) -> Iterator[str]:
    for one in group.elements():
        if one.tag == "EntityRef":
            yield from one.entities("entityRef")
        elif one.tag in ("ByType", "ByObjectType"):
            attribute = "objectType" if one.has("objectType") else "type"
            wanted = one.text(attribute)
            types = ("external", "miscellaneous", "pedestrian", "vehicle")
            if wanted not in types:
                one.report(
                    form.WRONG_VALUE, f"'{wanted}' is not a type of object", attribute, did_you_mean(wanted, types)
                )
            yield from (entity for entity, kind in known.entities.items() if kind == wanted)
