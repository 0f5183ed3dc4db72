"""A file of a study or of a questionnaire, without its words, which `study` has.

Those are imported only when such a file is read, because other files need none of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from scenario_compiler.document import Document

if TYPE_CHECKING:
    from scenario_compiler.source.study import QuestionnaireElement, StudyElement

STUDY, QUESTIONNAIRE = "study", "questionnaire"
"""Root elements of the files."""


class StudyFile(NamedTuple):
    """A file of a study or of a questionnaire, with the files that it names.

    Attributes:
        document: The file.
        study: The study, as far as it could be read; None for a questionnaire.
        questionnaire: The questionnaire of the file itself; None for a study.
        questionnaires: The questionnaires that a study names, by their file names.
        pages: The Markdown files that a study names, as HTML with their pictures, by their names.
        scenarios: Empty, because conflicts are in other files.
    """

    document: Document
    study: StudyElement | None = None
    questionnaire: QuestionnaireElement | None = None
    questionnaires: Mapping[str, QuestionnaireElement] = MappingProxyType({})
    pages: Mapping[str, str] = MappingProxyType({})
    scenarios: Mapping[str, object] = MappingProxyType({})
