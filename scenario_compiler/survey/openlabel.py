"""A scenario's tags in the JSON form of ASAM OpenLABEL 1.0.0."""

from __future__ import annotations

import json
from collections.abc import Mapping

from scenario_compiler.survey.odd import Tags

ONTOLOGY = "https://openlabel.asam.net/V1-0-0/ontologies/openlabel_ontology_scenario_tags.ttl"
"""The standard's own ontology of scenario tags, which defines the tags."""


def openlabel_of(file: str, name: str, digest: str, tags: Tags) -> str:
    """Return the tags of a scenario as the text of a JSON file.

    Args:
        file: The scenario's file, as the tags' file names it.
        name: The scenario's name.
        digest: The digest of its plan, which tells it from every other.
        tags: Its tags.
    """
    told: list[tuple[str, Mapping[str, object]]] = [
        ("scenarioName", _text(name)),
        ("scenarioUniqueReference", _text(digest)),
    ]
    told += [(tag, _data(values)) for tag, values in tags.items()]
    written = {
        str(number): {"type": tag, "ontology_uid": "0", **({"tag_data": data} if data else {})}
        for number, (tag, data) in enumerate(told)
    }
    document = {
        "openlabel": {
            "metadata": {"schema_version": "1.0.0", "tagged_file": file, "annotator": "scenario-compiler"},
            "ontologies": {"0": {"uri": ONTOLOGY}},
            "tags": written,
        }
    }
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def _text(value: str) -> dict[str, object]:
    return {"text": [{"type": "value", "val": value}]}


def _data(values: tuple[tuple[str, float], ...]) -> dict[str, object]:
    """Return the values of a tag: a single number, or the least and the greatest of several as a range."""
    if not values:
        return {}
    name = values[0][0]
    if len(values) == 1:
        return {"num": [{"name": name, "type": "value", "val": values[0][1]}]}
    numbers = [value for _, value in values]
    return {"vec": [{"name": name, "type": "range", "val": [min(numbers), max(numbers)]}]}
