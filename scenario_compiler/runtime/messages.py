"""The messages to the driver, by language, event, cause and content: one table of texts."""

from __future__ import annotations

from dataclasses import dataclass

from scenario_compiler.vocabulary.takeover import Content, Language, Takeover


@dataclass(frozen=True)
class Texts:
    """The texts of one language.

    Attributes:
        what: What happens, by event.
        why: Why, by cause.
        next: What to do, by cause.
    """

    what: dict[str, str]
    why: dict[str, str]
    next: dict[str, str]


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
            "no_progress": "einen Weg weiter suchen",
            "scheduled": "lenken und auf die Straße achten",
            "controller": "lenken und auf die Straße achten",
        },
    ),
}
"""The texts by language; every language has the same events and causes."""


def message_text(event: str, cause: str, content: tuple[Content, ...], language: Language = "en") -> str:
    """Return the sentence for an event with the contents that the policy asks for; empty when there is none."""
    texts = TEXTS[language]
    if event not in texts.what:
        return ""
    parts = []
    if "what" in content:
        parts.append(texts.what[event])
    if "why" in content and cause in texts.why:
        parts.append(texts.why[cause])
    if "next" in content and cause in texts.next and event != "minimum_risk":
        parts.append(texts.next[cause])
    text = ": ".join(parts[:2]) if len(parts) < 3 else f"{parts[0]}: {parts[1]}, {parts[2]}"
    return text[:1].upper() + text[1:]


def messages(policy: Takeover, event: str, cause: str) -> list[tuple[str, str]]:
    """Return (modality, text) of every message that a policy gives at an event; the modality `none` gives none."""
    told = [
        (modality, message_text(event, cause, message.content, message.language))
        for message in policy.messages
        for modality in message.modality
        if modality != "none"
    ]
    return [(modality, text) for modality, text in told if text]
