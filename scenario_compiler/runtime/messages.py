"""The messages to the driver, by language, event, cause and content: one table of texts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple, get_args

from scenario_compiler.engine.columns.numbers import SAME_TIME
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.events import EventRow
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.takeover import Content, Language, Modality, Told
from scenario_compiler.vocabulary.word import number_value

ENDS = ("warning_over", "response", "override", "hand_back", "activation", "standstill")
"""Events that end the messages to the driver."""


class Texts(NamedTuple):
    """The texts of one language.

    Attributes:
        what: What happens, by event.
        why: Why, by cause.
        next: What to do, by cause.
    """

    what: dict[str, str]
    why: dict[str, str]
    next: dict[str, str]

    @property
    def named(self) -> dict[str, str]:
        """The texts by their names: `what_` and an event, `why_` or `next_` and a cause."""
        kinds = {"what": self.what, "why": self.why, "next": self.next}
        return {f"{kind}_{name}": text for kind, texts in kinds.items() for name, text in texts.items()}


TEXTS: dict[Language, Texts] = {
    "en": Texts(
        what={
            "warning": "Be ready to take over",
            "request": "Take over now",
            "escalation": "Take over immediately",
            "minimum_risk": "Stopping in the lane",
        },
        why={
            "lane_confidence": "the lane markings cannot be seen",
            "sensor_health": "the camera is failing",
            "path_blocked": "the path ahead is blocked",
            "lane_ends": "the lane ends and the lane beside is not free",
            "no_progress": "the car does not get on",
            "scheduled": "the automated drive ends here",
            "controller": "the automation asks for it",
        },
        next={
            "lane_confidence": "steer and keep the lane",
            "sensor_health": "steer and keep the lane",
            "path_blocked": "brake or go around",
            "lane_ends": "find a gap or stop before the end",
            "no_progress": "find a way on",
            "scheduled": "steer and mind the road",
            "controller": "steer and mind the road",
        },
    ),
    "de": Texts(
        what={
            "warning": "Bereit halten zur Übernahme",
            "request": "Bitte übernehmen",
            "escalation": "Sofort übernehmen",
            "minimum_risk": "Das Fahrzeug hält im Fahrstreifen an",
        },
        why={
            "lane_confidence": "die Fahrbahnmarkierungen sind nicht zu erkennen",
            "sensor_health": "die Kamera fällt aus",
            "path_blocked": "der Weg voraus ist versperrt",
            "lane_ends": "der Fahrstreifen endet, und der Nachbarstreifen ist nicht frei",
            "no_progress": "das Fahrzeug kommt nicht weiter",
            "scheduled": "die automatisierte Fahrt endet hier",
            "controller": "die Automation fordert es an",
        },
        next={
            "lane_confidence": "lenken und den Fahrstreifen halten",
            "sensor_health": "lenken und den Fahrstreifen halten",
            "path_blocked": "bremsen oder ausweichen",
            "lane_ends": "eine Lücke suchen oder vor dem Ende anhalten",
            "no_progress": "einen Weg suchen, der weiterführt",
            "scheduled": "lenken und auf die Straße achten",
            "controller": "lenken und auf die Straße achten",
        },
    ),
    "fi": Texts(
        what={
            "warning": "Valmistaudu ottamaan ajoneuvo hallintaasi",
            "request": "Ota ajoneuvo hallintaasi nyt",
            "escalation": "Ota ajoneuvo hallintaasi heti",
            "minimum_risk": "Ajoneuvo pysähtyy kaistalle",
        },
        why={
            "lane_confidence": "kaistamerkintöjä ei näy",
            "sensor_health": "kamera on vikaantumassa",
            "path_blocked": "tie edessä on tukossa",
            "lane_ends": "kaista päättyy eikä viereinen kaista ole vapaa",
            "no_progress": "ajoneuvo ei pääse eteenpäin",
            "scheduled": "automaattinen ajo päättyy tähän",
            "controller": "automaatio pyytää sitä",
        },
        next={
            "lane_confidence": "ohjaa ja pysy kaistalla",
            "sensor_health": "ohjaa ja pysy kaistalla",
            "path_blocked": "jarruta tai väistä",
            "lane_ends": "etsi väli tai pysähdy ennen kaistan päätä",
            "no_progress": "etsi reitti eteenpäin",
            "scheduled": "ohjaa ja seuraa tietä",
            "controller": "ohjaa ja seuraa tietä",
        },
    ),
    "sv": Texts(
        what={
            "warning": "Var beredd att ta över",
            "request": "Ta över nu",
            "escalation": "Ta över omedelbart",
            "minimum_risk": "Bilen stannar i körfältet",
        },
        why={
            "lane_confidence": "vägmarkeringarna syns inte",
            "sensor_health": "kameran håller på att sluta fungera",
            "path_blocked": "vägen framåt är blockerad",
            "lane_ends": "körfältet upphör och körfältet bredvid är inte fritt",
            "no_progress": "bilen kommer inte vidare",
            "scheduled": "den automatiska körningen slutar här",
            "controller": "automatiken begär det",
        },
        next={
            "lane_confidence": "styr och håll körfältet",
            "sensor_health": "styr och håll körfältet",
            "path_blocked": "bromsa eller kör runt",
            "lane_ends": "hitta en lucka eller stanna före slutet",
            "no_progress": "hitta en väg vidare",
            "scheduled": "styr och håll ögonen på vägen",
            "controller": "styr och håll ögonen på vägen",
        },
    ),
}
"""The texts by language; every language has the same events and causes."""


def message_parts(event: str, cause: str, content: tuple[Content, ...]) -> tuple[str, ...]:
    """Return the names of the texts for an event, with the contents that the policy requires.

    They are keys of `Texts.named`; an event without a text has none.
    """
    texts = TEXTS["en"]
    if event not in texts.what:
        return ()
    wanted = {"what": f"what_{event}", "why": f"why_{cause}", "next": f"next_{cause}"}
    if event == "minimum_risk":
        del wanted["next"]
    return tuple(name for kind, name in wanted.items() if kind in content and name in texts.named)


def message_text(event: str, cause: str, content: tuple[Content, ...], language: Language = "en") -> str:
    """Return the sentence for an event, with the contents that the policy requires; empty if there is none."""
    named = TEXTS[language].named
    parts = [named[name] for name in message_parts(event, cause, content)]
    text = ": ".join(parts[:2]) if len(parts) < 3 else f"{parts[0]}: {parts[1]}, {parts[2]}"
    return text[:1].upper() + text[1:]


class Shown(NamedTuple):
    """A message to the driver.

    Attributes:
        modality: Channel of the message.
        text: Its text; for a tone or an icon, its meaning.
        language: Its language.
        parts: Names of the texts that it consists of, keys of `Texts.named`; none for an author's own text.
    """

    modality: Modality
    text: str
    language: Language
    parts: tuple[str, ...] = ()


class Messenger:
    """Gives the driver the messages of a policy, and ends each message together with its reason."""

    def __init__(self, plan: Plan) -> None:
        """Prepare the messages of a plan's policy."""
        self._policy = plan.takeover
        self._values = parameter_values(plan.parameters)
        self.shown: tuple[Shown, ...] = ()
        self._waiting: list[tuple[float, Shown]] = []

    def heed(self, row: EventRow) -> Iterator[EventRow]:
        """Yield the messages that begin or end because of an event of the takeover."""
        asks = row.kind in get_args(Told)
        if not asks and row.kind not in ENDS:
            return
        yield from self._end(row.t)
        if asks:
            self._waiting = list(self._begun(row))
            yield from self.come(row.t)

    def come(self, t: float) -> Iterator[EventRow]:
        """Yield the messages that are due."""
        due = [one for time, one in self._waiting if time <= t + SAME_TIME]
        if due:
            self._waiting = [one for one in self._waiting if one[0] > t + SAME_TIME]
            self.shown += tuple(due)
            yield from (
                EventRow.model_construct(t=t, kind="message", cause=one.modality, message=one.text) for one in due
            )

    def _end(self, t: float) -> Iterator[EventRow]:
        ended, self.shown, self._waiting = self.shown, (), []
        yield from (
            EventRow.model_construct(t=t, kind="message_over", cause=one.modality, message=one.text) for one in ended
        )

    def _begun(self, row: EventRow) -> Iterator[tuple[float, Shown]]:
        """Yield (time, message) of every message of an event; the modality `none` gives none."""
        for message in self._policy.messages:
            own = next((one.text for one in message.says if one.at == row.kind), "")
            text = own or message_text(row.kind, row.cause, message.content, message.language)
            parts = () if own else message_parts(row.kind, row.cause, message.content)
            time = row.t + number_value(message.after, self._values)
            for modality in message.modality if text else ():
                if modality != "none":
                    yield time, Shown(modality, text, message.language, parts)
