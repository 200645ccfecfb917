"""JSON Schemas of all results that are written as JSON."""

from typing import Any

from bemcontact.analysis.case_comparisons import CaseComparisonsRecord
from bemcontact.analysis.load_cases import CasesRecord
from bemcontact.analysis.mesh_study import MeshStudyRecord
from bemcontact.analysis.reproduction import ReproductionRecord
from bemcontact.analysis.result import ResultRecord
from bemcontact.assessment.comparison import ComparisonRecord
from bemcontact.contact.multistart import RandomStarts
from bemcontact.modelling.gap_design.designed_gap import GapDesign
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.parametric.path import LoadPath
from bemcontact.parametric.sensitivity import Sensitivities
from bemcontact.serialization import Leaf, Record, schema_of
from bemcontact.studies.table import StudyRecord

RESULTS: dict[str, type[Leaf] | type[Record]] = {
    "result": ResultRecord,
    "cases": CasesRecord,
    "comparison": ComparisonRecord,
    "report": MeshStudyRecord,
    "case_report": CaseComparisonsRecord,
    "reproduction": ReproductionRecord,
    "path": ParameterPath,
    "study": StudyRecord,
    "load_path": LoadPath,
    "sensitivities": Sensitivities,
    "starts": RandomStarts,
    "design": GapDesign,
}
"""Kind of a result -> the class whose fields JSON has."""


def schema(kind: str) -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a kind of result, a key of `RESULTS`."""
    return schema_of(RESULTS[kind])
