"""What a file of OpenSCENARIO holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from lxml import etree

from scenario_compiler.document import Document


@dataclass(frozen=True)
class OpenScenario:
    """A file of OpenSCENARIO: a scenario, or a catalog, which holds none.

    Attributes:
        document: The scenario's file.
        scenarios: The scenario under the name of its file.
    """

    document: Document
    scenarios: Mapping[str, etree._Element]
