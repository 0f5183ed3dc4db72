"""Whether an entity is present for pictures, for sensors, or for other traffic."""

from __future__ import annotations

from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled


@compiled
def there_for(st: State, j: int, who: int) -> int:
    """Return 1 if an entity is in the world and visible to the observers of a SEEN_... bit."""
    if st.present[j] == 0 or st.visible[j] & who == 0:
        return 0
    return 1
