"""Embeds the player's files and data into a page, which then needs no other file.

Its JavaScript modules in `pages/` refer to each other as "pages/NAME.js". A page's import map gives each of these names
a data URL with the module.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from pathlib import Path

from markupsafe import Markup

from scenario_compiler.report.palette import WORDS
from scenario_compiler.report.replay import Picture, packed, replay_of
from scenario_compiler.report.run import Run

FOLDER = Path(__file__).parent / "pages"
MODULES = ("data.js", "map.js", "curves.js", "timeline.js", "player.js")
"""The player's own modules; uPlot is a separate script in `vendor/`."""


def player_head() -> Markup:
    """Return the player's part of a page's head: styles, the import map, uPlot."""
    imports = {f"pages/{name}": _data_url(FOLDER / name) for name in MODULES}
    styles = (FOLDER / "vendor" / "uPlot.min.css", FOLDER / "player.css")
    parts = [
        *(f"<style>\n{path.read_text(encoding='utf-8').strip()}\n</style>" for path in styles),
        f'<script type="importmap">{json.dumps({"imports": imports})}</script>',
        f"<script>\n{(FOLDER / 'vendor' / 'uPlot.iife.min.js').read_text(encoding='utf-8').strip()}\n</script>",
    ]
    return Markup("\n".join(parts))


def player_start() -> Markup:
    """Return the end of a page's body, which starts the players."""
    return Markup('<script type="module">import "pages/player.js";</script>')


def page_script(name: str) -> Markup:
    """Return a module without imports as a script of a page."""
    return Markup(f'<script type="module">\n{(FOLDER / name).read_text(encoding="utf-8").strip()}\n</script>')


def player_place(
    runs: Sequence[Run], pictures: Sequence[Sequence[Picture]], anchor: str = "", names: Sequence[str] = ()
) -> Markup:
    """Return a place for a player with the data of its runs; without JavaScript it shows a note.

    Args:
        runs: One run, or two beside each other, each with at least one row.
        pictures: The first-person pictures of each, ordered by time.
        anchor: Id of the run's section in the page's address; empty for the only one.
        names: Names of two runs.
    """
    parts = []
    for number, (run, taken) in enumerate(zip(runs, pictures, strict=True)):
        name = names[number] if names else run.outcome.name
        data = packed(replay_of(run, name, pictured=bool(taken)))
        parts.append(f'<script type="text/plain" class="run">{data}</script>')
        shown = [{"t": one.t, "label": WORDS.get(one.label, one.label), "src": source_of(one)} for one in taken]
        text = json.dumps(shown).replace("<", "\\u003c")
        parts.append(f'<script type="application/json" class="pictures">{text}</script>')
    attribute = f' data-anchor="{anchor}"' if anchor else ""
    return Markup(
        f'<section class="player" tabindex="0" aria-label="Player"{attribute}>\n'
        + '<p class="quiet">The player needs a browser with JavaScript.</p>\n'
        + "\n".join(parts)
        + "\n</section>"
    )


def source_of(picture: Picture) -> str:
    """Return a picture as a data URL."""
    return f"data:{picture.type};base64,{base64.b64encode(picture.data).decode()}"


def _data_url(path: Path) -> str:
    return f"data:text/javascript;base64,{base64.b64encode(path.read_bytes()).decode()}"
