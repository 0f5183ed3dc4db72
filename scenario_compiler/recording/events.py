"""Events of a run, and their CSV form."""

import csv
import io
from collections.abc import Iterable
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, field_validator

from scenario_compiler.outputs import write_whole
from scenario_compiler.recording.cells import text_cell
from scenario_compiler.recording.decimals import shortest, to_the_nanosecond
from scenario_compiler.recording.names import EVENT_TEXTS, EventKind


class EventRow(BaseModel):
    """Something that happened at one instant: a row of events.csv, in the order of the fields."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True)

    t: float = Field(description="Time, s.")
    kind: EventKind = Field(description="What happened.", json_schema_extra={"enum": [*EVENT_TEXTS]})
    entity: str = Field(default="", description="Id of the entity concerned; for a collision, of the other entity.")
    cause: str = Field(
        default="", description="Cause: of a warning or request, the kind of a failure, or who stopped the vehicle."
    )
    message: str = Field(
        default="",
        description="The message to the driver, the name of a storyboard event or an entity, or a sentence.",
    )
    value: float | None = Field(default=None, description="A number that belongs to the event, in its SI unit.")

    @field_validator("kind")
    @classmethod
    def _is_known(cls, kind: str) -> str:
        if kind not in EVENT_TEXTS:
            raise ValueError(f"there is no kind of event '{kind}'")
        return kind


def write_events(events: Iterable[EventRow], path: Path) -> None:
    """Write events.csv with one row per event, in order; an absent value is an empty cell."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(EventRow.model_fields)
    for event in events:
        value = "" if event.value is None else shortest(event.value)
        texts = (text_cell(text) for text in (event.kind, event.entity, event.cause, event.message))
        rows.writerow((shortest(to_the_nanosecond(event.t)), *texts, value))
    write_whole(path, text.getvalue())
