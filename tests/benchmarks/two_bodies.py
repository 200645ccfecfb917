"""Two elastic bodies in contact beside quadratic triangles, which share no line with the package.

    OPENBLAS_NUM_THREADS=1 python tests/benchmarks/two_bodies.py [PROBLEM ...] [--accuracy 1e-3] [--parts 1 2 4]

Each problem is solved by finite elements on nested meshes. Peaks are extrapolated in h² from the last two, and ends of
contact in h, for the active set ends at a node. The uncertainty is how far the finest mesh is from the limit, or the
limit of the mesh before it, whichever is more.
"""

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from finite_elements_bodies import along_x
from finite_elements_contact import Array, Field, Touch
from finite_elements_pairs import from_bottom, layer_on_block, pin_in_plate, roller_on_block
from rich.console import Console
from rich.table import Table

import bemcontact

ROLLER = """
name: roller on block
bodies:
  roller:
    material: {{young_modulus: {E[0]}, poisson_ratio: 0.3}}
    boundary:
      outer:
        - {{name: under, kind: arc, center: [0, {R}], radius: {R}, angles: [-90, 0]}}
        - {{name: diameter, end: [0, {R}]}}
        - {{name: axis}}
    conditions: {{axis: {{displacement: {{x: 0}}}}, diameter: {{traction: {{y: {traction}}}}}}}
  block:
    material: {{young_modulus: {E[1]}, poisson_ratio: 0.3}}
    boundary:
      outer:
        - {{name: bottom, start: [0, {bottom}], end: [{width}, {bottom}]}}
        - {{name: right, end: [{width}, 0]}}
        - {{name: top, end: [0, 0]}}
        - {{name: axis}}
    conditions: {{axis: {{displacement: {{x: 0}}}}, bottom: {{displacement: {{y: 0}}}}}}
contacts: {{track: {{between: [roller/under, block/top]}}}}
"""
PIN = """
name: pin in plate
bodies:
  pin:
    material: {{young_modulus: 210e3, poisson_ratio: 0.3}}
    boundary:
      outer:
        - {{name: under, kind: arc, center: [0, -0.02], radius: 10, angles: [-90, 0]}}
        - {{name: diameter, end: [0, -0.02]}}
        - {{name: axis}}
    conditions: {{axis: {{displacement: {{x: 0}}}}, diameter: {{traction: {{y: {traction}}}}}}}
  plate:
    material: {{young_modulus: 70e3, poisson_ratio: 0.3}}
    boundary:
      outer:
        - {{name: bottom, start: [0, -40], end: [40, -40]}}
        - {{name: right, end: [40, 40]}}
        - {{name: top, end: [0, 40]}}
        - {{name: upper axis, end: [0, 10.02]}}
        - {{name: hole, kind: arc, center: [0, 0], start: [0, 10.02], end: [0, -10.02], clockwise: true}}
        - {{name: lower axis}}
    conditions:
      upper axis: {{displacement: {{x: 0}}}}
      lower axis: {{displacement: {{x: 0}}}}
      top: {{displacement: {{y: 0}}}}
contacts: {{bearing: {{between: [pin/under, plate/hole]}}}}
"""
LAYER = """
name: receding layer
bodies:
  layer:
    material: {young_modulus: 1000, poisson_ratio: 0.3}
    boundary:
      outer:
        - {name: bottom, start: [0, 0], end: [10, 0]}
        - {name: right, end: [10, 1]}
        - {name: top, end: [0.5, 1]}
        - {name: pressed, end: [0, 1]}
        - {name: left}
    conditions: {left: {displacement: {x: 0}}, pressed: {pressure: 1}}
  block:
    material: {young_modulus: 2000, poisson_ratio: 0.3}
    boundary:
      outer:
        - {name: bottom, start: [0, -10], end: [10, -10]}
        - {name: right, end: [10, 0]}
        - {name: top, end: [0, 0]}
        - {name: left}
    conditions: {left: {displacement: {x: 0}}, bottom: {displacement: {y: 0}}}
contacts: {face: {between: [layer/bottom, block/top]}}
"""
ORDERS = (2, 1)
"""Of h in the error of the peak and of the end of contact."""
SAMPLES = 2001
"""Places along contact between which the peak of finite elements is looked for."""
BESIDE_END = 0.95
"""Of the contact, up to where it is looked for."""


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A problem, stated twice.

    Parameters
    ----------
    spec : for bemcontact, without its accuracy
    touch : the contact by finite elements, with elements cut into so many parts
    end : name of the end of contact
    coordinate : of points (x, y), in which it is measured
    """

    spec: str
    touch: Callable[[int], Touch]
    end: str
    coordinate: Field = along_x


def roller(radius: float, moduli: tuple[float, float], width: float, height: float, load: float, end: float) -> Problem:
    """A quarter of a roller on half a block, with half the load."""
    return Problem(
        spec=ROLLER.format(R=radius, E=moduli, width=width, bottom=-height, traction=-load / radius),
        touch=partial(roller_on_block, radius=radius, moduli=moduli, width=width, height=height, load=load, end=end),
        end="half-width",
    )


def pin(load: float, end: float) -> Problem:
    """A quarter of a pin in half a plate, with half the load."""
    return Problem(
        spec=PIN.format(traction=-load / 10),
        touch=partial(pin_in_plate, clearance=0.02, load=load, end=end),
        end="half angle",
        coordinate=from_bottom(0.0),
    )


PROBLEMS = {
    "roller": roller(8.0, (1e3, 500.0), 16.0, 16.0, 8.0, 0.67),
    "roller of NAFEMS": roller(50.0, (210e3, 70e3), 100.0, 200.0, 17500.0, 6.2),
    "pin, 13 N/mm": pin(13.0, 9.8),
    "pin, 135 N/mm": pin(135.0, 31.8),
    "pin, 1250 N/mm": pin(1250.0, 70.9),
    "layer": Problem(spec=LAYER, touch=partial(layer_on_block, pressure=1.0, end=1.24), end="half-length"),
}


def peak_and_end(touch: Touch) -> Array:
    """Largest pressure and end of contact (2,) by finite elements."""
    end = touch.ends()[1]
    return np.array([touch.pressure_at(np.linspace(0, BESIDE_END * end, SAMPLES)).max(), end])


def limit(values: Sequence[Array]) -> tuple[Array, Array]:
    """What peak and end on meshes of h, h/2 and h/4 tend to, and how uncertain that is."""
    coarse, middle, fine = values
    factor = 2.0 ** np.array(ORDERS) - 1
    before, last = middle + (middle - coarse) / factor, fine + (fine - middle) / factor
    return last, np.maximum(abs(last - before), abs(last - fine))


def of_bemcontact(problem: Problem, accuracy: float) -> tuple[Array, Array, float]:
    """Peak and end of contact (2,), their error bars in the same units, and the CPU time [s]."""
    start = time.process_time()
    result = bemcontact.solve(bemcontact.loads(f"{problem.spec}accuracy: {accuracy}\n"))
    seconds = time.process_time() - start
    peak = result.footprint.peak
    if not (result.certified and result.holds and peak):
        raise RuntimeError(f"no certified answer: {result.notes}")
    (interval,) = result.footprint.intervals
    value = np.array([peak.pressure, problem.coordinate(*np.array(interval.end)).item()])
    bars = {bar.quantity: bar.bar for bar in result.accuracy.bars}
    return value, value * [bars["peak"], bars["end"]], seconds  # contact begins at 0, so its length is that of the end


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("problems", nargs="*", choices=[*PROBLEMS, []], metavar="PROBLEM", help=", ".join(PROBLEMS))
    parser.add_argument("--accuracy", type=float, nargs="+", default=[1e-3], help="of bemcontact")
    parser.add_argument("--parts", type=int, nargs=3, default=[1, 2, 4], help="of elements, each twice the one before")
    chosen = parser.parse_args()
    table = Table("problem", "quantity", "finite elements", "±", "asked", "bemcontact", "bar", "difference", "CPU s")
    for name in chosen.problems or PROBLEMS:
        problem = PROBLEMS[name]
        known, uncertain = limit([peak_and_end(problem.touch(parts)) for parts in chosen.parts])
        for accuracy in chosen.accuracy:
            value, bars, seconds = of_bemcontact(problem, accuracy)
            for at, quantity in enumerate(("peak", problem.end)):
                off = value[at] / known[at] - 1
                table.add_row(
                    name, quantity, f"{known[at]:.7g}", f"{uncertain[at] / known[at]:.1e}", f"{accuracy:g}",
                    f"{value[at]:.7g}", f"{bars[at] / value[at]:.1e}", f"{off:+.1e}", f"{seconds:.1f}",
                )  # fmt: skip
    Console(width=140).print(table)


if __name__ == "__main__":
    main()
