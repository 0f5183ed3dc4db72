"""Files that are huge, deep, endless or contradict themselves ask for bounded work, and are run or diagnosed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from scenario_compiler.cli import make_parser
from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.opcodes import FAULT_NONE, STOP_DURATION
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.step import reset, step
from tests.openscenario.made import condition, declarations, entity, event, scenario_text, speed, story
from tests.work import counted

FEW, MANY = 100, 800
"""Numbers of elements whose work is compared: the second takes eight times as much where work is linear."""

MORE = 12.0
"""Factor of work between them that is far from quadratic (64)."""


def compiled(
    tmp_path: Path, text: str, duration: float = 1.0, step: float = 0.05
) -> tuple[Compilation | None, Counter[str]]:
    """Return what a text compiles to, and how often each code was found."""
    file = tmp_path / "made.xosc"
    file.write_text(text, encoding="utf-8")
    sink = Diagnostics()
    done = compile_target(file, {}, sink, overrides=Overrides(perception="ideal", step=step, duration=duration))
    return done, Counter(one.code.id for one in sink)


def run(done: Compilation) -> State:
    """Return the state at the end of a run."""
    program, n = build_program(done.plan, done.network), done.network.tables
    state = new_state(program)
    state.draw[:] = make_draws(1, 0)
    reset(n, program, state)
    while step(n, program, state) == 1:
        pass
    return state


def at_start(number: int) -> str:
    """Return a condition that is met a bit later for each number."""
    timed = f'<SimulationTimeCondition value="{number * 1e-5}" rule="greaterThan"/>'
    return condition(f"<ByValueCondition>{timed}</ByValueCondition>")


def after(name: str, kind: str = "event", state: str = "completeState") -> str:
    """Return a condition on the state of an element."""
    inner = f'storyboardElementType="{kind}" storyboardElementRef="{name}" state="{state}"'
    return condition(f"<ByValueCondition><StoryboardElementStateCondition {inner}/></ByValueCondition>")


def many_events(count: int) -> str:
    """Return a scenario with many events in one maneuver, all of which start."""
    return scenario_text(story(*(event(f"e{k}", at_start(k), priority="parallel") for k in range(count))))


def many_overriding(count: int) -> str:
    """Return a scenario whose events end one another."""
    return scenario_text(story(*(event(f"e{k}", at_start(k), priority="override") for k in range(count))))


def many_waiting(count: int) -> str:
    """Return a scenario whose events wait for one another in a row."""
    waiting = (event(f"e{k}", after(f"e{k - 1}"), priority="parallel") for k in range(1, count))
    return scenario_text(story(event("e0"), *waiting))


def many_maneuvers(count: int) -> str:
    """Return a scenario with many maneuvers."""
    inside = "".join(
        f'<Maneuver name="m{k}">{event(f"e{k}", at_start(k), priority="parallel")}</Maneuver>' for k in range(count)
    )
    return scenario_text(story(maneuver=inside))


def many_stories(count: int) -> str:
    """Return a scenario with many stories."""
    return scenario_text(*(story(event()).replace('"story"', f'"story{k}"') for k in range(count)))


def many_entities(count: int) -> str:
    """Return a scenario with many vehicles in rows."""
    return scenario_text(road="", entities="".join(entity(f"a{k}") for k in range(count)), init=_rows(count))


def _rows(count: int) -> str:
    return "".join(
        f'<Private entityRef="a{k}"><PrivateAction><TeleportAction><Position>'
        f'<WorldPosition x="{8 * (k // 20)}" y="{4 * (k % 20)}"/></Position></TeleportAction></PrivateAction>'
        f"{speed('3', '1')}</Private>"
        for k in range(count)
    )


def lines_of(tmp_path: Path, text: str) -> int:
    """Return the lines of Python that are run to compile a text and to run it for a second."""

    def work() -> None:
        done, _ = compiled(tmp_path, text)
        assert done is not None
        assert run(done).flag[0] == FAULT_NONE

    _, lines = counted(work)
    return lines


@pytest.mark.slow
@pytest.mark.parametrize(
    "make", [many_events, many_overriding, many_waiting, many_maneuvers, many_stories, many_entities]
)
def test_work_grows_as_the_file_does(tmp_path: Path, make: Callable[[int], str]) -> None:
    lines_of(tmp_path, make(1))
    assert lines_of(tmp_path, make(MANY)) < MORE * lines_of(tmp_path, make(FEW))


@pytest.mark.slow
def test_ten_thousand_events_are_run(tmp_path: Path) -> None:
    done, _ = compiled(tmp_path, many_events(10_000))
    assert done is not None
    assert run(done).stop[0] == STOP_DURATION


@pytest.mark.parametrize("make", [many_events, many_overriding, many_waiting, many_maneuvers, many_stories])
def test_hundreds_of_elements_are_run(tmp_path: Path, make: Callable[[int], str]) -> None:
    done, _ = compiled(tmp_path, make(200))
    assert done is not None
    assert run(done).stop[0] == STOP_DURATION


@pytest.mark.parametrize("count", ["2147483647", "1"])
def test_events_that_restart_each_other_end_with_the_run(tmp_path: Path, count: str) -> None:
    ring = [event(f"e{k}", after(f"e{(k + 1) % 3}"), speed("1", "0"), maximumExecutionCount=count) for k in range(3)]
    first = event("first", at_start(0), speed("1", "0"), maximumExecutionCount=count)
    done, _ = compiled(tmp_path, scenario_text(story(first, *ring)))
    assert done is not None
    assert run(done).stop[0] == STOP_DURATION


def test_events_that_wait_for_each_other_never_start(tmp_path: Path) -> None:
    done, _ = compiled(tmp_path, scenario_text(story(event("a", after("b")), event("b", after("a")))))
    assert done is not None
    assert run(done).stop[0] == STOP_DURATION


@pytest.mark.parametrize("size", ["0", "-0.05", "1e-12", "nan", "inf"])
def test_a_step_without_length_is_refused(size: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        make_parser().parse_args(["run", "made.xosc", f"--dt={size}"])
    assert "--dt" in capsys.readouterr().err


@pytest.mark.parametrize(
    "text",
    ["(" * 5000 + "1" + ")" * 5000, "-" * 5000 + "1", "1 +" * 5000 + "1", "1 - (" * 300 + "1" + ")" * 300],
    ids=["brackets", "signs", "sums", "differences"],
)
def test_endless_expressions_are_reported(tmp_path: Path, text: str) -> None:
    done, found = compiled(tmp_path, scenario_text(story(event(action=speed(f"${{{text}}}")))))
    assert done is None
    assert found["SC113"] == 1


def test_parameters_that_double_each_other_are_compiled(tmp_path: Path) -> None:
    doubled = (f"p{k}:double=${{$p{k - 1} + $p{k - 1}}}" for k in range(1, 200))
    text = scenario_text(story(event()), declared=declarations("p0:double=1", *doubled))
    done, _ = compiled(tmp_path, text)
    assert done is not None


def test_elements_inside_each_other_are_refused(tmp_path: Path) -> None:
    deep = '<ScenarioObject name="a">' * 5000 + "</ScenarioObject>" * 5000
    done, found = compiled(tmp_path, scenario_text(entities=deep))
    assert done is None
    assert found["SC102"] == 1


def test_a_text_of_megabytes_is_read(tmp_path: Path) -> None:
    long = scenario_text(story(event())).replace('description=""', f'description="{"x" * 5_000_000}"')
    done, _ = compiled(tmp_path, long)
    assert done is not None


def test_thousands_of_unknown_elements_give_a_few_findings(tmp_path: Path) -> None:
    _, found = compiled(tmp_path, scenario_text(story(event()), init='<Nonsense a="1"/>' * 5000))
    assert 0 < sum(found.values()) < 500
