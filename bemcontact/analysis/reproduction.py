"""From the files of the paper's problems to answers on all their meshes."""

from collections.abc import Sequence

from bemcontact import spec
from bemcontact.analysis import compare as comparing
from bemcontact.analysis import shipped_models as shipped
from bemcontact.analysis.paper import PROBLEMS, PaperProblem
from bemcontact.analysis.reproduced import Reproduced, Reproduction, Run
from bemcontact.analysis.stopwatch import Progress
from bemcontact.analysis.study import MeshLevel
from bemcontact.options import ComparisonOptions
from bemcontact.problem import Problem


def reproduce(
    refine: Sequence[int] = (1, 4), progress: Progress | None = None, problems: Sequence[PaperProblem] = PROBLEMS
) -> Reproduction:
    """Solve the problems of the paper by all formulations and by the direct one, on their meshes and refined ones.

    Parameters
    ----------
    refine : parts into which the elements of the problems are cut, for each mesh; variants are not refined
    progress : called with the name of each problem as it begins, and how far it has come
    problems : of the paper

    Returns
    -------
    Reproduction
        Check `reproduced`.

    Raises
    ------
    OptionError
        No mesh, one that is there twice, or a refinement that is not a whole number.
    """
    plan = ComparisonOptions()
    done = []
    for order, paper in enumerate(problems, 1):
        name = f"problem {order} of {len(problems)}, {paper.model.replace('_', ' ')}"
        done.append(_reproduced(plan, paper, refine, _below(progress, name)))
    return Reproduction(problems=tuple(done), refine=tuple(sorted(map(int, refine))))


def _below(progress: Progress | None, name: str) -> Progress:
    """Tell each stage of a problem as how far the problem has come."""
    return lambda stage, now: progress(name, f"{stage}, {now}" if now else stage) if progress else None


def _reproduced(plan: ComparisonOptions, paper: PaperProblem, refine: Sequence[int], tell: Progress) -> Reproduced:
    """Solve one problem, as stated on all meshes and with its variants."""
    problem = _problem(paper, None)
    meshes = comparing.study(plan, problem, refine, tell).levels
    return Reproduced(
        paper=paper,
        problem=problem,
        variants=tuple(
            Run(
                label=label,
                variant=variant,
                description=problem.variants[variant].description,
                level=_once(plan, _problem(paper, variant), tell),
            )
            for variant, label in paper.variants.items()
        ),
        meshes=tuple(Run(label=_fineness(level.refine), variant=None, level=level) for level in meshes),
    )


def _fineness(parts: int) -> str:
    """What a mesh of the problem as stated is called."""
    return "base mesh" if parts == 1 else f"{parts} times finer"


def _problem(paper: PaperProblem, variant: str | None) -> Problem:
    """Read a problem, or a variant of it."""
    return spec.loads(shipped.model(paper.model), f"models/{paper.model}.yaml", variant=variant)


def _once(plan: ComparisonOptions, problem: Problem, tell: Progress) -> MeshLevel:
    """Solve a problem on the mesh that it states."""
    return comparing.study(plan, problem, (1,), tell).finest
