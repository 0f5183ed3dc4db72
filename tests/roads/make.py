"""Small road files for tests, as text."""

from __future__ import annotations

from pathlib import Path

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.roads import Network, load_network

LINE = '<geometry s="0" x="0" y="0" hdg="0" length="{length}"><line/></geometry>'


def lane(number: int, inside: str = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>', kind: str = "driving") -> str:
    """Return a lane with what it holds."""
    return f'<lane id="{number}" type="{kind}" level="false">{inside}</lane>'


def section(left: str = "", right: str = "", s: float = 0.0, attributes: str = "", centre: str = "") -> str:
    """Return a lane section."""
    sides = f"<left>{left}</left>" if left else ""
    sides += f'<center><lane id="0" type="none">{centre}</lane></center>'
    sides += f"<right>{right}</right>" if right else ""
    return f'<laneSection s="{s}" {attributes}>{sides}</laneSection>'


def road(
    number: str = "1",
    length: float = 100.0,
    plan: str = "",
    lanes: str = "",
    link: str = "",
    attributes: str = 'junction="-1"',
    more: str = "",
) -> str:
    """Return a road; by default straight along x with one lane each way."""
    plan = plan or LINE.format(length=length)
    lanes = lanes or section(lane(1), lane(-1))
    return (
        f'<road id="{number}" length="{length}" {attributes}><link>{link}</link>'
        f"<planView>{plan}</planView>{more}<lanes>{lanes}</lanes></road>"
    )


def network(folder: Path, *parts: str, sink: Diagnostics | None = None) -> Network:
    """Write the parts as a file and read it."""
    path = folder / "made.xodr"
    path.write_text(
        '<OpenDRIVE><header revMajor="1" revMinor="7"/>' + "\n".join(parts) + "</OpenDRIVE>", encoding="utf-8"
    )
    made = load_network(path, cache=False, sink=sink)
    assert made is not None
    return made


def shifted(text: str, x: float, y: float) -> str:
    """Return the text of a road file whose reference lines are moved in the plane."""
    root = etree.fromstring(text.encode())
    for geometry in root.iter("geometry"):
        geometry.set("x", repr(float(geometry.get("x", "0")) + x))
        geometry.set("y", repr(float(geometry.get("y", "0")) + y))
    return etree.tostring(root, encoding="unicode")
