"""The interface of a person at the wheel, who is asked for inputs before each step."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from scenario_compiler.recording.names import Wish
    from scenario_compiler.recording.recording import Recording


class PersonInput(NamedTuple):
    """A person's inputs in a time step.

    Attributes:
        throttle: 0 to 1.
        brake: 0 to 1.
        steer: -1 to 1 of the vehicle's greatest steering angle, positive to the left.
        wish: The wish to the automation.
    """

    throttle: float = 0.0
    brake: float = 0.0
    steer: float = 0.0
    wish: Wish = ""


class Person(Protocol):
    """A person at the wheel."""

    def act(self, t: float, state: str) -> PersonInput:
        """Return the inputs in the step that begins at time `t`, s, in a state of the takeover."""
        ...


class RecordedPerson:
    """The person of a recording, who repeats the recorded inputs.

    Attributes:
        seed: Seed of the recorded run, with which the inputs repeat it.
    """

    def __init__(self, recording: Recording) -> None:
        """Take the recording's inputs; a recording without a person has none."""
        from scenario_compiler.recording.names import WISHES

        self._wishes = WISHES
        self._recording = recording
        self._row = 0
        self.seed = recording.header.seed

    @staticmethod
    def is_in(recording: Recording) -> bool:
        """Return whether a person was at the wheel of a recorded run."""
        return len(recording.t) > 0 and not math.isnan(recording.person_throttle[0])

    @property
    def has_ended_the_run(self) -> bool:
        """Whether the recorded run was ended by the user, and the last of its inputs has been given."""
        return self._recording.stop_reason == "user" and self._row + 1 >= len(self._recording.t)

    def act(self, t: float, state: str) -> PersonInput:
        """Return the inputs recorded in the next row; no input after the recording's end."""
        del t, state
        self._row += 1
        recording, row = self._recording, self._row
        if row >= len(recording.t):
            return PersonInput()
        return PersonInput(
            float(recording.person_throttle[row]),
            float(recording.person_brake[row]),
            float(recording.person_steer[row]),
            self._wishes[int(recording.person_wish[row])],
        )
