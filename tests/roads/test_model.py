from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.diagnostics import CompileError
from scenario_compiler.roads.model import Marking
from tests.roads.make import network, road

OBJECTS = (
    '<objects><object id="c" type="crosswalk" name="zebra" s="20" t="1" zOffset="0" hdg="1.5" orientation="none" '
    'length="4" width="7"><outlines><outline id="0"><cornerRoad id="0" s="18" t="-3" dz="0" height="0"/>'
    '<cornerLocal u="2" v="1" z="0" height="0.1"/></outline></outlines><validity fromLane="-1" toLane="1"/>'
    '<userData code="k" value="v"/><repeat s="0" length="8" distance="4" heightStart="1" heightEnd="2"/>'
    '<markings><marking side="left" color="white" width="0.1" lineLength="0.5" spaceLength="0.4" startOffset="0.2" '
    'stopOffset="0.3"><cornerReference id="0"/><cornerReference id="1"/></marking></markings><borders/></object>'
    '<bridge id="b" name="B" s="30" length="10" type="concrete"/></objects>'
    '<signals><signal id="s" type="274" subtype="50" country="DE" value="50" unit="km/h" s="5" t="-4" dynamic="no"/>'
    '<signalReference id="s" s="6" t="4" orientation="+"/></signals>'
)
JUNCTION = (
    '<junction id="J" name="cross" type="virtual" mainRoad="1" sStart="10" sEnd="20">'
    '<connection id="0" incomingRoad="1" connectingRoad="1" contactPoint="start" type="virtual">'
    '<laneLink from="-1" to="1"/></connection><priority high="1" low="2"/><controller id="K"/></junction>'
    '<controller id="K" name="lights"><control signalId="s" type="0"/></controller>'
)


def test_what_the_tables_leave_out_is_read_on_demand(tmp_path: Path) -> None:
    model = network(tmp_path, road(more=OBJECTS), JUNCTION).model()
    thing = model.objects[0]
    assert (thing.road, thing.id, thing.type, thing.length, thing.lanes) == ("1", "c", "crosswalk", 4.0, ((-1, 1),))
    assert [corner.local for corner in thing.outlines[0].corners] == [False, True]
    assert (thing.user_data, thing.rest) == ((("k", "v"),), ("borders",))
    assert thing.markings == (Marking("left", ("0", "1"), "white", 0.1, 0.5, 0.4, 0.2, 0.3),)
    assert thing.outlines[0].corners[0].id == "0"
    assert thing.repeats[0].height_end == 2.0
    assert [place.share for place in thing.repeats[0].places()] == [0.0, 0.5, 1.0]
    assert [(s.id, s.reference, s.value) for s in model.signals] == [("s", False, "50"), ("s", True, "")]
    assert [(s.kind, s.length) for s in model.structures] == [("bridge", 10.0)]
    junction = model.junctions[0]
    assert (junction.type, junction.s_end, junction.priorities) == ("virtual", 20.0, (("1", "2"),))
    assert junction.connections[0].lanes == ((-1, 1),)
    assert model.controllers[0].controls == (("s", "0"),)
    assert model.header.version == (1, 7)


def test_a_file_that_has_changed_meanwhile_is_refused(tmp_path: Path) -> None:
    made = network(tmp_path, road())
    Path(made.path).write_text("<OpenDRIVE/>", encoding="utf-8")
    with pytest.raises(CompileError, match="SC315"):
        made.model()
