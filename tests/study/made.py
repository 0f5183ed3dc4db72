"""A short study for tests: two conditions twice, a questionnaire after each run, a probe, a secondary task."""

from __future__ import annotations

from pathlib import Path

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import read_document
from scenario_compiler.source.study import QuestionnaireElement
from scenario_compiler.source.study_reading import read_questionnaire

STUDY = """\
<study version="1" name="short" participants="2" repetitions="2" seed="3" summary="Do texts shorten takeovers?">
  <before><consent file="consent.md"/><page file="welcome.md"/></before>
  <scenario name="blocked" target="conflicts.xml#blocked"/>
  <hmi name="tone"><message modality="tone"/></hmi>
  <hmi name="text"><message modality="text" content="what why"/></hmi>
  <probe from="0.5" to="1.5">
    <query name="speed" about="speed" text="How fast were you, in km/h?" tolerance="10"/>
    <query name="driver" about="control" text="Who was driving?"/>
  </probe>
  <search_task items="6" ratio="2"/>
  <after_each><ask file="effort.xml"/></after_each>
</study>
"""

CONFLICTS = """\
<scenarios version="1">
  <scenario name="blocked" map="town_grid" duration="8">
    <ego speed="10"><start><lane road="3" lane="-1" s="20"/></start></ego>
    <static id="blocker" model="vehicle.audi.tt"><at><ahead_of entity="ego" distance="80"/></at></static>
    <takeover minimum_risk_after="60"><driver takeover_time="3"/></takeover>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""

EFFORT = """\
<questionnaire version="1" name="effort" title="This trial" instruction="Think of the trial just driven.">
  <scale name="agreement" from="1" to="7"><label at="1" text="not at all"/><label at="7" text="fully"/></scale>
  <item name="hard" text="Taking over was hard." scale="agreement"/>
  <item name="calm" text="I stayed calm." scale="agreement" reverse="true"/>
  <choice_item name="first" text="What did you notice first?">
    <option value="sound" text="A sound"/>
    <option value="text" text="A text"/>
  </choice_item>
  <text_item name="more" text="What else do you want to say?"/>
  <score name="effort" of="hard calm"/>
</questionnaire>
"""

CONSENT = "# Consent\n\nI take part **of my own will** and may stop at any time.\n"

WELCOME = "# Welcome\n\nThe vehicle drives by itself. Take over when it asks.\n"


def study(folder: Path) -> Path:
    """Write the study with all that it names into a folder; return its file."""
    files = {"conflicts.xml": CONFLICTS, "effort.xml": EFFORT, "consent.md": CONSENT, "welcome.md": WELCOME}
    for name, text in (files | {"study.xml": STUDY}).items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder / "study.xml"


def questionnaire(folder: Path) -> QuestionnaireElement:
    """Return the questionnaire of the study."""
    study(folder)
    document = read_document(folder / "effort.xml", Diagnostics())
    assert document is not None
    found = read_questionnaire(document, Diagnostics()).questionnaire
    assert found is not None
    return found
