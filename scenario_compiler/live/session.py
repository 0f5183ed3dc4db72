"""A run in real time: the loop in a thread of its own, with a picture for the page after every few steps."""

from __future__ import annotations

import contextlib
import json
import math
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median, quantiles
from typing import Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field

from scenario_compiler.engine.columns.slots import K_RISK_AFTER
from scenario_compiler.engine.ego.person import nothing_asks
from scenario_compiler.live.sight import Sight
from scenario_compiler.live.sounds import files_of
from scenario_compiler.live.wheel import DRIVEN_BY_HAND, Wheel
from scenario_compiler.live.wording import WORDS, ended_text
from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.names import CAUSES, TAKEOVER_STATES, EventKind, StateName
from scenario_compiler.recording.outcome import judge
from scenario_compiler.report.palette import STATE_COLOURS
from scenario_compiler.report.run import Run
from scenario_compiler.report.wording import outcome_words
from scenario_compiler.roads import Network
from scenario_compiler.runtime import open_world
from scenario_compiler.runtime.loop import Execution
from scenario_compiler.runtime.messages import message_text
from scenario_compiler.trust import Trust
from scenario_compiler.vocabulary.takeover import Language, Modality, Told
from scenario_compiler.worlds import WorldError, WorldFinding

FRAME_TIME = 0.04
"""Least time between two pictures, s: 25 per second."""

MIRROR_EVERY = 2
"""Number of pictures of the view ahead for each picture of the mirror."""

BEHIND = 0.1
"""Delay from which the page reports that the machine is too slow, s."""

SLOWEST = 0.2
"""Greatest time between two pictures, s; a run that is behind skips pictures before it slows down."""

GIVEN_UP = 0.5
"""Delay that is no longer made up for, s: the clock of the run is set back by it."""

HELD_EVERY = 0.1
"""Time between two checks whether a stopped run may continue, each of which informs the page, s."""

ASKING = get_args(Told)
"""States that are announced if the policy has no messages of its own."""


@dataclass(frozen=True, slots=True)
class Picture:
    """The contents of the page for one row.

    Attributes:
        about: The row, as JSON for the page.
        ahead: The view ahead, a JPEG file.
        mirror: The mirror, a JPEG file; empty if it has not been drawn again.
    """

    about: dict[str, Any]
    ahead: bytes
    mirror: bytes


@dataclass(frozen=True, slots=True)
class Drive:
    """The settings of runs.

    Attributes:
        plan: The plan.
        network: Its map.
        world: Name of the world.
        options: Options of the world.
        seed: Seed of all random numbers.
        variant: Number of the variant, as in a sweep with the same seed.
        interpreted: Whether the engine runs as plain Python.
        trust: The user's own code that the plan may use.
        folder: Folder of the run; None to write nothing. A server of several runs makes a subfolder for each.
        size: Width and height of the view ahead, pixels.
        plain: Whether the view shows only the road, without the automation's detections and plans.
        found: Receives the world's deviations from the plan when a run has ended.
        otherwise: Language of the page if no message to the driver has words.
    """

    plan: Plan
    network: Network
    world: str = "kinematic"
    seed: int = 1
    variant: int = 0
    interpreted: bool = False
    trust: Trust | None = None
    folder: Path | None = None
    size: tuple[int, int] = (1280, 720)
    plain: bool = False
    options: Mapping[str, object] = field(default_factory=dict)
    found: Callable[[Sequence[WorldFinding]], None] | None = None
    otherwise: Language = "en"

    @property
    def language(self) -> Language:
        """The language of the page: that of the first message to the driver with written or spoken words."""
        messages = self.plan.takeover.messages
        return next((one.language for one in messages if {"text", "speech"} & {*one.modality}), self.otherwise)


class Given(BaseModel):
    """How the page presented a message to the driver."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    modality: Modality = Field(description="Its modality.")
    by: Literal["file", "browser", "text", "gamepad", "phone", "none"] = Field(description="By what it was given.")


class Session(threading.Thread):
    """One run in step with the clock.

    Attributes:
        wheel: The person at the wheel; None for a run that is only watched.
        folder: Folder of this run.
        going: Whether its last step is still to come; its files are written after that step.
        ended: Description of how it ended; empty until its files are written.
        fault: Why the world or its files broke it off; empty if they did not.
        now: Time of the run, s.
        state: State of the takeover.
        held: Why the run stands still, `paused` or `probe`; empty while it goes on.
        marks: Deviations from the procedure: `person_left`, `person_silent`, `requested`, `aborted`, `paused`.
    """

    def __init__(
        self,
        drive: Drive,
        show: Callable[[Picture], bool],
        number: int = 1,
        *,
        probe_at: float | None = None,
        kept: Callable[[Session, Run], None] | None = None,
        happened: Callable[[EventRow], None] | None = None,
    ) -> None:
        """Prepare a run.

        Args:
            drive: The settings.
            show: Receives a picture, in this thread; returns False if the page was too slow to take it.
            number: Number of the run, by which the page distinguishes runs.
            probe_at: Time at which the run stops until `go_on` is called, s; None for never.
            kept: Called in this thread with the run when it has ended and its files are written, before the page is
                informed; the session itself keeps no run.
            happened: Called in this thread with each event of the run, in the step in which it occurs, and with the
                last ones before its files are written.
        """
        super().__init__(name=f"run {number}", daemon=True)
        self.drive, self.number, self._show = drive, number, show
        self.folder = drive.folder
        self.now, self.state, self.held = 0.0, "automated", ""
        self.marks: set[str] = set()
        self._probe_at, self._kept, self._happens = probe_at, kept, happened
        self._paused = threading.Event()
        self._probed = threading.Event()
        self.wheel: Wheel | None = None
        if drive.plan.takeover.driver.by_person is not None:
            if self.folder is not None:
                make_folder(self.folder)
            inputs = None if self.folder is None else self.folder / "inputs.jsonl"
            self.wheel = Wheel(drive.plan, inputs)
        self.going, self.ended, self.fault = True, "", ""
        self.latencies: list[float] = []
        self.clock_offset = math.nan
        self._lost, self._shown = 0, 0
        self._late: list[float] = []
        self._slipped = 0.0
        self._silent = False
        self._stopping = threading.Event()
        self._happened: deque[tuple[EventKind, str, str]] = deque()
        self._ending = threading.Lock()

    def stop(self) -> None:
        """End the run as soon as possible."""
        self._stopping.set()

    def abort(self) -> None:
        """End the run, and mark it."""
        with self._ending:
            if self.going:
                self.marks.add("aborted")
                self.stop()

    def request(self) -> None:
        """Let the automation request a takeover now, which marks the run unless it has requested one already."""
        with self._ending:
            if self.wheel is not None and self.going:
                self.wheel.request()

    def pause(self) -> None:
        """Stop the run until it is resumed, and mark it: its person has had more time than its clock shows."""
        with self._ending:
            if self.going:
                self.marks.add("paused")
                self._paused.set()

    def resume(self) -> None:
        """Continue a paused run."""
        self._paused.clear()

    def go_on(self) -> None:
        """Continue a run that has stopped for its probe."""
        self._probed.set()

    def leave(self) -> None:
        """Record that the page of the person is gone."""
        with self._ending:
            if self.wheel is not None and self.going:
                self.wheel.leave()
                self.marks.add("person_left")
                self._happened.append(("person_left", "", ""))

    def come_back(self) -> None:
        """Record that the person has a page again."""
        with self._ending:
            if self.wheel is not None and self.going:
                self.wheel.come_back()
                self._happened.append(("person_back", "", ""))

    def give(self, given: Given) -> None:
        """Record how the page presented a message to the driver."""
        with self._ending:
            if self.going:
                self._happened.append(("message_given", given.modality, given.by))

    def run(self) -> None:
        """Execute the run, write its folder, and set how it ended."""
        drive, text, kept = self.drive, "", False
        automated = drive.plan.controller is not None
        try:
            with open_world(drive.world, drive.plan, drive.network, **drive.options) as world:
                execution = Execution(
                    drive.plan,
                    world,
                    drive.seed,
                    drive.variant,
                    interpreted=drive.interpreted,
                    trust=drive.trust,
                    person=self.wheel,
                )
                passed_on = self._go(execution)
                with self._ending:  # from here on, nothing that happens belongs to the run
                    self.going = False
                    if self.wheel is not None and self.wheel.requested:
                        self.marks.add("requested")
                    self._take_down(execution)
                self._show(Picture({"over": True, "run": self.number}, b"", b""))  # its files take a moment
                recording = execution.finish("user" if self._stopping.is_set() else "")
                self._pass_on(execution, passed_on)
                if drive.found is not None:
                    drive.found(world.findings)
            finished = Run(drive.plan, drive.network, recording, judge(drive.plan, recording))
            if self.wheel is not None:
                self.wheel.close()
            if self.folder is not None:
                from scenario_compiler.report.folder import write_run_folder  # takes a third of the server's start

                write_run_folder(finished, self.folder)
                write_whole(self.folder / "live.json", json.dumps(self.figures(), indent=1) + "\n")
            self.fault = next((one.message for one in recording.events if one.kind == "broken_off"), "")
            if self.fault:
                self.ended, text = self._broken_off()
            else:
                self.ended = outcome_words(finished.outcome, automated=automated)
                text = ended_text(finished.outcome, drive.language, automated=automated)
            if self._kept is not None:
                self._kept(self, finished)
            kept = True
        except (WorldError, OSError) as fault:
            self.fault = str(fault)
            self.ended, text = self._broken_off()
        finally:
            if self.wheel is not None:
                with contextlib.suppress(OSError):  # told already: the run has broken off
                    self.wheel.close()
            self._show(Picture({"end": text, "run": self.number, "kept": kept}, b"", b""))

    def _broken_off(self) -> tuple[str, str]:
        """Return how the run ended, for the program and for the page."""
        return f"the run broke off: {self.fault}", f"{WORDS[self.drive.language]['broke_off']}: {self.fault}"

    def figures(self) -> dict[str, Any]:
        """Return the timing of the page and the clock; times in milliseconds."""
        latency = sorted(self.latencies)
        late = [1e3 * one for one in self._late]
        return {
            "latency_count": len(latency),
            "latency_median_ms": round(median(latency), 2) if latency else None,
            "latency_p95_ms": round(quantiles(latency, n=20)[-1], 2) if len(latency) > 1 else None,
            "clock_offset_ms": None if math.isnan(self.clock_offset) else round(self.clock_offset, 2),
            "pictures_shown": self._shown,
            "pictures_lost": self._lost,
            "late_median_ms": round(median(late), 2) if late else None,
            "late_most_ms": round(max(late), 2) if late else None,
            "given_up_ms": round(1e3 * self._slipped, 2),
        }

    def _go(self, execution: Execution) -> int:
        """Execute the steps of the run; return the number of events that were passed on."""
        sight = Sight(execution, self.drive.size, plain=self.drive.plain)
        every = max(1, round(FRAME_TIME / self.drive.plan.step))
        steps, shown_at, events = 0, 0.0, 0
        self._publish(execution, sight, 0.0)
        begin = time.perf_counter()  # the first picture takes long, and the clock waits for it
        while execution.going and not self._stopping.is_set():
            begin += self._hold()
            self._take_down(execution)
            execution.advance()
            self._listen()
            steps += 1
            events = self._pass_on(execution, events)
            self.now, self.state = execution.state.clock[0], TAKEOVER_STATES[execution.state.takeover_state[0]]
            late = time.perf_counter() - begin - execution.state.clock[0]
            if late > GIVEN_UP:
                begin += late
                self._slipped += late
            elif late < 0.0:
                self._stopping.wait(-late)
            if steps % every == 0:
                self._late.append(max(late, 0.0))
                if late < BEHIND or self.now - shown_at >= SLOWEST - 1e-9:
                    shown_at = self.now
                    self._publish(execution, sight, late)
                else:
                    self._lost += 1
        return events

    def _listen(self) -> None:
        """Record, with the next step, when the page falls silent and when it is heard again."""
        silent = self.wheel is not None and self.wheel.silent
        if silent == self._silent:
            return
        self._silent = silent
        if silent:
            self.marks.add("person_silent")
        self._happened.append(("person_silent" if silent else "person_heard", "", ""))

    def _take_down(self, execution: Execution) -> None:
        """Add the events of the page to the recording."""
        while self._happened:
            kind, cause, message = self._happened.popleft()
            execution.note(kind, cause=cause, message=message)

    def _pass_on(self, execution: Execution, count: int) -> int:
        """Pass on the events of a run after the first `count`; return their number."""
        news = execution.builder.events_since(count)
        if self._happens is not None:
            for event in news:
                self._happens(event)
        return count + len(news)

    def _hold(self) -> float:
        """Stop while there is a reason to; return for how long, s.

        The page gets no picture meanwhile, so that nothing of the situation stays visible.
        """
        begin, stood = time.perf_counter(), False
        while not self._stopping.is_set():
            if self._probe_at is not None and self.now >= self._probe_at - 1e-9 and not self._probed.is_set():
                self.held = "probe"
            else:
                self.held = "paused" if self._paused.is_set() else ""
            if not self.held:
                break
            stood = True
            self._show(Picture({"held": self.held, "run": self.number}, b"", b""))
            self._stopping.wait(HELD_EVERY)
        self.held = ""
        return time.perf_counter() - begin if stood else 0.0

    def _publish(self, execution: Execution, sight: Sight, late: float) -> None:
        snapshot = execution.snapshot()
        mirror = sight.mirror(snapshot) if self._shown % MIRROR_EVERY == 0 else b""
        marked = any(one.modality == "overlay" for one in execution.messenger.shown)
        picture = Picture(self._about(execution, late), sight.view(snapshot, marked=marked), mirror)
        self._shown += 1
        if not self._show(picture):
            self._lost += 1

    def _about(self, execution: Execution, late: float) -> dict[str, Any]:
        """Return the data that the page shows in addition to the pictures."""
        st, plan = execution.state, self.drive.plan
        state = TAKEOVER_STATES[st.takeover_state[0]]
        entities = [
            [round(st.x[i], 2), round(st.y[i], 2), round(st.h[i], 3), round(st.v[i], 2)] if st.present[i] == 1 else None
            for i in range(len(plan.entities))
        ]
        told = self._told(execution, state, CAUSES[st.cause[0]])
        return {
            "run": self.number,
            "k": self._shown,
            "t": round(st.clock[0], 6),
            "seq": 0 if self.wheel is None else self.wheel.applied,
            "state": state,
            "colour": STATE_COLOURS[state],
            "speed": round(st.v[0], 3),
            "confidence": [round(st.conf_left[0], 3), round(st.conf_right[0], 3)],
            "byHand": state in DRIVEN_BY_HAND,
            "available": nothing_asks(execution.program, st) == 1,
            "entities": entities,
            "told": told,
            "left": self._time_left(execution, state),
            "late": round(1e3 * late, 1) if late > BEHIND else 0,
        }

    def _told(self, execution: Execution, state: StateName, cause: str) -> list[tuple[str, str, str, list[str]]]:
        """Return (modality, text, language, recorded files) of the present messages; a text if the policy has none."""
        if self.drive.plan.takeover.messages:
            shown = execution.messenger.shown
            return [(one.modality, one.text, one.language, files_of(one, state)) for one in shown]
        language = self.drive.language
        text = message_text(state, cause, ("what", "why"), language) if state in ASKING else ""
        return [("text", text, language, [])] if text else []

    def _time_left(self, execution: Execution, state: str) -> float | None:
        """Return the time until the minimum-risk manoeuvre begins at the latest, s; None without a request.

        It is also None if the policy has no such manoeuvre.
        """
        st, plan = execution.state, self.drive.plan
        none = not plan.takeover.minimum_risk or plan.takeover.automation.after == "let_go"
        if none or state not in ("request", "escalation"):
            return None
        after = execution.program.const[K_RISK_AFTER + st.cause[0]]
        return round(max(0.0, st.request_at[0] + after - st.clock[0]), 1)
