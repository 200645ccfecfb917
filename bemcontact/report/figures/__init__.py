"""Pictures of a problem and of its result; the only room that knows matplotlib.

Each ``draw_...`` function draws into axes that it is given; each ``figure_of_...`` composes a page of them.
"""

from bemcontact.report.figures.animation import (
    ANIMATIONS,
    animated_graphic,
    can_be_animated,
    draw_animation,
    ensure_known_animation,
    save_animation,
    states_on,
)
from bemcontact.report.figures.comparison import draw_differences, draw_gaps, draw_pressures
from bemcontact.report.figures.contact import close_ups, draw_contact
from bemcontact.report.figures.deformed import draw_deformed
from bemcontact.report.figures.design import (
    draw_relief,
    draw_relieved_pressure,
    figure_of_design,
    figures_of_design,
)
from bemcontact.report.figures.load_cases import draw_case_pressures, figure_of_cases
from bemcontact.report.figures.mesh_study import draw_convergence, draw_history, figures_of
from bemcontact.report.figures.page import FORMATS, ensure_known_format, new_page, save
from bemcontact.report.figures.path import (
    draw_interval_ends,
    draw_moments,
    draw_peaks,
    draw_resultants,
    draw_states,
    figure_of_path,
    figures_of_path,
)
from bemcontact.report.figures.pictures import figure_of, figure_of_states, pictures_of
from bemcontact.report.figures.problem import draw_problem, figure_of_problem
from bemcontact.report.figures.reproduction import draw_against, figures_of_reproduction
from bemcontact.report.figures.result import (
    draw_gap,
    draw_pressure,
    figure_of_result,
)
from bemcontact.report.figures.stress import fill_with_stress
from bemcontact.report.figures.study import draw_output, figures_of_study
from bemcontact.report.figures.vector_graphic import vector_graphic

__all__ = [
    "ANIMATIONS",
    "FORMATS",
    "animated_graphic",
    "can_be_animated",
    "close_ups",
    "draw_against",
    "draw_animation",
    "draw_case_pressures",
    "draw_contact",
    "draw_convergence",
    "draw_deformed",
    "draw_differences",
    "draw_gap",
    "draw_gaps",
    "draw_history",
    "draw_interval_ends",
    "draw_moments",
    "draw_output",
    "draw_peaks",
    "draw_pressure",
    "draw_pressures",
    "draw_problem",
    "draw_relief",
    "draw_relieved_pressure",
    "draw_resultants",
    "draw_states",
    "ensure_known_animation",
    "ensure_known_format",
    "figure_of",
    "figure_of_cases",
    "figure_of_design",
    "figure_of_path",
    "figure_of_problem",
    "figure_of_result",
    "figure_of_states",
    "figures_of",
    "figures_of_design",
    "figures_of_path",
    "figures_of_reproduction",
    "figures_of_study",
    "fill_with_stress",
    "new_page",
    "pictures_of",
    "save",
    "save_animation",
    "states_on",
    "vector_graphic",
]
