"""Validates a file against the generated schemas of this program's languages, after the reader has accepted it."""

from __future__ import annotations

from functools import cache
from typing import Any

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, FilePlace
from scenario_compiler.document import Document
from scenario_compiler.markup import codes
from scenario_compiler.resources import schema_file
from scenario_compiler.source.catalogs import CatalogElement
from scenario_compiler.source.conflict import LibraryElement
from scenario_compiler.source.study_file import QUESTIONNAIRE, STUDY


def conflict_xsd() -> str:
    """Return the schema of the conflict language's files."""
    from scenario_compiler.vocabulary.schema import xsd_of

    return xsd_of((LibraryElement, CatalogElement))


def study_xsd() -> str:
    """Return the schema of the files of studies and questionnaires."""
    from scenario_compiler.source.study import STUDIES
    from scenario_compiler.vocabulary.schema import xsd_of

    return xsd_of(STUDIES)


def judge_form(document: Document, sink: Diagnostics) -> None:
    """Report the schema's findings in a file; none if the schema does not exist."""
    is_study = document.root.tag in (STUDY, QUESTIONNAIRE)
    schema = _schema("study.xsd" if is_study else "conflict.xsd")
    if schema is None or schema.validate(document.root):
        return
    errors: Any = schema.error_log
    line = int(errors[0].line)
    place = FilePlace(document.path, line, source_line=document.line_text(line))
    sink.add(codes.AGAINST_SCHEMA, f"against the schema: {errors[0].message}", place)


@cache
def _schema(name: str) -> etree.XMLSchema | None:
    path = schema_file(name)
    return etree.XMLSchema(etree.parse(str(path))) if path.is_file() else None
