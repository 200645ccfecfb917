"""The animation of a load path: its frames are states of the path, to one scale, one after another."""

import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D
from matplotlib.quiver import Quiver
from matplotlib.text import Text
from mesh_studies import punch, roller
from PIL import Image, ImageSequence
from results import followed, linked

import bemcontact
from bemcontact.errors import OptionError, ProblemError
from bemcontact.report import figures
from bemcontact.report.figures.animation import FRAMES, HELD, SHOWN, Animation
from bemcontact.report.figures.page import GREEN

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def rolling() -> Animation:
    return figures.draw_animation(followed())


@pytest.fixture
def few_frames(monkeypatch: pytest.MonkeyPatch) -> int:
    """Animations of five frames, for what is the same of each frame."""
    monkeypatch.setattr("bemcontact.report.figures.animation.FRAMES", 5)
    return 5


def words_of(animation: Animation) -> list[str]:
    return [item.get_text() for artists in animation.frames for item in artists[-1:] if isinstance(item, Text)]


@pytest.mark.slow
def test_each_frame_states_parameter_breakpoints_peak_and_force(rolling: Animation):
    """They are those of the path at evenly spaced values. On a width of 1 the force is the pressure, by statics."""
    path = followed()
    for t, words in zip(np.linspace(0, 1, FRAMES), words_of(rolling), strict=True):
        numbers = r"conditions\.top\.pressure = (\S+); (\d+) of (\d+) breakpoints\npeak pressure (\S+).*\nforce (\S+)"
        value, passed, of, peak, force = map(float, re.findall(numbers, words)[0])
        assert value == pytest.approx(t, abs=1e-3)
        assert (passed, of) == (sum(state.value <= t + 1e-12 for state in path.breakpoints), len(path.breakpoints))
        assert peak == pytest.approx(path.path.at(float(t)).pressure.max(), rel=5e-3)
        assert force == pytest.approx(
            np.hypot(*path.path.contact(float(t)).resultants(path.path.at(float(t)).pressure)[0]), rel=5e-3
        )


@pytest.mark.slow
def test_a_line_goes_along_the_curve(rolling: Animation):
    curve = rolling.figure.axes[1]
    lines = [item for artists in rolling.frames for item in artists if isinstance(item, Line2D) and item.axes is curve]
    at = [float(np.asarray(line.get_xdata())[0]) for line in lines]
    assert at == pytest.approx(np.linspace(0, 1, FRAMES))


@pytest.mark.slow
def test_the_svg_shows_one_frame_after_another_and_the_last_one_on_paper(rolling: Animation):
    svg = figures.animated_graphic(rolling).decode()
    root = ElementTree.fromstring(svg)
    classes = [item.get("class") for item in root.iter() if item.get("class")]
    assert {*classes} == {f"f f{order}" for order in range(FRAMES)}
    assert "frame-" not in svg
    assert not [item for item in root.iter() if item.tag == f"{SVG}script"]
    sheet = "".join(style.text or "" for style in root.iter(f"{SVG}style"))
    still, _, moving = sheet.partition("@media screen and (prefers-reduced-motion: no-preference) {")
    assert f".f {{ visibility: hidden }}\n.f{FRAMES - 1} {{ visibility: visible }}" in still
    delays = [float(delay) for delay in re.findall(r"animation-delay: (\S+)s", moving)]
    assert delays == pytest.approx(SHOWN * np.arange(FRAMES))
    assert f"animation: shown {delays[-1] + HELD:.4g}s step-end infinite" in moving


@pytest.mark.slow
def test_files_are_written_by_their_endings_and_others_are_refused(few_frames: int, tmp_path: Path):
    path = followed()
    path.animate(tmp_path / "path.gif")
    with Image.open(tmp_path / "path.gif") as film:
        seconds = [frame.info["duration"] / 1000 for frame in ImageSequence.Iterator(film)]
    assert seconds == [SHOWN] * (few_frames - 1) + [HELD]
    done = []
    figures.save_animation(path, tmp_path / "path.SVG", lambda now, of: done.append((now, of)))
    assert done == [(now, few_frames) for now in range(1, few_frames + 1)]
    assert (tmp_path / "path.SVG").read_bytes() == figures.animated_graphic(figures.draw_animation(path))
    with pytest.raises(OptionError, match=r"path\.mp4: .* an animation must end in \.gif or \.svg"):
        path.animate("path.mp4")
    assert {item.name for item in tmp_path.iterdir()} == {"path.gif", "path.SVG"}


def test_a_path_without_a_way_or_a_body_has_no_animation():
    whole = followed()
    point = replace(whole, path=replace(whole.path, parameter=np.zeros_like(whole.path.parameter)))
    for path, words in ((point, "ends where it begins"), (replace(whole, result_at=None), "body .* not known")):
        assert not figures.can_be_animated(path)
        with pytest.raises(ProblemError, match=words):
            figures.draw_animation(path)


@pytest.mark.slow
def test_several_contacts_have_one_scale_and_their_names():
    """The force of the wall on the link is 0.75 of the pressure, by statics; a page has room for its picture."""
    animation = figures.draw_animation(linked())
    assert words_of(animation)[-1].splitlines()[2] == "forces drum 250, table 200, wall 150 N/mm"
    of_frames = {item for artists in animation.frames for item in artists}
    names = [text.get_text() for text in animation.figure.axes[0].texts if text not in of_frames]
    assert names == ["drum", "table", "wall"]
    assert len(figures.animated_graphic(animation)) < 2e6


@pytest.mark.slow
@pytest.mark.usefixtures("few_frames")
def test_an_infinite_peak_is_written_as_such():
    animation = figures.draw_animation(bemcontact.follow(punch(), "conditions.top.pressure", 1.0))
    assert all("\npeak pressure infinite in foot\n" in words for words in words_of(animation))
    assert animation.figure.axes[1].get_ylabel().startswith("resultant")


@pytest.mark.slow
@pytest.mark.usefixtures("few_frames")
def test_a_peak_is_infinite_only_where_something_presses():
    """A block whose top is held comes down on a punch: it has no pressure before it touches."""
    held = {"left": {"displacement": {"x": 0}}, "top": {"displacement": {"y": 0}}}
    path = bemcontact.follow(punch(conditions=held, reference={}), "conditions.top.displacement.y", -0.02, start=0.01)
    assert path.infinite == ("foot",)
    words = [text.splitlines()[1] for text in words_of(figures.draw_animation(path))]
    assert words[0] == "peak pressure 0 MPa"
    assert words[-1] == "peak pressure infinite in foot"
    first, *_, last = figures.figure_of_states(figures.states_on(path)).axes
    assert [axes.get_title("left").splitlines()[1] for axes in (first, last)] == ["no contact", "infinite in foot"]


@pytest.mark.slow
def test_arrows_of_loads_grow_with_the_load(rolling: Animation):
    """Nothing is drawn for no load; the longest arrow is that of the largest load."""
    arrows = [[item for item in artists if isinstance(item, Quiver)] for artists in rolling.frames]
    green = [[item for item in own if to_hex(np.asarray(item.get_facecolor())[0]) == GREEN] for own in arrows]
    longest = [max((float(np.hypot(it.U, it.V).max()) for it in own), default=0.0) for own in green]
    np.testing.assert_allclose(longest, longest[-1] * np.linspace(0, 1, FRAMES), atol=1e-12)


@pytest.mark.slow
def test_states_that_stand_for_the_animation_on_paper():
    states = figures.states_on(followed())
    assert [*states] == ["at 0", "at 0.3333", "at 0.6667", "at 1"]
    drawn = figures.figure_of_states(states)
    assert [axes.get_title("left").splitlines()[0] for axes in drawn.axes] == [*states]
    assert len({(*axes.get_xlim(), *axes.get_ylim()) for axes in drawn.axes}) == 1


def test_a_state_on_a_path_is_that_of_a_solve():
    """On the same mesh."""
    path = followed()
    assert path.result_at is not None
    there, solved = path.result_at(0.5), bemcontact.solve(roller().with_value("conditions.top.pressure", 0.5))
    assert isinstance(there, bemcontact.Result)
    np.testing.assert_allclose(there.pressure, solved.pressure, atol=1e-9 * solved.pressure.max())
    assert there.boundary is not None
    assert solved.boundary is not None
    np.testing.assert_allclose(there.boundary.displacement, solved.boundary.displacement, atol=1e-9)
    assert there.accuracy.met is None
