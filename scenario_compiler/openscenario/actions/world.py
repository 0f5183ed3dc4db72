"""Actions on the world as a whole: entities, variables and parameters, traffic signals, commands."""

from __future__ import annotations

from typing import Any

from lxml import etree

from scenario_compiler.markup import codes
from scenario_compiler.openscenario.motion import read_position, write_position
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import Form, made, nested, regular, text
from scenario_compiler.openscenario.variables import variable_of_parameter
from scenario_compiler.vocabulary.actions import (
    AddEntityAction,
    CommandAction,
    DeleteEntityAction,
    ModifyVariableAction,
    SetVariableAction,
    TrafficSignalControllerAction,
    TrafficSignalStateAction,
)
from scenario_compiler.vocabulary.word import Word

_GLOBAL = ("GlobalAction",)
_SIGNALS = ("GlobalAction", "InfrastructureAction", "TrafficSignalAction")


def read_entity_actions(node: Node) -> list[AddEntityAction | DeleteEntityAction]:
    """Return the actions of an <EntityAction>: one, or one for each member of a selection of entities."""
    inner = node.required("AddEntityAction", "DeleteEntityAction")
    if inner is None:
        return []
    entities = node.entities("entityRef")
    if inner.tag == "DeleteEntityAction":
        return [DeleteEntityAction.model_construct(entity=one).written_at(node.origin) for one in entities]
    holder = inner.required("Position")
    position = None if holder is None else read_position(holder)
    if position is None:
        return []
    return [AddEntityAction.model_construct(entity=one, position=position).written_at(node.origin) for one in entities]


def _read_entity(node: Node) -> AddEntityAction | DeleteEntityAction | None:
    found = read_entity_actions(node)
    return found[0] if found else None


def _write_add(word: AddEntityAction, output: Output) -> etree._Element:
    return made("EntityAction", made("AddEntityAction", write_position(word.position, output)), entityRef=word.entity)


def _write_delete(word: DeleteEntityAction, output: Output) -> etree._Element:
    del output
    return made("EntityAction", made("DeleteEntityAction"), entityRef=word.entity)


def _read_variable(node: Node) -> SetVariableAction | ModifyVariableAction | None:
    name = node.text("variableRef") if node.tag == "VariableAction" else variable_of_parameter(node)
    inner = node.required("SetAction", "ModifyAction")
    if inner is None:
        return None
    if inner.tag == "SetAction":
        return SetVariableAction.model_construct(variable=name, value=inner.text("value")).written_at(node.origin)
    rule = inner.required("Rule")
    change = None if rule is None else rule.first()
    if change is None or change.tag not in ("AddValue", "MultiplyByValue"):
        node.report(codes.MISSING_ELEMENT, "<ModifyAction> names no value to add or multiply by")
        return None
    value = change.number("value")
    if change.tag == "AddValue":
        return ModifyVariableAction.model_construct(variable=name, by="add", value=value).written_at(node.origin)
    return ModifyVariableAction.model_construct(variable=name, by="multiply", value=value).written_at(node.origin)


def _read_monitor(node: Node) -> SetVariableAction:
    value = "true" if node.boolean("value") else "false"
    return SetVariableAction.model_construct(variable=node.text("monitorRef"), value=value).written_at(node.origin)


def _write_set(word: SetVariableAction, output: Output) -> etree._Element:
    return _variable_action(word.variable, made("SetAction", value=word.value), output)


def _write_modify(word: ModifyVariableAction, output: Output) -> etree._Element:
    tag = "AddValue" if word.by == "add" else "MultiplyByValue"
    change = made(tag, value=output.text(word.value, word))
    return _variable_action(word.variable, nested(["ModifyAction", "Rule"], change), output)


def _variable_action(name: str, inner: etree._Element, output: Output) -> etree._Element:
    if output.version >= (1, 2):
        return made("VariableAction", inner, variableRef=name)
    return made("ParameterAction", inner, parameterRef=name)


def _read_command(node: Node) -> CommandAction:
    content = (node.element.text or "").strip()
    return CommandAction.model_construct(type=node.text("type", ""), content=content).written_at(node.origin)


def _write_command(word: CommandAction, output: Output) -> etree._Element:
    del output
    element = made("CustomCommandAction", type=word.type)
    element.text = word.content or None
    return element


def _form(tag: str, word: type[Word], read: Any, write: Any, since: tuple[int, int] = (1, 0)) -> Form[Any]:
    return Form(tag, word, read, write, _GLOBAL, since)


WORLD: tuple[Form[Any], ...] = (
    _form("EntityAction", AddEntityAction, _read_entity, _write_add),
    _form("EntityAction", DeleteEntityAction, _read_entity, _write_delete),
    _form("VariableAction", SetVariableAction, _read_variable, _write_set),
    _form("VariableAction", ModifyVariableAction, _read_variable, _write_modify),
    _form("ParameterAction", SetVariableAction, _read_variable, _write_set),
    _form("SetMonitorAction", SetVariableAction, _read_monitor, _write_set),
    regular(
        "TrafficSignalStateAction",
        TrafficSignalStateAction,
        text("signal", "name"),
        text("state"),
        around=_SIGNALS,
    ),
    regular(
        "TrafficSignalControllerAction",
        TrafficSignalControllerAction,
        text("controller", "trafficSignalControllerRef"),
        text("phase"),
        around=_SIGNALS,
    ),
    Form("CustomCommandAction", CommandAction, _read_command, _write_command, ("UserDefinedAction",)),
)
"""Global and user-defined actions."""
