"""Actions on the run as a whole: the weather, the time of day, messages, other programs, the end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import WEATHER, Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.weather import begin_weather
from scenario_compiler.engine.motion.surroundings import SETS_FRICTION, SETS_TIME, TIME_RUNS, change_surroundings
from scenario_compiler.engine.moves.entry import Entry, Told
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import (
        CommandAction,
        EnvironmentAction,
        MessageAction,
        StopAction,
        WeatherAction,
    )


@compiled
def start_weather(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Begin a change of the weather."""
    del n
    begin_weather(p, st, k)


@compiled
def start_environment(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Set the time of day and the road's friction."""
    del n
    change_surroundings(p, st, k)


@compiled
def start_stop(n: RoadTables, p: Program, st: State, k: int) -> None:
    """End the run."""
    del n, p, k
    if st.stop[0] == op.STOP_NONE:
        st.stop[0] = op.STOP_TRIGGER


def weather_row(draft: ProgramDraft, word: WeatherAction, actor: int) -> ActionRow:
    """Return the row of a change of the weather."""
    del actor
    return ActionRow((0.0, word.over_time), other=draft.weather(word))


def environment_row(draft: ProgramDraft, word: EnvironmentAction, actor: int) -> ActionRow:
    """Return the row of an action on the time of day and the friction."""
    del actor
    flags = SETS_TIME if word.date_time else 0
    flags |= TIME_RUNS if word.animated else 0
    flags |= 0 if word.friction is None else SETS_FRICTION
    time = draft.seconds_of(word.date_time) if word.date_time else 0.0
    return ActionRow((time, 1.0 if word.friction is None else word.friction), flags=flags)


def message_row(draft: ProgramDraft, word: MessageAction, actor: int) -> ActionRow:
    """Return the row of a message to the driver."""
    del word, actor
    draft.messages += 1
    return ActionRow(other=draft.messages - 1)


def stop_row(draft: ProgramDraft, word: StopAction, actor: int) -> ActionRow:
    """Return the row of an action that ends the run."""
    del draft, word, actor
    return ActionRow()


def command_row(draft: ProgramDraft, word: CommandAction, actor: int) -> ActionRow:
    """Return the row of a command for another program."""
    del draft, word, actor
    return ActionRow()


CHANGE_WEATHER = Entry(
    ("weather",),
    weather_row,
    start_weather,
    whose="ego",
    told=Told("weather", "The weather begins to change."),
    refers={"other": index(WEATHER)},
)
ENVIRONMENT = Entry(("environment",), environment_row, start_environment, whose="run")
MESSAGE = Entry(
    ("message",),
    message_row,
    whose="ego",
    told=Told("message", "The driver gets the message `message`; `cause` is its modality."),
)
STOP = Entry(("stop",), stop_row, start_stop, whose="run")
COMMAND = Entry(
    ("command",),
    command_row,
    whose="run",
    told=Told(
        "command",
        "A command for another program: `cause` is its type, `message` its text.",
        lambda word: (word.type, word.content),
    ),
)
