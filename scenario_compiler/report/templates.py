"""The environment that renders the HTML templates of pages."""

from __future__ import annotations

import base64
from pathlib import Path

import jinja2

from scenario_compiler.report.palette import WORDS
from scenario_compiler.report.wording import decimal, unit_words


def page_environment(*folders: Path) -> jinja2.Environment:
    """Return an environment that finds templates in `folders` and then beside this module.

    What a page inserts is escaped, and a name that a template uses but nobody gives is an error.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([*folders, Path(__file__).parent]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = lambda value: "–" if value is None else decimal(value)
    environment.filters["png"] = lambda data: "data:image/png;base64," + base64.b64encode(data).decode()
    environment.filters["unit"] = unit_words
    environment.filters["words"] = lambda name: WORDS.get(name, name.replace("_", " "))
    return environment
