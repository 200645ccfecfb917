"""The options of solving and comparing. There are no numerics here, so that ``bemcontact --help`` answers at once."""

from bemcontact.options.asking import ASKING as ASKING
from bemcontact.options.asking import AskedAccuracy as AskedAccuracy
from bemcontact.options.asking import AskingKeywords as AskingKeywords
from bemcontact.options.comparing import ComparisonOptions as ComparisonOptions
from bemcontact.options.declaration import EXPECTED_ACCURACY as EXPECTED_ACCURACY
from bemcontact.options.declaration import STARTS as STARTS
from bemcontact.options.declaration import ensure_known as ensure_known
from bemcontact.options.declaration import ensure_whole as ensure_whole
from bemcontact.options.declaration import named as named
from bemcontact.options.drawing import StressMeasure as StressMeasure
from bemcontact.options.solving import COMPARED as COMPARED
from bemcontact.options.solving import USES as USES
from bemcontact.options.solving import ComparingKeywords as ComparingKeywords
from bemcontact.options.solving import ComparisonKeywords as ComparisonKeywords
from bemcontact.options.solving import ConvexSolver as ConvexSolver
from bemcontact.options.solving import Equilibrium as Equilibrium
from bemcontact.options.solving import FormulationName as FormulationName
from bemcontact.options.solving import Rows as Rows
from bemcontact.options.solving import SearchKeywords as SearchKeywords
from bemcontact.options.solving import SolveKeywords as SolveKeywords
from bemcontact.options.solving import SolveOptions as SolveOptions
from bemcontact.options.solving import SolvingKeywords as SolvingKeywords
from bemcontact.options.solving import StartName as StartName
from bemcontact.options.solving import StatementKeywords as StatementKeywords
from bemcontact.options.solving import Weights as Weights
from bemcontact.options.solving import options_of as options_of
