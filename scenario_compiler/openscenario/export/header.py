"""The header of exported files."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import made

DATE = "2020-01-01T00:00:00"
"""Date of every exported file, so that the same plan gives the same file."""


def file_header(description: str, output: Output) -> etree._Element:
    """Return the <FileHeader> for the version of the written file."""
    major, minor = output.version
    header = made("FileHeader", revMajor=str(major), revMinor=str(minor), date=DATE, author="scenario-compiler")
    header.set("description", description)
    return header
