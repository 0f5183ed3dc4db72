"""A survey as files: the page, the JSON, and each scenario's tags."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path

from scenario_compiler.files import split_target
from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.report.templates import page_environment
from scenario_compiler.survey.odd import NOT_LOOKED_FOR
from scenario_compiler.survey.openlabel import openlabel_of
from scenario_compiler.survey.survey import ConditionCoverage, Survey

PAGE, DATA, TAGS = "library.html", "library.json", "openlabel"
"""Names of the page, of the JSON file and of the folder of tags."""


def write_survey(found: Survey, folder: Path) -> None:
    """Write a survey's page, its JSON and the scenarios' tags into a folder."""
    make_folder(folder / TAGS)
    write_whole(folder / DATA, json.dumps(found.model_dump(mode="json"), indent=1, ensure_ascii=False) + "\n")
    write_whole(folder / PAGE, page_of(found))
    taken: Counter[str] = Counter()
    for one in found.scenarios:
        if one.fault:
            continue
        stem = re.sub(r"[^A-Za-z0-9_.-]", "_", f"{Path(split_target(one.target)[0]).stem}_{one.name}")
        taken[stem] += 1
        file = f"{stem}.json" if taken[stem] == 1 else f"{stem}_{taken[stem]}.json"
        tags = openlabel_of(split_target(one.target)[0], one.name, one.digest, one.tags)
        write_whole(folder / TAGS / file, tags)


def page_of(found: Survey) -> str:
    """Return a survey as a page of HTML that needs no other file."""
    environment = page_environment(Path(__file__).parent)
    environment.filters["short"] = _short
    environment.filters["ranges"] = _ranges
    groups = dict.fromkeys(one.group for one in found.conditions)
    tree = {group: [one for one in found.conditions if one.group == group] for group in groups}
    page = environment.get_template("library.html.jinja")
    return page.render(found=found, tree=tree, not_looked_for=NOT_LOOKED_FOR)


def _short(target: str) -> str:
    """Return the name of a scenario in a target, or the file's name if the target has none."""
    path, name = split_target(target)
    return name or Path(path).stem


def _ranges(one: ConditionCoverage) -> str:
    """Return the quantities of a condition with their least and greatest values."""
    parts = (
        f"{name}: {low:g}" if low == high else f"{name}: {low:g} to {high:g}"
        for name, (low, high) in one.values.items()
    )
    return "; ".join(parts)
