"""Load cases and combinations in a spec, and the place and text of the error for each mistake."""

import pytest
from messages import assert_one_mistake, assert_states

import bemcontact
from bemcontact.errors import ProblemError
from bemcontact.problems import Problem

BODY = """\
name: block on a plane
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 2}
    - {name: right, start: [2, 0], elements: 2}
    - {name: top, start: [2, 1], elements: 2}
    - {name: left, start: [0, 1], elements: 2}
conditions: {top: {pressure: 5}, left: {displacement: {x: 0}}}
contact_zones:
  foot: {edges: bottom, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
tools:
  pad: {zones: foot, displacement: {x: 0}, force: {y: 10}}
"""


def spec(case: str, after: str = "") -> str:
    return f"{BODY}load_cases:\n  it: {case}\n{after}"


SUM = "combinations:\n  both: {it: 1.5}\n  none: {it: 0}\n"
GOOD = {
    "pressure": "{conditions: {top: {pressure: 1}}}",
    "traction beside a displacement": "{conditions: {left: {traction: {y: 1}}, right: {traction: {x: 2, y: 1}}}}",
    "displacement where there is one": "{conditions: {left: {displacement: {x: 0.1}}}}",
    "gravity": "{description: weight, loads: {gravity: {density: 1, acceleration: [0, -1]}}}",
    "tool": "{tools: {pad: {displacement: {x: 1}, force: {y: -2}}}}",
    "displacement of a tool that is fixed there": "{tools: {pad: {displacement: {x: 1}}}}",
    "all": "{conditions: {top: {pressure: 1}}, loads: {temperature: {expansion: 1e-5, change: 9}}, "
    "tools: {pad: {force: {y: 0}}}}",
}


@pytest.mark.parametrize("name", GOOD)
def test_each_load_case_is_read(name: str):
    problem = bemcontact.loads(spec(GOOD[name], SUM))
    assert problem.case_names == ("it", "both", "none")
    assert problem.case is None
    assert problem.factors() == {}
    assert (problem.factors("it"), problem.factors("both"), problem.factors("none")) == (
        {"it": 1},
        {"it": 1.5},
        {"it": 0},
    )
    assert problem.with_case("both").factors() == {"it": 1.5}
    assert Problem(**problem.model_dump()) == problem


def test_the_spec_may_choose_the_case_that_acts():
    assert bemcontact.loads(spec(GOOD["pressure"], "case: it\n")).factors() == {"it": 1}
    with pytest.raises(ProblemError, match=r"case: unknown .*'wind'.*'it'"):
        bemcontact.loads(spec(GOOD["pressure"])).with_case("wind")


def test_a_variant_sets_values_of_load_cases_and_names_the_one_that_acts():
    text = spec(GOOD["pressure"], "variants:\n  more: {set: {load_cases.it.conditions.top.pressure: 7, case: it}}\n")
    more = bemcontact.loads(text).variant("more")
    assert more.case == "it"
    assert more.load_cases["it"].conditions["top"].pressure.constant == 7
    with pytest.raises(bemcontact.SpecError, match=r"variants\.more.*unknown load case 'wind'"):
        bemcontact.loads(text.replace("case: it}", "case: wind}"))


REFUSED = {
    "nothing": ("{}", "{}", "load_cases.it: … empty; give conditions, loads or tools"),
    "description only": ("{description: wind}", "{desc", "load_cases.it: … empty"),
    "unknown edge": (
        "{conditions: {topp: {pressure: 1}}}",
        "topp",
        "load_cases.it.conditions.topp: unknown … 'topp' … 'top'?",
    ),
    "edge of a zone": (
        "{conditions: {bottom: {pressure: 1}}}",
        "bottom",
        "load_cases.it.conditions.bottom: … 'bottom' … contact zone 'foot'",
    ),
    "held in addition": (
        "{conditions: {left: {displacement: {x: 0, y: 0.1}}}}",
        "0.1",
        "add the displacement 0 along y",
    ),
    "held on a free edge": (
        "{conditions: {right: {displacement: {x: 0.1}}}}",
        "0.1",
        "load_cases.it.conditions.right.displacement.x: … free along x",
    ),
    "traction on a held edge": (
        "{conditions: {left: {traction: {x: 1}}}}",
        "1}}}}",
        "load_cases.it.conditions.left.traction.x: … prescribes the displacement … along x",
    ),
    "pressure on a held edge": (
        "{conditions: {left: {pressure: 1}}}",
        "1}}}",
        "load_cases.it.conditions.left.pressure: … prescribes the displacement … along x",
    ),
    "unknown tool": (
        "{tools: {pda: {force: {y: 1}}}}",
        "pda",
        "load_cases.it.tools.pda: unknown tool 'pda'; did you mean",
    ),
    "idle tool": (
        "{tools: {pad: {}}}",
        "{}",
        "load_cases.it.tools.pad: … no displacement … no force",
    ),
    "displacement of a free tool": (
        "{tools: {pad: {displacement: {y: 1}}}}",
        "1}}}}",
        "load_cases.it.tools.pad.displacement.y: the tool is free along y",
    ),
    "force on a held tool": (
        "{tools: {pad: {force: {x: 1}}}}",
        "1}}}}",
        "load_cases.it.tools.pad.force.x: … held along x; add x: 0",
    ),
    "moment on a held tool": (
        "{tools: {pad: {force: {moment: 1}}}}",
        "1}}}}",
        "load_cases.it.tools.pad.force.moment: … held in rotation; add moment: 0",
    ),
    "rotation without a point": (
        "{tools: {pad: {displacement: {rotation: 1}}}}",
        "1}}}}",
        "load_cases.it.tools.pad.displacement.rotation: a rotation needs a point",
    ),
    "unknown key": (
        "{conditons: {top: {pressure: 1}}}",
        "conditons",
        "load_cases.it.conditons: unknown key 'conditons'",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_each_mistake_is_reported_at_its_place(case: str):
    """The entry starts in line 15, column 7; the error gives the place of the wrong value in it."""
    text, wrong, words = REFUSED[case]
    assert_one_mistake(spec(text), f"15:{text.index(wrong) + 7}: load_cases.it", words)


@pytest.mark.parametrize(
    ("after", "words"),
    [
        (
            "combinations: {it: {it: 1}}",
            "combinations.it: … name 'it' … give … another name",
        ),
        (
            "combinations: {sum: {it: 1, wind: 2}}",
            "combinations.sum.wind: unknown … 'wind' … 'it'",
        ),
        (
            "combinations: {sum: {}}",
            "combinations.sum: … empty; give load cases",
        ),
        ("combinations: {sum: {it: big}}", "combinations.sum.it: expected a number, found the text"),
        ("case: wind", "case: unknown … 'wind' … 'it'"),
    ],
)
def test_combinations_and_the_acting_case_fit_the_load_cases(after: str, words: str):
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(spec(GOOD["pressure"], after), "body.yaml")
    [line] = str(caught.value).splitlines()
    assert line.startswith("body.yaml:16:")
    assert_states(line, words)


def test_a_case_without_load_cases_is_refused():
    with pytest.raises(bemcontact.SpecError, match="case: unknown load case 'wind'; there are none"):
        bemcontact.loads(BODY + "case: wind\n")


def test_all_mistakes_are_reported_at_once():
    text = spec(
        "{conditions: {left: {pressure: 1}}, tools: {pda: {force: {y: 1}}}}", "combinations: {sum: {wind: 2}}\n"
    )
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(text)
    assert [line.split()[1] for line in str(caught.value).splitlines()] == [
        "load_cases.it.conditions.left.pressure:",
        "load_cases.it.tools.pda:",
        "combinations.sum.wind:",
    ]
