"""The page of what the server answers, made from the table of calls, the blueprints and the sensors."""

from __future__ import annotations

from scenario_compiler.carla_server.blueprints import library
from scenario_compiler.carla_server.protocol import CALLS, Call
from scenario_compiler.carla_server.sensors.kinds import REFUSED

HEAD = """# What `serve-carla` answers

Made by `make generate` from the table of calls (`scenario_compiler/carla_server/protocol.py`), by which every argument
is checked. *Answered* calls do what CARLA does, but for what the last column says; *ignored* ones are accepted and have
no effect; *refused* ones get an error that says why. [The guide](carla-server.md) tells how to use the server.
"""

COUNTED = """These are the calls that the clients can make. In the wheels, one class makes them all
(`carla::client::detail::Client`); as the symbols tell, its functions have 110 names in 0.9.15 and 134 in 0.9.16. Seven
make no call, two make another one's, and three make a second one for other types: 104 and 128 calls. A test compares
the functions in the wheel with this table. 0.9.16's `get_ignored_vehicles` asks nobody: the client answers it itself.
"""


def _row(call: Call) -> str:
    takes = ", ".join(layout.name for layout in call.takes) or "nothing"
    return f"| `{call.name}` | {takes} | {call.gives.name} | {call.since} | {call.how} | {call.why} |"


def calls_page() -> str:
    """Return the page as Markdown."""
    counts = {how: sum(call.how == how for call in CALLS) for how in ("answered", "ignored", "refused")}
    told = ", ".join(f"{count} {how}" for how, count in counts.items())
    later = [call for call in CALLS if call.since > "0.9.15"]
    blueprints = library("0.9.16")
    sensors = [one for one in blueprints if one.startswith("sensor.")]
    lines = [
        HEAD,
        f"## Calls\n\n{len(CALLS)} calls: {told}. {len(CALLS) - len(later)} of them are those of 0.9.15.\n",
        COUNTED,
        "| call | takes | gives | since | how | what is left out, or why |",
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
