"""Two blocks that are bonded on some parts of their common line and in contact on the others, for tests."""

import numpy as np
from several_bodies import elastic, stated

PRESSURE = 5.0
ARRANGEMENTS = {"bc": (-2, 0, 2), "cbc": (-3, -1, 1, 3), "bcb": (-3, -1, 1, 3)}
"""Bonds (b) and contacts (c) along the common line, and where they end."""


def outline(edges):
    """Boundary from names, starts and numbers of elements of edges, which may be None."""
    stated = [{"name": name, "start": start, "elements": number} for name, start, number in edges]
    return {"outer": [{key: value for key, value in edge.items() if value is not None} for edge in stated]}


def halves(
    kinds, conditions, *, moduli=(1000.0, 1000.0), n=2, turn=0.0, mirror=False, scale=1.0, height=1.0, stress=1.0,
    places=None, accuracy=None,
):  # fmt: skip
    """Two blocks above each other: bonded on some parts of their common line, in contact on the others.

    `conditions` are those of both bodies, and `n` is the number of elements on each unit of length, or None.
    """
    at = places or ARRANGEMENTS[kinds]
    way = np.exp(1j * turn) * scale

    def place(x, y):
        z = way * complex(-x if mirror else x, y)
        return [z.real, z.imag]

    def body(corners):
        names = [name for name, *_ in corners]
        edges = [(name, place(x, y), number) for name, x, y, number in corners]
        if mirror:  # the other way round: each edge starts where it ended
            edges = [(name, edges[(names.index(name) + 1) % len(names)][1], k) for name, _, k in reversed(edges)]
        return outline(edges)

    def count(length):
        return None if n is None else max(1, int(n * length))

    parts = [(f"i{j}", at[j], at[j + 1], count(at[j + 1] - at[j])) for j in range(len(kinds))]
    sides, across = count(height), count(at[-1] - at[0])
    up = [(name, x, 0, k) for name, x, _, k in parts]
    up += [("right", at[-1], 0, sides), ("top", at[-1], height, across), ("left", at[0], height, sides)]
    low = [(name, x, 0, k) for name, _, x, k in reversed(parts)]
    low += [("left", at[0], 0, sides), ("bottom", at[0], -height, across), ("right", at[-1], -height, sides)]
    pairs = {f"{kind}{j}": [f"up/i{j}", f"low/i{j}"] for j, kind in enumerate(kinds)}
    return stated(
        name="debond",
        bodies={
            "up": elastic(body(up), conditions[0], moduli[0] * stress),
            "low": elastic(body(low), conditions[1], moduli[1] * stress),
        },
        bonded={name: pair for name, pair in pairs.items() if name[0] == "b"},
        contacts={name: {"between": pair} for name, pair in pairs.items() if name[0] == "c"},
        accuracy=accuracy,
    )  # fmt: skip


def squeezed(stress=1.0):
    """Pressure on both blocks, which nothing else holds."""
    return {"top": {"pressure": PRESSURE * stress}}, {"bottom": {"pressure": PRESSURE * stress}}
