"""Figures of the paper's problems: computed curves beside the references."""

import pytest
from reproductions import on_base_meshes

from bemcontact.report.figures import figures_of_reproduction


@pytest.mark.slow
def test_figures_show_curves_and_references():
    """Of the flat surface the run without contact is left out; Fig. 2 has a second frame, the paper's."""
    figures = figures_of_reproduction(on_base_meshes())
    assert len(figures) == 10
    (axes,) = figures["cantilever-flat-surface-pressure"].axes
    labels = [str(line.get_label()) for line in axes.lines]
    assert "printed E" not in labels
    assert {"paper's mesh", "base mesh", "[SS92], Fig. 6: start 42.5", "finite elements: peak 11.57"} <= {*labels}
    _, narrow = figures["cantilever-curved-surface-pressure"].axes
    assert narrow.get_ylim() == (49.99, 50.01)
    (axes,) = figures["cylinder-on-plane-pressure"].axes
    assert "Hertz, out of its range" in [line.get_label() for line in axes.lines]
    (axes,) = figures["bolt-in-plate-pressure"].axes
    assert axes.get_xlabel() == "θ [°]"
