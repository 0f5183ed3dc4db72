"""Prints the language server's answers per CPU second: `python tests/benchmarks/editor_figures.py`.

The file is one of the library's, repeated to 500 lines. Each figure is the median CPU time of several answers to a
text that has just changed, so that nothing is kept from the answer before. The ratio is to the 100 ms that an answer
may take.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

from scenario_compiler.editor.analysis import Analysis
from scenario_compiler.editor.completion import offers
from scenario_compiler.editor.draft import Draft
from scenario_compiler.editor.findings import findings
from scenario_compiler.editor.hover import explained
from scenario_compiler.editor.layout import layout_edits
from scenario_compiler.editor.naming import renaming
from scenario_compiler.editor.outline import outline
from scenario_compiler.resources import library_folder

FILE = library_folder() / "conflicts" / "obstacle_variants.xml"
LINES = 500
MOST = 0.1
"""Time that an answer may take on an idle core, s."""


def long_text() -> str:
    """Return a text of `LINES` lines: the scenarios of a file of the library again and again, under other names."""
    text = FILE.read_text(encoding="utf-8")
    head, tail = text[: text.index("  <scenario ")], "</scenarios>\n"
    body = text[len(head) : text.rindex(tail)]
    copies, number = "", 0
    while (head + copies + tail).count("\n") < LINES:
        copies += body.replace('<scenario name="', f'<scenario name="copy{number}_')
        number += 1
    cut = "\n".join((head + copies).split("\n")[:LINES])
    return cut[: cut.rindex("</scenario>") + len("</scenario>")] + "\n" + tail


def asked(text: str) -> dict[str, Callable[[], object]]:
    """Return what is asked of a text, each from the text alone."""
    value = text.rindex('template="') + len('template="')
    named = text.rindex("$distance") + 2

    def new_name() -> object:
        analysis = Analysis(str(FILE), text)
        mention = analysis.mention_at(named)
        assert mention is not None
        return renaming(mention.symbol, "another", [analysis])

    return {
        "completion of an element": lambda: offers(Analysis(str(FILE), text), text.rindex("<takeover") + 1),
        "completion of a template": lambda: offers(Analysis(str(FILE), text), value),
        "hover": lambda: explained(Analysis(str(FILE), text), value),
        "definition": lambda: Analysis(str(FILE), text).mention_at(named),
        "rename": new_name,
        "formatting": lambda: layout_edits(Draft(text)),
        "symbols": lambda: outline(Analysis(str(FILE), text)),
        "findings": lambda: findings(str(FILE), Draft(text)),
    }


def main(runs: int = 9) -> None:
    """Print the table."""
    text = long_text()
    print(f"{text.count(chr(10))} lines, {len(text)} characters, {text.count('<scenario ')} scenarios")
    for what, work in asked(text).items():
        work()
        times = []
        for _ in range(runs):
            before = time.process_time()
            work()
            times.append(time.process_time() - before)
        median = statistics.median(times)
        print(f"{what:26} {1000 * median:6.1f} ms   {median / MOST:5.2f} of {1000 * MOST:.0f} ms")


if __name__ == "__main__":
    main()
