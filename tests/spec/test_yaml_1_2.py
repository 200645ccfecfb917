"""YAML that is written and read again gives the same data."""

import yaml
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.spec import as_run, load, loads
from bemcontact.spec.yaml_1_2 import READERS, Loader, to_yaml

SCALARS = st.none() | st.booleans() | st.integers(-(10**9), 10**9) | st.floats(allow_nan=False, allow_infinity=False)
TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc")), max_size=12)
AWKWARD = st.sampled_from(
    ["2e6", "no", "on", "null", "~", "0x1F", "1_000", "12:30", "2001-01-01", ".inf", "<<", "=", ""]
)
DATA = st.recursive(
    SCALARS | TEXTS | AWKWARD,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXTS | AWKWARD, inner, max_size=3),
    max_leaves=8,
)


def read(text: str) -> object:
    """Data of a text, with the readers of a spec."""

    def value(node: yaml.Node) -> object:
        if isinstance(node, yaml.MappingNode):
            return {value(key): value(entry) for key, entry in node.value}
        if isinstance(node, yaml.SequenceNode):
            return [value(entry) for entry in node.value]
        return READERS[node.tag](node.value)

    return value(Loader(text).get_single_node())


@given(DATA)
def test_data_survives_writing_and_reading(data: object):
    assert read(to_yaml(data)) == data


def test_changed_text_gives_the_problem_with_its_changes(request):
    path = request.config.rootpath / "models" / "cylinder_on_plane.yaml"
    changes = ["material.young_modulus=2e6", "name='2e6'", "description='no'", "conditions.top.pressure=1e-7"]
    assert loads(as_run(path.read_text(), str(path), changes)) == load(path, changes)


def test_text_without_changes_keeps_its_comments():
    assert as_run("name: a  # why\n", "a.yaml") == "name: a  # why\n"
