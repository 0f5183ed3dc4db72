"""Reads study files, with the pages and questionnaires that they name."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from pathlib import Path

from scenario_compiler.diagnostics import Diagnostics, Place, did_you_mean
from scenario_compiler.document import Document, read_document
from scenario_compiler.markup import names
from scenario_compiler.markup.codes import EMPTY_RANGE
from scenario_compiler.markup.environment import Environment, ReadingContext
from scenario_compiler.markup.reading import read_fields, read_word
from scenario_compiler.source.study import (
    UNEVEN_SQUARE,
    UNKNOWN_ITEM,
    UNKNOWN_SCALE,
    UNREADABLE_PART,
    WRONG_POINTS,
    Ask,
    Break,
    ChoiceItem,
    Consent,
    Hmi,
    InstructionPage,
    Item,
    NumberItem,
    Query,
    QuestionnaireElement,
    Scale,
    ScaleItem,
    Score,
    SetParameter,
    Setting,
    StudyElement,
    StudyScenario,
    conditions_of,
    square_rows,
)
from scenario_compiler.source.study_file import StudyFile
from scenario_compiler.source.study_idle import report_idle, report_unreached_break, report_unused
from scenario_compiler.source.study_page import read_page
from scenario_compiler.vocabulary.word import Word

MOST_POINTS = 101
"""Greatest number of points of a scale: 0 to 100."""

RESERVED = ("participant_id", "session_id", "run", "when", "step")
"""Names that no item may have: the table's own columns, and the number of the step that a page sends."""

UNREAD: Mapping[type[Word], Mapping[str, object]] = {
    StudyElement: {"version": "1", "name": "", "participants": 0, "scenarios": ()},
    StudyScenario: {"name": ""},
    Setting: {"name": ""},
    Break: {"every": 1},
}
"""Values that a study and its parts get for required attributes that cannot be read, which is reported: the files and
parameters that they name are checked nevertheless.
"""


def read_study(document: Document, sink: Diagnostics) -> StudyFile:
    """Return the contents of a `<study>` file, with the pages and questionnaires that it names; report the faults.

    A study of which something required cannot be read is returned with `UNREAD` in its place.
    """
    reading = ReadingContext(document, sink, Environment(), unread=UNREAD)
    fields, _ = read_fields(document.root, StudyElement, reading)
    study = StudyElement.model_construct(**{**UNREAD[StudyElement], **fields}).written_at(reading.origin(document.root))
    if not sink.has_errors:
        _report_uneven(study, sink)
        report_unreached_break(study, sink)
    for named in (study.scenarios, study.hmis, study.settings, () if study.probe is None else study.probe.queries):
        _report_doubles(named, sink)
    report_idle(study, sink)
    for setting in study.settings:
        _report_repeated(setting.values, "parameter", f"'{setting.name}' sets the parameter '{{}}' already", sink)
    parts = (
        (study.before, "before the trials"),
        (study.after_each, "after each trial"),
        (study.after, "after the trials"),
    )
    for part, when in parts:
        for _, steps in groupby(() if part is None else part.steps, type):
            asks = [step for step in steps if isinstance(step, Ask)]
            _report_repeated(asks, "file", f"'{{}}' is asked {when} already, with nothing in between", sink)
    probe = study.probe
    if probe is not None and probe.latest < probe.earliest:
        _report_empty("the probe", probe.earliest, probe.latest, probe.place_of("to"), sink)
    pages = {}
    for step in _pages_of(study):
        page = read_page(step.file, document.folder, step.place_of("file"), sink)
        if page is not None:
            pages[step.file] = page
    questionnaires: dict[str, QuestionnaireElement] = {}
    for ask in _asks_of(study):
        if ask.file not in questionnaires:
            found = _questionnaire_in(ask, document.folder, sink)
            if found is not None:
                questionnaires[ask.file] = found
    _report_shared_names(study, questionnaires, sink)
    return StudyFile(document, study, questionnaires=questionnaires, pages=pages)


def _report_uneven(study: StudyElement, sink: Diagnostics) -> None:
    """Report participants who do not fill the rows of a balanced Latin square evenly."""
    rows = square_rows(len(conditions_of(study)))
    if study.order != "latin_square" or study.participants % rows == 0:
        return
    fewer = study.participants // rows * rows
    sink.add(
        UNEVEN_SQUARE,
        f"{study.participants} participants do not fill the {rows} rows of the balanced Latin square evenly",
        study.place_of("participants"),
        hint=f"{fewer} or {fewer + rows} do" if fewer else f"{rows} do",
    )


def read_questionnaire(document: Document, sink: Diagnostics) -> StudyFile:
    """Return the contents of a `<questionnaire>` file; report the faults."""
    found = read_word(document.root, QuestionnaireElement, ReadingContext(document, sink, Environment()))
    if found is None:
        return StudyFile(document)
    _report_doubles(found.scales, sink)
    _report_doubles((*found.items, *found.scores), sink)
    scales = {one.name for one in found.scales}
    ranges: list[Scale | NumberItem] = [*found.scales, *(one for one in found.items if isinstance(one, NumberItem))]
    for ranged in ranges:
        if ranged.most <= ranged.least:
            _report_empty(f"'{ranged.name}'", ranged.least, ranged.most, ranged.place_of("to"), sink)
    unread = {one.get("name", "") for one in document.root.iterchildren(Scale.tag())} - scales
    numbers = {one.name for one in found.items if isinstance(one, ScaleItem | NumberItem)}
    for item in found.items:
        if isinstance(item, ScaleItem) and item.scale not in scales | unread:
            message = f"there is no scale '{item.scale}'"
            sink.add(UNKNOWN_SCALE, message, item.place_of("scale"), hint=did_you_mean(item.scale, scales))
    for scale in found.scales:
        if scale.most > scale.least:
            _report_points(scale, sink)
    report_unused(found, sink)
    _report_names(found.items, sink)
    for score in found.scores:
        for k, name in enumerate(score.of):
            if name in score.of[:k]:
                sink.add(names.DUPLICATE_NAME, f"'{score.name}' counts '{name}' twice", score.place_of("of"))
            elif name not in numbers:
                message = f"there is no item '{name}' whose answer is a number"
                sink.add(UNKNOWN_ITEM, message, score.place_of("of"), hint=did_you_mean(name, numbers))
    return StudyFile(document, questionnaire=found)


def _report_doubles(
    words: Iterable[StudyScenario | Hmi | Setting | Query | Scale | Item | Score], sink: Diagnostics
) -> None:
    first: dict[str, Place] = {}
    for one in words:
        if not one.name:
            continue
        place = one.place_of("name")
        if one.name in first:
            message = f"there is a <{one.tag()}> named '{one.name}' already"
            sink.add(names.DUPLICATE_NAME, message, place, related=names.first_at(first[one.name]))
        first.setdefault(one.name, place)


def _report_repeated(words: Iterable[SetParameter | Ask], attribute: str, message: str, sink: Diagnostics) -> None:
    """Report words whose attribute has the value of an earlier word's; `message` takes this value."""
    first: dict[str, Place] = {}
    for one in words:
        value, place = getattr(one, attribute), one.place_of(attribute)
        if value in first:
            sink.add(names.DUPLICATE_NAME, message.format(value), place, related=names.first_at(first[value]))
        first.setdefault(value, place)


def _report_names(items: Iterable[Item], sink: Diagnostics) -> None:
    """Report items with a reserved name, and options with the same value."""
    for item in items:
        if item.name in RESERVED:
            message = f"every questionnaire has a column or field '{item.name}' of its own"
            sink.add(names.DUPLICATE_NAME, message, item.place_of("name"))
        if isinstance(item, ChoiceItem):
            values = [one.value for one in item.options]
            if len(values) == 1:
                sink.add(WRONG_POINTS, f"'{item.name}' has only one option", item.place_of("name"))
            for n, option in enumerate(item.options):
                if option.value in values[:n]:
                    message = f"'{item.name}' has an option with the value '{option.value}' already"
                    sink.add(names.DUPLICATE_NAME, message, option.place_of("value"))


def _report_points(scale: Scale, sink: Diagnostics) -> None:
    """Report a scale with too many points, labels at points outside of it, and repeated labels."""
    if scale.most - scale.least >= MOST_POINTS:
        message = f"'{scale.name}' has {scale.most - scale.least + 1} points, but may have at most {MOST_POINTS}"
        sink.add(WRONG_POINTS, message, scale.place_of("to"))
    labelled: set[int] = set()
    for label in scale.labels:
        if not scale.least <= label.at <= scale.most:
            message = f"'{scale.name}' goes from {scale.least} to {scale.most} and has no point {label.at}"
            sink.add(WRONG_POINTS, message, label.place_of("at"))
        elif label.at in labelled:
            message = f"the point {label.at} of '{scale.name}' has a label already"
            sink.add(WRONG_POINTS, message, label.place_of("at"))
        labelled.add(label.at)


def _report_empty(what: str, least: float, most: float, place: Place, sink: Diagnostics) -> None:
    sink.add(EMPTY_RANGE, f"{what} goes from {least:g} to {most:g}", place)


def _report_shared_names(study: StudyElement, found: Mapping[str, QuestionnaireElement], sink: Diagnostics) -> None:
    """Report questionnaires with the same name, or that of the study, because their data would be in the same table."""
    first: dict[str, str] = {}
    for ask in _asks_of(study):
        name = found[ask.file].name if ask.file in found else ""
        if name and name == study.name:
            message = f"the questionnaire of {ask.file} is named '{name}' like the study"
            sink.add(names.DUPLICATE_NAME, message, ask.place_of("file"))
        elif name and first.setdefault(name, ask.file) != ask.file:
            message = f"the questionnaire of {ask.file} is named '{name}' like that of {first[name]}"
            sink.add(names.DUPLICATE_NAME, message, ask.place_of("file"))


def _pages_of(study: StudyElement) -> Iterator[Consent | InstructionPage | Break]:
    for part in (study.before, study.after):
        for step in () if part is None else part.steps:
            if isinstance(step, Consent | InstructionPage):
                yield step
    if study.pause is not None and study.pause.file:
        yield study.pause


def _asks_of(study: StudyElement) -> Iterator[Ask]:
    for part in (study.before, study.after_each, study.after):
        for step in () if part is None else part.steps:
            if isinstance(step, Ask):
                yield step


def _questionnaire_in(ask: Ask, folder: Path, sink: Diagnostics) -> QuestionnaireElement | None:
    """Return the questionnaire of a file; its own faults are reported at their places."""
    inner = Diagnostics()
    document = read_document(Path(os.path.normpath(folder / ask.file)), inner)
    if document is None or document.root.tag != QuestionnaireElement.tag():
        reason = next((one.message for one in inner), "its first element is not <questionnaire>")
        sink.add(UNREADABLE_PART, f"'{ask.file}': {reason}", ask.place_of("file"))
        return None
    return read_questionnaire(document, sink).questionnaire
