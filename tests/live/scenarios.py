"""Scenarios for a person at the wheel: a request that waits, an open road, and a request with sounds."""

from __future__ import annotations

SOON = """\
<scenarios version="1">
  <scenario name="soon" map="town_grid" duration="600">
    <ego speed="6"><start><lane road="3" lane="-1" s="20"/></start><forward_sensor range="300"/></ego>
    <static id="blocker" model="vehicle.audi.tt"><at><ahead_of entity="ego" distance="125"/></at></static>
    <takeover budget="40" escalate_after="600" minimum_risk_after="600">
      <cause kind="path_blocked"/>
      <driver><person/></driver>
      <message modality="text icon" content="what why"/>
    </takeover>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""
"""A request that waits for an answer longer than any machine takes to show it."""

OPEN = """\
<scenarios version="1">
  <scenario name="open" map="motorway" duration="600">
    <ego speed="4"><start><spawn_point name="right_lane"/></start></ego>
    <takeover><driver><person/></driver></takeover>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""
"""Nothing ahead that could refuse the automation, however late a press arrives, and soon at a standstill."""

TOLD = SOON.replace(
    '<message modality="text icon" content="what why"/>',
    """<message modality="tone vibration"/>
      <message modality="speech" content="what why" language="fi"/>
      <message modality="speech" after="1" language="fi"><say at="request" text="Kädet rattiin!"/></message>""",
)
"""A request that is sounded, spoken from files, and spoken in the author's own words."""
