"""The body on a load path as an animation, with the pressure on its contact: of SVG for pages, or a GIF for slides."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.analysis.result import Result
from bemcontact.errors import ProblemError
from bemcontact.files import output
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.report.contact_words import units_of
from bemcontact.report.figures.contact import setting_of, sketch_contact
from bemcontact.report.figures.load_cases import close_zone
from bemcontact.report.figures.page import (
    BLACK,
    name_axis,
    new_page,
    plain,
    settle,
    short_label,
    without_glyph_warnings,
)
from bemcontact.report.figures.path import draw_peaks, draw_resultants
from bemcontact.report.figures.problem import largest_traction
from bemcontact.report.figures.svg import vector_graphic
from bemcontact.report.formatting import number

ANIMATIONS = (".gif", ".svg")
"""Endings of the files that can be written."""
FRAMES = 30
"""Number of frames."""
STATES = 4
"""Number of states in the picture that stands for the animation on paper."""
SHOWN, HELD = 0.2, 2.0
"""Seconds that a frame is shown, and that the last one is."""
WIDTH, CURVE, AROUND = 5.6, 1.1, 1.6
"""Inches of the width of the picture, of the height of its curve, and of texts above, between and below."""
LOW, HIGH = 1.4, 4.0
"""Inches between which the height of the body's place is."""
DOTS = 130
"""Dots per inch of images."""
NAMED = 3
"""Most contact zones whose forces are written."""

Progress = Callable[[int, int], object]
"""Called with the number of frames that are drawn, and that of all."""


class Animation(NamedTuple):
    """A figure with all frames on each other, and what of it belongs to each frame alone."""

    figure: Figure
    frames: list[list[Artist]]


def ensure_known_animation(path: Path) -> None:
    """Raise `ValueError` unless the file name ends in one of `ANIMATIONS`."""
    if path.suffix.lower() not in ANIMATIONS:
        raise ValueError(f"{path}: the file name of an animation must end in {' or '.join(ANIMATIONS)}")


def can_be_animated(path: ParameterPath) -> bool:
    """Whether the body on a path is known, and the path does not end where it begins."""
    return path.result_at is not None and path.path.begins_at < path.path.ends_at


def results_on(path: ParameterPath, count: int) -> dict[float, Result]:
    """The results at so many evenly spaced values on a path, by t from 0 to 1.

    `ProblemError` if the body is not known, or the path ends where it begins.
    """
    if path.result_at is None:
        raise ProblemError("the body of this path is not known, so that it has no animation; follow a Problem")
    if path.path.begins_at == path.path.ends_at:
        notes = "".join(f"; {note}" for note in path.notes)
        raise ProblemError(f"the path ends where it begins, so that it has no animation{notes}")
    results = {t: path.result_at(t) for t in np.linspace(path.path.begins_at, path.path.ends_at, count).tolist()}
    return {t: result for t, result in results.items() if isinstance(result, Result)}


def states_on(path: ParameterPath, count: int = STATES) -> dict[str, Result]:
    """The results at so many evenly spaced values on a path, by the value in words; `ProblemError` as `results_on`."""
    return {f"at {_rounded(path.value(t), 4)}": result for t, result in results_on(path, count).items()}


def draw_animation(path: ParameterPath, progress: Progress | None = None) -> Animation:
    """Draw the deformed body with its contact at evenly spaced values of the parameter, above the peak pressure.

    All frames have one scale of bodies, and one of pressures. If the only contact is small beside the body in all of
    them, and at much the same place, it is drawn alone. `ProblemError` as of `results_on`.
    """
    results, units = results_on(path, FRAMES), units_of(path.contact)
    zone, figure = close_zone([*results.values()]), new_page(WIDTH, HIGH)
    load = max(largest_traction(result.problem) for result in results.values() if result.problem is not None)
    setting = replace(setting_of([*results.values()], zone), load=load)
    body, curve = figure.subplots(2, 1)
    (draw_resultants if path.infinite else draw_peaks)(curve, path)
    name_axis(curve.xaxis, short_label(path.key, 60))
    curve.spines[["top", "right"]].set_visible(False)
    frames, limits, write = list[list[Artist]](), [], None
    for done, (t, result) in enumerate(results.items(), 1):
        before = {*body.get_children()}
        write = sketch_contact(body, result, zone, setting, numbers=False)
        limits.append(body.axis())
        own = [item for item in body.get_children() if item not in before]
        frames.append([*own, curve.axvline(path.value(t), color=BLACK, linewidth=1.0, linestyle="dotted")])
        if progress is not None:
            progress(done, len(results))
    (left, _, low, _), (_, right, _, high) = np.min(limits, axis=0), np.max(limits, axis=0)
    body.set(xlim=(left, right), ylim=(low, high))
    height = float(np.clip((WIDTH - 1) * (high - low) / (right - left), LOW, HIGH))
    curve.get_gridspec().set_height_ratios((height, CURVE))
    figure.set_figheight(height + CURVE + AROUND)
    body.set_title("\n\n", loc="left", fontsize=9)  # room for the words of each frame
    settle(body)
    if write is not None:
        write()
    for own, (t, result) in zip(frames, results.items(), strict=True):
        own.append(_written(body, path, t, result, units.stress, units.line_force))
    return Animation(figure, frames)


def _written(axes: Axes, path: ParameterPath, t: float, result: Result, stress: str, line_force: str) -> Artist:
    """Write parameter, peak, breakpoints and forces above a frame."""
    passed = int(np.searchsorted(path.path.parameter, t, side="right"))
    peak = float(result.pressure.max(initial=0.0))
    sizes = {zone: float(np.hypot(*force)) for zone, force in result.forces.items()}
    infinite = result.accuracy.infinite
    at_peak = f"infinite in {', '.join(infinite)}" if infinite else f"{_rounded(peak)} {stress}"
    if len(sizes) == 1 or len(sizes) > NAMED:
        forces = ("force " if len(sizes) == 1 else "sum of forces ") + _rounded(sum(sizes.values()))
    else:
        forces = "forces " + ", ".join(f"{short_label(zone, 14)} {_rounded(size)}" for zone, size in sizes.items())
    lines = (
        f"{short_label(path.key, 44)} = {_rounded(path.value(t), 4)}; {passed} of {len(path.breakpoints)} breakpoints",
        "peak pressure " + plain(short_label(at_peak, 50)),
        plain(f"{forces} {line_force}"),
    )
    return axes.text(0.0, 1.01, "\n".join(lines), transform=axes.transAxes, fontsize=9, va="bottom")


def _rounded(value: float, figures: int = 3) -> str:
    """Write a number with few figures, so that its length changes little; errors on a path are not known."""
    return number(float(f"{value:.{figures}g}"))


def animated_graphic(animation: Animation) -> bytes:
    """Write an animation as transparent SVG for light and dark pages, which needs no script.

    Its style sheet shows one frame after another. It shows the last one on paper, and where motion is not wanted.
    """
    figure, frames = animation
    for order, artists in enumerate(frames):
        for part, artist in enumerate(artists):
            artist.set_gid(f"frame-{order}-{part}")
    classed = re.sub(r'id="frame-(\d+)-\d+"', r'class="f f\1"', vector_graphic(figure).decode())
    return classed.replace("</style>", f"{_style_sheet(len(frames))}</style>", 1).encode()


def _style_sheet(count: int) -> str:
    """Style sheet that shows one of so many frames after another."""
    whole = SHOWN * (count - 1) + HELD
    rules = [f".f{order} {{ animation-delay: {SHOWN * order:.4g}s }}" for order in range(count)]
    keyframes = (
        f"@keyframes {name} {{ 0% {{ visibility: visible }} {100 * seconds / whole:.5g}% {{ visibility: hidden }} }}"
        for name, seconds in (("shown", SHOWN), ("held", HELD))
    )
    moving = (
        f".f, .f{count - 1} {{ visibility: hidden; animation: shown {whole:.4g}s step-end infinite }}",
        f".f{count - 1} {{ animation-name: held }}",
    )
    return "\n".join((
        f".f {{ visibility: hidden }}\n.f{count - 1} {{ visibility: visible }}",
        *keyframes, "@media screen and (prefers-reduced-motion: no-preference) {", *moving, *rules, "}\n",
    ))  # fmt: skip


def save_animation(path: ParameterPath, file: Path, progress: Progress | None = None) -> None:
    """Write the animation of a path in the format of the file name's ending: GIF or SVG.

    `ValueError` for another ending, and `ProblemError` as of `results_on`.
    """
    ensure_known_animation(file)
    animation = draw_animation(path, progress)
    with output.whole_file(file) as temporary:
        if file.suffix.lower() == ".svg":
            temporary.write_bytes(animated_graphic(animation))
            return
        _write_gif(animation, temporary)


def _write_gif(animation: Animation, file: Path) -> None:
    """Write each frame as an image; the last one is held by images that are equal."""
    figure, frames = animation
    figure.set_layout_engine("none")
    writer, named = PillowWriter(fps=round(1 / SHOWN)), file.with_suffix(".gif")
    with without_glyph_warnings():
        writer.setup(figure, named, DOTS)
        for shown in (*frames, *[frames[-1]] * round(HELD / SHOWN - 1)):
            for artists in frames:
                for artist in artists:
                    artist.set_visible(artists is shown)
            writer.grab_frame()
        writer.finish()
    named.replace(file)
