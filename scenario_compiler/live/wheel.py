"""The person at the wheel, as reported by the page: pedals, steering wheel, taking over and handing back."""

from __future__ import annotations

import json
import math
import os
import threading
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field

from scenario_compiler.controllers.person import PersonInput
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.names import Wish
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.word import number_value

KEPT_EVERY = 0.5
"""Time of the run after which inputs are written to the disk, s."""

DRIVEN_BY_HAND = ("manual", "hand_back")

SILENT_AFTER = 0.5
"""Time of the run without a message from which pedals and steering wheel count as released, s.

A page says every 0.02 s where they are. Of a page that says nothing it is not known whether its person still presses
them, so nothing more is recorded as that person's input, and the vehicle does not go on accelerating: a dead man's
control. 0.5 s is our own choice: pauses of a browser and of a radio network are shorter.
"""

LEFT_AFTER = 2.0
"""Time of the run without a message from which a vehicle that is driven manually stops, as if the page were closed, s.

Nobody steers it meanwhile. Our own choice; a page in a hidden tab, which browsers let speak once a second, does not
reach it.
"""


class Told(BaseModel):
    """The page's message on the person's inputs, of at most a few hundred bytes."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    seq: int = Field(ge=0, description="Number of the message, counted by the page.")
    throttle: float = Field(default=0.0, ge=0.0, le=1.0, description="Throttle.")
    brake: float = Field(default=0.0, ge=0.0, le=1.0, description="Brake.")
    steer: float = Field(default=0.0, ge=-1.0, le=1.0, description="Steering, positive to the left.")
    take_over: bool = Field(default=False, description="The button to take over is pressed.")
    hand_back: bool = Field(default=False, description="The button to hand back is pressed.")


class InputFile:
    """A file whose lines are on the disk soon after they are written; the writer does not wait for a busy disk."""

    def __init__(self, path: Path) -> None:
        """Create an empty file."""
        self._file = path.open("wb")
        self._due = threading.Event()
        self._fault: OSError | None = None
        self._syncing: threading.Thread | None = None

    def write(self, line: bytes) -> None:
        """Write a line.

        Raises:
            OSError: Earlier lines could not be written to the disk.
        """
        if self._fault is not None:
            raise self._fault
        self._file.write(line + b"\n")

    def keep(self) -> None:
        """Have the written lines stored on the disk."""
        self._file.flush()
        if self._syncing is None:
            self._syncing = threading.Thread(target=self._sync, name="inputs", daemon=True)
            self._syncing.start()
        self._due.set()

    def close(self) -> None:
        """Store the rest on the disk and close the file; closing it again has no effect."""
        if self._file.closed:
            return
        syncing, self._syncing = self._syncing, None
        if syncing is not None:
            self._due.set()
            syncing.join()
        with self._file:
            self._file.flush()
            os.fsync(self._file.fileno())

    def _sync(self) -> None:
        while True:
            self._due.wait()
            self._due.clear()
            if self._syncing is None:  # asked after the event is cleared: a file closed just before has set it
                return
            try:
                os.fsync(self._file.fileno())
            except OSError as fault:
                self._fault = fault
                return


class Wheel:
    """Connects the page, which reports at any time, and the run, which asks once in each step.

    The inputs of the run are written to a file at the same time, as one JSON object for each step.

    Attributes:
        applied: Number of the page's last message that the run has used.
        requested: Whether the automation has been asked for a request while it drove without one.
        silent: Whether the page says too little, so that its pedals and steering wheel count as released: from
            `SILENT_AFTER` on without a message, until two follow each other sooner.
    """

    def __init__(self, plan: Plan, kept: Path | None = None) -> None:
        """Wait for a person.

        Args:
            plan: The plan, which defines when a pedal or the wheel counts as an input that takes over.
            kept: File for the inputs; None to keep them only in the recording.
        """
        self.applied, self.requested, self.silent = 0, False, False
        values, inputs = parameter_values(plan.parameters), plan.takeover.inputs
        angle = number_value(inputs.steering, values) / number_value(inputs.steering_ratio, values)
        self._steer_from = angle / max(math.radians(plan.entities[0].vehicle.max_steer), 0.01)
        self._brake_from = number_value(inputs.brake, values)
        self._lock = threading.Lock()
        self._told = Told(seq=0)
        self._fresh = False
        self._heard_at: float | None = None
        self._asked: Wish = ""
        self._control_every, self._asks_for = plan.control_every, 0
        self._away = False
        self._left = False
        self._requesting = False
        self._file = None if kept is None else InputFile(kept)
        self._kept_until = 0.0

    def tell(self, told: Told) -> None:
        """Store the page's report; buttons are kept until the run has processed them.

        The automation answers in its next control step whether it accepts control. A refused wish is not repeated: it
        would take the wheel from a person who drives on, as soon as its reason to refuse ends.
        """
        with self._lock:
            self._told, self._fresh = told, True
            if told.take_over:
                self._asked = "take_over"
            elif told.hand_back:
                self._asked, self._asks_for = "hand_back", self._control_every

    def request(self) -> None:
        """Let the automation request a takeover if it drives."""
        with self._lock:
            self._requesting = True

    def leave(self) -> None:
        """Record that the page is gone: a vehicle that is driven manually stops, even if a page returns soon."""
        with self._lock:
            self._away = self._left = True
            self._told, self._asked = Told(seq=self._told.seq), ""
            self._heard_at, self._fresh = None, False

    def come_back(self) -> None:
        """Record that a page has returned; its message numbers start again."""
        with self._lock:
            self._away, self._told = False, Told(seq=0)

    def act(self, t: float, state: str) -> PersonInput:
        """Return the person's inputs for the step that begins at t, s."""
        with self._lock:
            by_hand = state in DRIVEN_BY_HAND
            unheard = self._listen(t)
            self._left = (self._left or unheard > LEFT_AFTER) and by_hand
            told, away = Told(seq=self._told.seq) if self.silent else self._told, self._away or self._left
            if by_hand == (self._asked == "take_over") or (self._asked == "hand_back" and self._asks_for == 0):
                self._asked = ""
            self._asks_for -= 1
            wish: Wish = self._asked
            self._requesting = self._requesting and state in ("automated", "warning")
            requesting = self._requesting
        if away:
            wish = "leave" if by_hand else ""
        elif not by_hand and self._is_input(told):
            wish = "take_over"
        elif requesting and not wish:
            wish, self.requested = "request", True
        done = PersonInput(told.throttle, told.brake, told.steer, wish)
        self.applied = told.seq
        self._keep(t, done)
        return done

    def close(self) -> None:
        """Store the remaining inputs on the disk."""
        if self._file is not None:
            self._file.close()

    def _listen(self, t: float) -> float:
        """Note whether the page has spoken since the last step, and return for how long it has been silent, s."""
        since = 0.0 if self._heard_at is None else t - self._heard_at
        if self._fresh:
            self._fresh, self._heard_at = False, t
            self.silent = self.silent and since > SILENT_AFTER
            return 0.0
        self.silent = self.silent or since > SILENT_AFTER
        return since

    def _is_input(self, told: Told) -> bool:
        return told.brake >= self._brake_from or abs(told.steer) >= self._steer_from

    def _keep(self, t: float, done: PersonInput) -> None:
        if self._file is None:
            return
        self._file.write(json.dumps({"t": round(t, 9), **done._asdict()}).encode())
        if t - self._kept_until >= KEPT_EVERY:
            self._kept_until = t
            self._file.keep()
