from typing import Any

from matplotlib.axes import Axes
from pandas import DataFrame
from xarray import Dataset

VIEWS: str

class Drawn:
    def plot(self, axes: Axes | None = None, **options: Any) -> Axes: ...
    def _repr_html_(self) -> str: ...

class Tabular(Drawn):
    def to_frame(self) -> DataFrame: ...
    def to_xarray(self) -> Dataset: ...
