"""Orders the entries of a list by their keys, for the functions that fill links and cells."""

from scenario_compiler.marker import compiled


@compiled
def merge(keys: list[int], order: list[int], first: int, middle: int, last: int, merged: list[int]) -> None:
    """Merge two neighbouring parts of `order` that are in order, from `first` and from `middle` on, into `merged`."""
    one = first
    other = middle
    for k in range(first, last):
        if other == last or (one < middle and keys[order[one]] <= keys[order[other]]):
            merged[k] = order[one]
            one = one + 1
        else:
            merged[k] = order[other]
            other = other + 1


@compiled
def order_by_key(keys: list[int], order: list[int], merged: list[int]) -> None:
    """Fill `order` with the numbers of the keys in ascending order of key; equal keys keep their order.

    Args:
        keys: The keys; those for which `order` has no room are left out.
        order: Filled; as long as the list that is ordered.
        merged: Working memory of the same length.
    """
    count = len(order)
    for k in range(count):
        order[k] = k
    width = 1
    while width < count:
        first = 0
        while first < count:
            merge(keys, order, first, min(first + width, count), min(first + 2 * width, count), merged)
            first = first + 2 * width
        for k in range(count):
            order[k] = merged[k]
        width = 2 * width
