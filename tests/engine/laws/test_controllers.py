"""Controllers of entities that the storyboard moves: which of several is switched."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.engine.laws.told import Actor, Event, Played, document, play_text

FOLLOWING = '<Property name="esminiController" value="ACCController"/>'
KEEPING = '<Property name="esminiController" value="DefaultController"/>'


def held(name: str, written: str = "a controller", kind: str = FOLLOWING) -> str:
    """Return an <ObjectController> with its own name, and the name of its controller."""
    own = f' name="{name}"' if name else ""
    controller = f'<Controller name="{written}"><Properties>{kind}</Properties></Controller>'
    return f"<ObjectController{own}>{controller}</ObjectController>"


def switched(name: str, on: str) -> str:
    """Return that a controller's longitudinal domain is switched, of the one without a name if there is none."""
    ref = f' objectControllerRef="{name}"' if name else ""
    return f'<ControllerAction><ActivateControllerAction{ref} longitudinal="{on}" lateral="false"/></ControllerAction>'


def driven(folder: Path, controllers: str, *switches: str) -> Played:
    """Run A at 20 m/s, with controllers that are switched from 1 s on, one in a second, 100 m behind B at 10 m/s."""
    actors = {"A": Actor(speed=20.0), "B": Actor(s=150.0)}
    text = document(actors, [Event("A", one, 1.0 + k) for k, one in enumerate(switches)], 30.0)
    return play_text(folder, text.replace("</Vehicle>", f"</Vehicle>{controllers}", 1), 30.0)


@pytest.mark.parametrize(
    "controllers",
    [
        held("acc") + held("keeper", kind=KEEPING),
        held("keeper", kind=KEEPING) + held("acc"),
        held("", "acc") + held("", "keeper", kind=KEEPING),
    ],
)
def test_a_controller_is_switched_by_its_name(tmp_path: Path, controllers: str) -> None:
    """Whichever was assigned last; a name is that of the <ObjectController>, or else that of its <Controller>."""
    run = driven(tmp_path, controllers, switched("acc", "true"), switched("keeper", "false"))
    assert run.at("A", 30.0).v == pytest.approx(10.0, abs=0.1)


def test_a_controller_takes_the_domain_over_from_another_one(tmp_path: Path) -> None:
    controllers = held("acc") + held("keeper", kind=KEEPING)
    run = driven(tmp_path, controllers, switched("acc", "true"), switched("keeper", "true"))
    assert run.at("A", 5.0).v == run.at("A", 2.0).v


def test_without_a_name_the_controller_that_was_assigned_last_is_switched(tmp_path: Path) -> None:
    assert driven(tmp_path, held("keeper", kind=KEEPING) + held("acc"), switched("", "true")).at("A", 30.0).v < 10.1
    assert driven(tmp_path, held("acc") + held("keeper", kind=KEEPING), switched("", "true")).at("A", 20.0).v == 20.0
