"""The environment that renders the HTML templates of pages."""

from __future__ import annotations

import base64
import re
from pathlib import Path

import jinja2
from jinja2.bccache import Bucket
from markupsafe import Markup, escape

from scenario_compiler.report.palette import words_of
from scenario_compiler.report.wording import decimal, fixed, unit_words


class _Compiled(jinja2.BytecodeCache):
    """Keeps the templates that have been compiled in this process: compiling one takes longer than rendering it."""

    def __init__(self) -> None:
        self._kept: dict[str, bytes] = {}

    def load_bytecode(self, bucket: Bucket) -> None:
        """Give the code of a template that has not changed since it was compiled."""
        if bucket.key in self._kept:
            bucket.bytecode_from_string(self._kept[bucket.key])

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep the code of a template."""
        self._kept[bucket.key] = bucket.bytecode_to_string()


_COMPILED = _Compiled()


def _code(text: str) -> Markup:
    """Return a text as HTML in which parts between backticks are code."""
    return Markup(re.sub(r"`([^`]*)`", r"<code>\1</code>", str(escape(text))))


def page_environment(*folders: Path) -> jinja2.Environment:
    """Return an environment that searches templates in `folders` and then beside this module.

    Inserted texts are escaped, and an undefined name in a template is an error.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([*folders, Path(__file__).parent]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        bytecode_cache=_COMPILED,
    )
    environment.filters["number"] = lambda value: "–" if value is None else decimal(value)
    environment.filters["fixed"] = lambda value: "–" if value is None else fixed(value)
    environment.filters["code"] = _code
    environment.filters["png"] = lambda data: "data:image/png;base64," + base64.b64encode(data).decode()
    environment.filters["unit"] = unit_words
    environment.filters["words"] = words_of
    return environment
