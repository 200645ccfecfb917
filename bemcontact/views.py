"""Objects that show themselves: as a picture, in a notebook, and as a table for data frames.

How they do is known to the room of reports alone, which stands above all others: it is looked up by its name when
something is shown. So no room depends on it, and nobody waits for matplotlib who draws nothing. `views.pyi` has the
types of the packages that are looked up so.
"""

from importlib import import_module
from typing import Any

VIEWS = "bemcontact.report.views"
"""The module that knows how objects show themselves."""


class Drawn:
    """Base of what has a picture."""

    def plot(self, axes: Any = None, **options: Any) -> Any:
        """Draw a picture.

        Parameters
        ----------
        axes : of matplotlib, to draw into; new ones of pyplot if None
        options : what to draw; the first is drawn if none is named. Of a result: what="contact", "pressure", "gap",
            "deformed" or "stress"; with zone, a contact zone, and stress, such as "max_shear". Of a path: what="peak",
            "force", "moment" or "ends". Of a design: what="profile" or "pressure". Of a study: output, and over, the
            key of a parameter

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        OptionError
            An option is unknown, or has an unknown value.
        ProblemError
            There is nothing to draw: the result of a condensed problem has no body.
        """
        return import_module(VIEWS).plot(self, axes, options)

    def _repr_html_(self) -> str:
        """A picture and the main facts, for notebooks."""
        return import_module(VIEWS).html(self)


class Tabular(Drawn):
    """Base of what has a picture and a table."""

    def to_frame(self) -> Any:
        """Return a table for pandas, the extra ``tables``.

        Returns
        -------
        pandas.DataFrame
            Of a result: a row for each contact point, of results of load cases with the case, of a path with the value
            at each breakpoint. Of a study: a row for each member. Of a comparison: one for each formulation. Of a
            design: one for each point of its profile. ``attrs["units"]`` has the units.

        Raises
        ------
        ModuleNotFoundError
            If pandas is not installed.
        """
        return import_module(VIEWS).frame(self)

    def to_xarray(self) -> Any:
        """Return arrays with named dimensions for xarray, the extra ``tables``.

        Returns
        -------
        xarray.Dataset
            Of a result: pressure and gap by contact point, of results of load cases also by case, of a path also by
            value. Of a study: each output and its error by the parameters that are varied.

        Raises
        ------
        ModuleNotFoundError
            If xarray is not installed.
        ProblemError
            A comparison and a design have no such arrays.
        """
        return import_module(VIEWS).dataset(self)
