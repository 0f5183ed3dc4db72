"""What the driver is told, by event, cause and content."""

from __future__ import annotations

from scenario_compiler.vocabulary.takeover import Content, Takeover

WHAT: dict[str, str] = {
    "warning": "Be ready to take over",
    "request": "Take over now",
    "escalation": "Take over immediately",
    "minimum_risk": "Stopping in the lane",
}
"""What happens, by event."""

WHY: dict[str, str] = {
    "lane_confidence": "the lane markings cannot be seen",
    "sensor_health": "the camera is failing",
    "path_blocked": "the path ahead is blocked",
    "lane_ends": "the lane ends and the lane beside is not free",
    "controller": "the automation asks for it",
}
"""Why, by cause."""

NEXT: dict[str, str] = {
    "lane_confidence": "steer and keep the lane",
    "sensor_health": "steer and keep the lane",
    "path_blocked": "brake or go around",
    "lane_ends": "find a gap or stop before the end",
    "controller": "steer and mind the road",
}
"""What to do, by cause."""


def message_text(event: str, cause: str, content: tuple[Content, ...]) -> str:
    """Return the sentence for an event with the contents that the policy asks for; empty when there is none."""
    if event not in WHAT:
        return ""
    parts = []
    if "what" in content:
        parts.append(WHAT[event])
    if "why" in content and cause in WHY:
        parts.append(WHY[cause])
    if "next" in content and cause in NEXT and event != "minimum_risk":
        parts.append(NEXT[cause])
    text = ": ".join(parts[:2]) if len(parts) < 3 else f"{parts[0]}: {parts[1]}, {parts[2]}"
    return text[:1].upper() + text[1:]


def messages(policy: Takeover, event: str, cause: str) -> list[tuple[str, str]]:
    """Return (modality, text) of every message that a policy gives at an event."""
    told = [
        (modality, message_text(event, cause, message.content))
        for message in policy.messages
        for modality in message.modality
    ]
    return [(modality, text) for modality, text in told if text]
