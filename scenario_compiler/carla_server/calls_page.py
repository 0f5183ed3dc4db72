"""The page of the calls that the server answers, made from the table of calls, the blueprints and the sensors."""

from __future__ import annotations

from scenario_compiler.carla_server.blueprints import library
from scenario_compiler.carla_server.protocol import CALLS, Call
from scenario_compiler.carla_server.sensors.kinds import REFUSED

HEAD = """# The calls that `serve-carla` answers

`make generate` makes this page from the table of calls (`scenario_compiler/carla_server/protocol.py`), which the server
also uses to check every argument. *Answered* calls do what CARLA does, except for what the last column says. *Ignored*
calls are accepted and have no effect. *Refused* calls get an error with the reason. [The guide](carla-server.md)
describes how to use the server.
"""

COUNTED = """These are all the calls that the clients can make. In the wheels, one class makes them all
(`carla::client::detail::Client`). According to the symbols of the wheels, its functions have 110 names in 0.9.15 and
134 in 0.9.16. Seven of them make no call, two make the call of another function, and three make a second call for other
types; this gives 104 and 128 calls. A test compares the functions in the wheel with this table. `get_ignored_vehicles`
of 0.9.16 makes no call: the client answers it itself.
"""


def _row(call: Call) -> str:
    takes = ", ".join(layout.name for layout in call.takes) or "nothing"
    return f"| `{call.name}` | {takes} | {call.gives.name} | {call.since} | {call.how} | {call.why} |"


def calls_page() -> str:
    """Return the page as Markdown."""
    counts = {how: sum(call.how == how for call in CALLS) for how in ("answered", "ignored", "refused")}
    by_kind = ", ".join(f"{count} {how}" for how, count in counts.items())
    later = [call for call in CALLS if call.since > "0.9.15"]
    blueprints = library("0.9.16")
    sensors = [one for one in blueprints if one.startswith("sensor.")]
    lines = [
        HEAD,
        f"## Calls\n\n{len(CALLS)} calls: {by_kind}. {len(CALLS) - len(later)} of them exist in 0.9.15 too.\n",
        COUNTED,
        "| call | arguments | result | since | how | what is left out, or the reason |",
        "|---|---|---|---|---|---|",
        *(_row(call) for call in sorted(CALLS, key=lambda call: call.name)),
        "\n## Sensors\n",
        "| sensor | served |",
        "|---|---|",
        *(f"| `{name}` | {'no: ' + REFUSED[name] if name in REFUSED else 'yes'} |" for name in sensors),
        "\n## Vehicles\n",
        "| blueprint | length, m | width, m | height, m |",
        "|---|---|---|---|",
        *(
            f"| `{name}` | {one.vehicle.length:g} | {one.vehicle.width:g} | {one.vehicle.height:g} |"
            for name, one in blueprints.items()
            if name.startswith("vehicle.") and one.vehicle is not None
        ),
    ]
    return "\n".join(lines) + "\n"
