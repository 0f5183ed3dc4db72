"""schemas/conflict.xsd compiles, and gives the same verdicts, in the processors that editors and pipelines use.

xmllint (libxml2's command line, which may be older than the libxml2 in lxml), xmlschema (Python) and the JDK's
javax.xml.validation, which is Apache Xerces. Each test skips where its processor is not installed.
"""

from __future__ import annotations

import itertools
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
import xmlschema
from lxml import etree

from scenario_compiler.resources import schema_file
from tests.source.test_form import EVERY_WORD, FILES, SCHEMA, mutants

MOST_MUTANTS = 600
"""Mutants of every_word.xml that each processor judges."""

JAVA = Path(__file__).with_name("Judge.java")


def by_xmllint(files: list[Path]) -> dict[Path, bool]:
    """Return whether xmllint finds each file valid."""
    done = _run("xmllint", "--noout", "--schema", schema_file("conflict.xsd"), *files)
    assert "failed to compile" not in done.stderr, done.stderr
    return {file: f"{file} validates\n" in done.stderr for file in files}


def by_xmlschema(files: list[Path]) -> dict[Path, bool]:
    """Return whether xmlschema, in XSD 1.0, finds each file valid."""
    schema = xmlschema.XMLSchema10(str(schema_file("conflict.xsd")))
    return {file: schema.is_valid(str(file)) for file in files}


def by_the_jdk(files: list[Path]) -> dict[Path, bool]:
    """Return whether the JDK's validator finds each file valid."""
    done = _run("java", JAVA, schema_file("conflict.xsd"), *files)
    assert done.returncode == 0, done.stderr
    return {file: f"valid {file}\n" in done.stdout for file in files}


def _run(program: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    if shutil.which(program) is None:
        pytest.skip(f"{program} is not installed")
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=120, check=False)


PROCESSORS = [
    by_xmllint,
    pytest.param(by_xmlschema, marks=pytest.mark.slow),
    pytest.param(by_the_jdk, marks=pytest.mark.slow),
]


@pytest.mark.parametrize("processor", PROCESSORS)
def test_every_file_of_the_library_is_valid(processor: Callable[[list[Path]], dict[Path, bool]]) -> None:
    assert [str(file) for file, valid in processor(FILES).items() if not valid] == []


@pytest.mark.parametrize("processor", PROCESSORS)
def test_mutants_get_the_verdict_that_they_get_here(
    processor: Callable[[list[Path]], dict[Path, bool]], tmp_path: Path
) -> None:
    root = etree.parse(str(EVERY_WORD)).getroot()
    names: dict[Path, str] = {}
    expected: dict[Path, bool] = {}
    for number, (name, mutant) in enumerate(itertools.islice(mutants(root, set()), MOST_MUTANTS)):
        file = tmp_path / f"{number}.xml"
        file.write_bytes(etree.tostring(mutant))
        names[file], expected[file] = name, SCHEMA.validate(mutant)
    assert {*expected.values()} == {True, False}
    found = processor(list(expected))
    assert [names[file] for file, valid in expected.items() if found[file] != valid] == []


def test_no_pattern_escapes_what_xml_schema_does_not() -> None:
    """XML Schema (part 2, appendix F) knows these escapes of single characters alone; `$` is no metacharacter there."""
    allowed = set("nrt\\|.?*+(){}-[]^")
    patterns = re.findall(r'<xs:pattern value="([^"]*)"', schema_file("conflict.xsd").read_text(encoding="utf-8"))
    assert patterns
    assert {one for pattern in patterns for one in re.findall(r"\\(.)", pattern)} <= allowed
