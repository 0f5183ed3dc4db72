"""The builder of a plan's program, which makes the rows of positions, routes, trajectories and other parts."""

from __future__ import annotations

from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.engine.program.guides import add_goal, add_route
from scenario_compiler.engine.program.positions import add_position
from scenario_compiler.engine.program.run import add_failure, add_weather
from scenario_compiler.engine.program.tracks import add_track
from scenario_compiler.engine.program.world import order_of_texts, variable_value
from scenario_compiler.plan.keeping import group_name
from scenario_compiler.vocabulary.actions import (
    Failure,
    KeepsVehicles,
    StopTrafficAction,
    TrafficSinkAction,
    TrafficSourceAction,
    TrafficSwarmAction,
    WeatherAction,
)
from scenario_compiler.vocabulary.positions import RandomPosition
from scenario_compiler.vocabulary.positions.routes import RouteWord, Trajectory
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.variables import Variable, seconds_of
from scenario_compiler.vocabulary.word import Word


class PlanBuilder(ProgramBuilder):
    """A builder that knows the parts of actions and conditions: positions, routes, trajectories and others."""

    def position(self, word: Word) -> int:
        """Append a position; return its row."""
        return add_position(self, word)

    def random_position(self) -> int:
        """Append a position for the random placement of traffic; return its row."""
        return add_position(self, RandomPosition(), "traffic")

    def track(self, trajectory: Trajectory) -> int:
        """Append a trajectory; return its index."""
        return add_track(self, trajectory, add_position)

    def route(self, route: RouteWord) -> int:
        """Append the guide of a route; return its index."""
        return add_route(self, route)

    def goal(self, position: Word) -> int:
        """Append the guide to a position; return its index."""
        return add_goal(self, position)

    def failure(self, failure: Failure) -> int:
        """Append a camera failure that an action begins; return its index."""
        return add_failure(self, failure, waits=True)

    def weather(self, weather: WeatherAction) -> int:
        """Append a weather; return its index."""
        return add_weather(self, weather)

    def variable_value(self, variable: Variable, text: str) -> float:
        """Return the number that represents a variable's value, given as a text."""
        return variable_value(self, variable, text)

    def order_of_texts(self, rule: int, text: str) -> tuple[int, float]:
        """Return the RULE_... code and the limit for the number of a variable that is compared with a text by order."""
        return order_of_texts(self, rule, text)

    def seconds_of(self, date_time: str) -> float:
        """Return a date and time as seconds since 1970."""
        return seconds_of(date_time)

    def traffic_number(self, name: str) -> int:
        """Return the index of a name among those of actions on traffic, from 1; 0 for an empty name."""
        kinds = (TrafficSwarmAction, TrafficSourceAction, TrafficSinkAction, StopTrafficAction)
        names = {word.traffic for word in walk(self.plan.storyboard) if isinstance(word, kinds)}
        return sorted({"", *names}).index(name)

    def vehicles_of(self, word: KeepsVehicles) -> tuple[int, int]:
        """Return the first entity that an action on traffic uses, and the number of its entities.

        Actions must be added in the plan's order, by which those with the same name are distinguished.
        """
        group = group_name(word, self.traffic)
        kept = [(k, one.id) for k, one in enumerate(self.plan.entities) if one.kind == "traffic" and one.start is None]
        of = [k for k, name in kept if name.rpartition(".")[0] == group]
        return (of[0], len(of)) if of else (0, 0)
