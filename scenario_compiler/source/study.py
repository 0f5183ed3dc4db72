"""The words of a study's files: the procedure for participants, and questionnaires.

A `<study>` names scenarios, variants of the human-machine interface and settings of parameters. Its conditions are all
combinations of these. Pages and questionnaires are separate files.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.resources import NAME, library_conflicts
from scenario_compiler.vocabulary.takeover import Language, Message
from scenario_compiler.vocabulary.word import IDENTIFIER, LABEL, Word, attribute, child

UNREADABLE_PART = Code(
    "SC260",
    "unreadable-part",
    "A study names a file that cannot be read: a page of instructions or consent, a picture in one, a questionnaire, "
    "or a scenario's file. Relative paths start from the folder of the study, those of pictures from the folder of "
    "their page. A page is Markdown in UTF-8; a questionnaire is a file whose first element is <questionnaire>.\n\n"
    '    <page file="wellcome.md"/>     the study\'s folder contains welcome.md\n\n'
    "Correct the path, or add the file.",
)
UNKNOWN_SCALE = Code(
    "SC261",
    "unknown-scale",
    "An item of a questionnaire names a scale that the questionnaire does not have.\n\n"
    '    <scale name="agreement" from="1" to="7"/>\n'
    '    <item name="safe" text="I felt safe." scale="agreemnt"/>\n\n'
    "Correct the name, or add the <scale>.",
)
UNKNOWN_ITEM = Code(
    "SC262",
    "unknown-item",
    "A score of a questionnaire names an item that the questionnaire does not have, or one whose answer is not a "
    "number.\n\n"
    '    <item name="safe" text="I felt safe." scale="agreement"/>\n'
    '    <score name="trust" of="save"/>\n\n'
    "Correct the name. Scores are computed from items with a scale and from number items.",
)
UNEVEN_SQUARE = Code(
    "SC264",
    "uneven-square",
    "The number of participants is not a multiple of the number of rows of the balanced Latin square, so some orders "
    "of the conditions occur more often than others. An even number of conditions needs as many rows, an odd number "
    "twice as many.\n\n"
    '    <study participants="10" order="latin_square" ...>     with four conditions: 8 or 12\n\n'
    "Plan a multiple of the number of rows, or consider the imbalance in the analysis.",
    Severity.WARNING,
)
WRONG_POINTS = Code(
    "SC266",
    "wrong-points",
    "A scale cannot be shown as it is: it has more than 101 points, or a label at a point that it does not have or "
    "that has a label already. A choice needs at least two options.\n\n"
    '    <scale name="agreement" from="1" to="7"><label at="9" text="fully"/></scale>     at="7"\n\n'
    "Correct the label or add an option; a <number_item> takes any number of a wide range.",
)
LATE_PROBE = Code(
    "SC267",
    "late-probe",
    "A probe may come after the longest time that a run of a scenario takes, and then it does not come.\n\n"
    '    <probe from="10" to="40">...</probe>     in a scenario with duration="20"\n\n'
    "Let the probe come earlier, or the scenario last longer.",
    Severity.WARNING,
)
NOBODY_TAKES_OVER = Code(
    "SC265",
    "nobody-takes-over",
    "A scenario of a study has no automated vehicle. Nobody can take over in it, so it cannot be a trial.\n\n"
    '    <scenario name="passing" target="traffic.xosc"/>     a storyboard without an automated ego\n\n'
    "Name a scenario with a controller, such as a conflict of the library.",
)

IDLE_PART = Code(
    "SC253",
    "idle-part",
    "A part of a study or questionnaire has no effect: a break after more trials than a session has (none comes after "
    "the last trial), a probe with the share 0, or a scale that no item uses.\n\n"
    '    <break every="20"/>     in a session of eight trials: every="4"\n\n'
    "Correct the number or the name, or remove the part.",
    Severity.WARNING,
)
LATE_CONSENT = Code(
    "SC254",
    "late-consent",
    "Something is recorded before the participant consents, or the same consent is asked for twice.\n\n"
    '    <before><ask file="age.xml"/><consent file="consent.md"/></before>     the consent first\n\n'
    "Begin with the consent.",
    Severity.WARNING,
)
FOIL_OF_A_TRIAL = Code(
    "SC255",
    "foil-of-a-trial",
    "A foil runs a scenario of the trials. The event that the participants expect then happens in it, and its data are "
    "left out of the comparison as those of a foil.\n\n"
    '    <scenario name="blocked" target="conflicts.xml#blocked"/>\n'
    '    <foil target="conflicts.xml#blocked"/>     target="conflicts.xml#calm"\n\n'
    "Name a scenario in which the event does not happen; `repetitions` lets participants meet a condition several "
    "times.",
    Severity.WARNING,
)
WRONG_TOLERANCE = Code(
    "SC268",
    "wrong-tolerance",
    "The tolerance of a query does not fit its subject. Who is in control and whether the path is blocked are answered "
    "by a choice, so a tolerance has no effect. The speed is compared with a tenth of a km/h, so hardly any answer "
    "counts as correct without a tolerance.\n\n"
    '    <query name="blocked" about="blocked" text="Was the road free?" tolerance="2"/>\n\n'
    "Remove the tolerance, or give the speed one, such as 10.",
    Severity.WARNING,
)
EQUAL_LEVELS = Code(
    "SC269",
    "equal-levels",
    "Two levels of a factor differ by their names alone, so conditions that should differ are the same.\n\n"
    '    <setting name="near"><set parameter="distance" to="40"/></setting>\n'
    '    <setting name="far"><set parameter="distance" to="40"/></setting>     to="80"\n\n'
    "Correct what was copied; `repetitions` lets participants meet a condition several times.",
    Severity.WARNING,
)


class SetParameter(Word):
    """Give a parameter of the scenario a value."""

    word: Literal["set"] = "set"

    parameter: str = attribute("Name of the scenario's parameter.", pattern=IDENTIFIER)
    to: str = attribute("Its value, written as in the scenario's file.")


class StudyScenario(Word):
    """A scenario of the study: a level of the first factor of the conditions."""

    word: Literal["scenario"] = "scenario"

    name: str = attribute("Name in the data.", pattern=LABEL)
    target: str = attribute("FILE#name, relative to the folder of the study, or the name of a conflict in the library.")


class Hmi(Word):
    """A variant of the human-machine interface: a level of the second factor. It replaces the scenario's messages."""

    word: Literal["hmi"] = "hmi"

    name: str = attribute("Name in the data.", pattern=LABEL)
    messages: tuple[Message, ...] = child(
        "How the automation informs the driver. Without messages the driver is not informed.", default=()
    )


class Setting(Word):
    """Values of parameters: a level of the third factor."""

    word: Literal["setting"] = "setting"

    name: str = attribute("Name in the data.", pattern=LABEL)
    values: tuple[SetParameter, ...] = child("The values.", default=())


class Consent(Word):
    """A consent page. Participants who do not agree cannot continue, and nothing else is recorded for them."""

    word: Literal["consent"] = "consent"

    file: str = attribute("Markdown file, relative to the folder of the study.")


class InstructionPage(Word):
    """A page of instructions."""

    word: Literal["page"] = "page"

    file: str = attribute("Markdown file, relative to the folder of the study.")


class Ask(Word):
    """A questionnaire for the participant."""

    word: Literal["ask"] = "ask"

    file: str = attribute("File of the questionnaire, relative to the folder of the study.")


class Practice(Word):
    """A practice trial. It is recorded and marked, and excluded from comparisons."""

    word: Literal["practice"] = "practice"

    target: str = attribute("FILE#name, relative to the folder of the study, or the name of a conflict in the library.")


class Before(Word):
    """The procedure before the trials."""

    word: Literal["before"] = "before"

    steps: tuple[Consent | InstructionPage | Ask | Practice, ...] = child("Steps, in order.", default=())


class AfterEach(Word):
    """The procedure after each trial that is neither practice nor a foil."""

    word: Literal["after_each"] = "after_each"

    steps: tuple[Ask, ...] = child("Steps, in order.", default=())


class After(Word):
    """The procedure after the trials."""

    word: Literal["after"] = "after"

    steps: tuple[InstructionPage | Ask, ...] = child("Steps, in order.", default=())


class Foil(Word):
    """A trial in which the expected event does not happen. Its place among the other trials is drawn at random."""

    word: Literal["foil"] = "foil"

    target: str = attribute("FILE#name, relative to the folder of the study, or the name of a conflict in the library.")
    count: int = attribute("Number of such trials in a session.", default=1, minimum=1, maximum=100)


class Break(Word):
    """A pause between trials."""

    word: Literal["break"] = "break"

    every: int = attribute("Number of trials between two pauses.", minimum=1, maximum=1000)
    least: float = attribute("Least duration, s.", default=0.0, quantity="time", minimum=0, maximum=3600)
    file: str = attribute("Markdown file with the text of the pause, relative to the folder of the study.", default="")


QueryAbout = Literal["speed", "vehicles", "control", "blocked"]
"""Subjects of a probe's query: the speed in km/h, the number of vehicles within 100 m, who drives (`automation` or
`me`), whether something blocks the path (`yes` or `no`).
"""


class Query(Word):
    """A question about the situation. Its true answer is read from the frozen state."""

    word: Literal["query"] = "query"

    name: str = attribute("Name in the data.", pattern=IDENTIFIER)
    about: QueryAbout = attribute(
        "Subject of the question, and so its true answer: the own speed in km/h, the number of other vehicles within "
        "100 m in all directions (no pedestrians or objects), who is in control (the automation, or I), or whether "
        "the automation detects that the path is blocked (yes, or no)."
    )
    text: str = attribute("The question as the participant reads it.")
    tolerance: float = attribute(
        "speed, vehicles: greatest deviation from the true number that counts as correct.",
        default=0.0,
        minimum=0,
    )


class Probe(Word):
    """A freeze probe: the run stops unannounced, the picture is blanked, and the participant answers from memory.

    The method is SAGAT (Endsley 1988): answers are compared with the true state. The moment is drawn separately for
    each trial.
    """

    word: Literal["probe"] = "probe"

    earliest: float = attribute("Earliest time of the freeze in the trial, s.", name="from", quantity="time", minimum=0)
    latest: float = attribute("Latest time of the freeze, s.", name="to", quantity="time", minimum=0)
    share: float = attribute(
        "Share of the trials with a probe, drawn for each trial.",
        default=1.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    queries: tuple[Query, ...] = child("The questions.")


class SearchTask(Word):
    """A visual secondary task during the trials: find the one larger circle among the others and press on it.

    It resembles the surrogate reference task of ISO/TS 14198, but is not the standard's own task.
    """

    word: Literal["search_task"] = "search_task"

    items: int = attribute("Number of circles.", default=24, minimum=4, maximum=60)
    ratio: float = attribute(
        "Ratio of the larger circle's diameter to that of the others.", default=1.5, minimum=1.1, maximum=3
    )


Order = Literal["latin_square", "random"]
"""Order of the conditions: by the rows of a balanced Latin square (Williams 1949), or at random by the seed."""


class StudyElement(Word):
    """A study: its conditions, and the procedure for each participant.

    The conditions are all combinations of scenarios, variants of the interface and settings. Each participant meets
    every condition `repetitions` times in a session.
    """

    word: Literal["study"] = "study"

    version: Literal["1"] = attribute("Version of the language.")
    name: str = attribute("Name in the data: the task name in BIDS.", pattern=LABEL)
    summary: str = attribute("Subject of the study in one sentence. Participants do not see it.", default="")
    participants: int = attribute("Number of participants.", minimum=1, maximum=9999)
    sessions: int = attribute("Number of sessions of each participant.", default=1, minimum=1, maximum=99)
    repetitions: int = attribute(
        "Number of times that each condition occurs in a session.", default=1, minimum=1, maximum=100
    )
    order: Order = attribute("Order of the conditions.", default="latin_square")
    seed: int = attribute("Seed of all random draws.", default=1, minimum=0)
    language: Language = attribute("Language of the built-in texts of the pages.", default="en")
    before: Before | None = child("Procedure before the trials.", default=None)
    scenarios: tuple[StudyScenario, ...] = child("The scenarios.")
    hmis: tuple[Hmi, ...] = child("Variants of the interface; if left out, the scenarios' own messages.", default=())
    settings: tuple[Setting, ...] = child("Settings of parameters; if left out, the scenarios' defaults.", default=())
    foils: tuple[Foil, ...] = child("Trials in which the expected event does not happen.", default=())
    pause: Break | None = child("Pauses between trials.", default=None)
    probe: Probe | None = child("Questions about the situation in a frozen run.", default=None)
    task: SearchTask | None = child("A secondary task.", default=None)
    after_each: AfterEach | None = child("Procedure after each trial.", default=None)
    after: After | None = child("Procedure after the trials.", default=None)


class ScaleLabel(Word):
    """The label of a point on a scale."""

    word: Literal["label"] = "label"

    at: int = attribute("The point.")
    text: str = attribute("Text of the label.")


class Scale(Word):
    """A scale of whole numbers."""

    word: Literal["scale"] = "scale"

    name: str = attribute("Name by which items refer to the scale.", pattern=IDENTIFIER)
    least: int = attribute("Least answer.", name="from")
    most: int = attribute("Greatest answer.", name="to")
    labels: tuple[ScaleLabel, ...] = child("Labels of its points.", default=())


class ScaleItem(Word):
    """A statement or question with an answer on a scale."""

    word: Literal["item"] = "item"

    name: str = attribute("Name in the data.", pattern=IDENTIFIER)
    text: str = attribute("What the participant reads.")
    scale: str = attribute("Name of the scale.")
    reverse: bool = attribute("Whether scores count the answer from the other end of the scale.", default=False)


class NumberItem(Word):
    """A question with a number as its answer."""

    word: Literal["number_item"] = "number_item"

    name: str = attribute("Name in the data.", pattern=IDENTIFIER)
    text: str = attribute("What the participant reads.")
    least: float = attribute("Least answer.", name="from")
    most: float = attribute("Greatest answer.", name="to")
    unit: str = attribute("Unit of the answer.", default="")


class Option(Word):
    """A possible answer."""

    word: Literal["option"] = "option"

    value: str = attribute("Value in the data.", pattern="[A-Za-z0-9_]+")
    text: str = attribute("What the participant reads.")


class ChoiceItem(Word):
    """A question with a choice of answers."""

    word: Literal["choice_item"] = "choice_item"

    name: str = attribute("Name in the data.", pattern=IDENTIFIER)
    text: str = attribute("What the participant reads.")
    options: tuple[Option, ...] = child("The answers.")


class TextItem(Word):
    """A question with a free text as its answer, which may be empty."""

    word: Literal["text_item"] = "text_item"

    name: str = attribute("Name in the data.", pattern=IDENTIFIER)
    text: str = attribute("What the participant reads.")


class Score(Word):
    """A number computed from the answers to several items."""

    word: Literal["score"] = "score"

    name: str = attribute("Name in the data.", pattern=IDENTIFIER)
    of: tuple[str, ...] = attribute("Names of the items.", separated=True)
    by: Literal["mean", "sum"] = attribute("How.", default="mean")


Item = ScaleItem | NumberItem | ChoiceItem | TextItem


class QuestionnaireElement(Word):
    """A questionnaire: scales, items and scores.

    No questionnaire is included: write your own, or use one that you have the right to use.
    """

    word: Literal["questionnaire"] = "questionnaire"

    version: Literal["1"] = attribute("Version of the language.")
    name: str = attribute("Name in the data: a task of BIDS, as the study is.", pattern=LABEL)
    title: str = attribute("Heading of the page.", default="")
    instruction: str = attribute("What the participant reads above the items.", default="")
    source: str = attribute("Where the questionnaire comes from, and by what right it is used.", default="")
    scales: tuple[Scale, ...] = child("Scales.", default=())
    items: tuple[Item, ...] = child("Items, in the order of the page.")
    scores: tuple[Score, ...] = child("Scores.", default=())

    def scale_of(self, item: ScaleItem) -> Scale:
        """Return the scale of an item."""
        return next(one for one in self.scales if one.name == item.scale)


STUDIES = (StudyElement, QuestionnaireElement)
"""First elements of a study's files."""


@dataclass(frozen=True)
class Condition:
    """A combination of one scenario, one variant of the interface and one setting.

    Attributes:
        name: The names of its levels, with hyphens between.
        scenario: The scenario.
        hmi: The variant of the interface; None for the scenario's own messages.
        setting: The setting; None for the scenario's defaults.
    """

    name: str
    scenario: StudyScenario
    hmi: Hmi | None = None
    setting: Setting | None = None

    @property
    def levels(self) -> dict[str, str]:
        """The names of the levels by factor, for the factors that the study has."""
        found = {"scenario": self.scenario.name}
        found |= {"hmi": self.hmi.name} if self.hmi is not None else {}
        return found | ({"setting": self.setting.name} if self.setting is not None else {})


def conditions_of(study: StudyElement) -> tuple[Condition, ...]:
    """Return a study's conditions: all combinations, the last factor changing fastest."""
    hmis: tuple[Hmi | None, ...] = study.hmis or (None,)
    settings: tuple[Setting | None, ...] = study.settings or (None,)
    found = itertools.product(study.scenarios, hmis, settings)
    return tuple(Condition("-".join(one.name for one in parts if one is not None), *parts) for parts in found)


def square_rows(count: int) -> int:
    """Return the number of rows of a balanced Latin square for a number of conditions."""
    return count if count % 2 == 0 or count == 1 else 2 * count


def located(target: str, folder: Path) -> str:
    """Return a study's FILE#name with the study's folder before it; a bare name is a conflict of the library."""
    path, mark, name = target.partition("#")
    if not NAME.fullmatch(target):
        return f"{folder / path}{mark}{name}"
    return f"{library_conflicts().get(target, folder / target)}#{target}"
