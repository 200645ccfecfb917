"""Files of condensed problems: whole ones are read back, damaged ones are refused in words, whatever the damage."""

import io
import tracemalloc
import zipfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from contact_problems import random_contact
from hypothesis import given, settings
from hypothesis import strategies as st
from tool_problems import HELD, HELD_CASES, made

import bemcontact
from bemcontact.contact import archive
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import BemContactError, ProblemError

Members = dict[str, bytes]

PLAIN = random_contact(0, 4, 1)
BODY = bemcontact.condense(made(HELD, **HELD_CASES))


def content_of(contact: CondensedContact, folder: Path) -> bytes:
    contact.save(folder / "whole.npz")
    return (folder / "whole.npz").read_bytes()


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("archives")
    return {"plain": content_of(PLAIN, folder), "body": content_of(BODY, folder)}


def same(one: Any, other: Any) -> bool:
    """Whether two problems are the same, to the bit."""
    if is_dataclass(one):
        return all(same(getattr(one, item.name), getattr(other, item.name)) for item in fields(one))
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    return type(one) is type(other) and one == other


def members_of(content: bytes) -> Members:
    with zipfile.ZipFile(io.BytesIO(content)) as package:
        return {name: package.read(name) for name in package.namelist()}


def packed(members: Members, compression: int = zipfile.ZIP_STORED) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", compression) as package:
        for name, content in members.items():
            package.writestr(name, content)
    return stream.getvalue()


def npy(array: Any, allow_pickle: bool = False) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=allow_pickle)
    return stream.getvalue()


def array_in(member: bytes) -> Any:
    return np.load(io.BytesIO(member))


def read_back(content: bytes, place: Path) -> CondensedContact | None:
    """The problem in a file, or None if it is refused with the name of the file."""
    place.write_bytes(content)
    try:
        return CondensedContact.load(place)
    except ProblemError as error:
        text = str(error)
    assert text.startswith(f"{place}: ")
    assert len(text) < 600
    return None


def signed(members: Members) -> Members:
    """The members with a checksum that fits them, as a careful liar would write it."""
    names = {*archive._names(CondensedContact, "")}
    arrays = {name: array_in(members[f"{name}.npy"]) for name in names if f"{name}.npy" in members}
    return {**members, "checksum.npy": npy(np.array(archive._checksum(arrays)))}


def altered(array: np.ndarray, way: int, rng: np.random.Generator) -> Any:
    """Another array in place of this one."""
    index = tuple(int(rng.integers(length)) for length in array.shape) if array.size else None
    other = array.copy()
    if way == 0 and index is not None and array.dtype.kind in "fiu":
        other[index] = other[index] * 2 + 1
    elif way == 1 and index is not None and array.dtype.kind == "f":
        other[index] = rng.choice([np.nan, np.inf, -np.inf, 1e308])
    elif way == 2:
        other = array[..., None]
    elif way == 3 and array.ndim and array.size:
        other = array[::-1]
    elif way == 4:
        other = array.astype(rng.choice(["c16", "U9", "S9"])) if array.dtype.kind == "f" else np.array(["a", "b"])
    elif way == 5 and array.ndim and array.size:
        other = array[:-1]
    elif way == 6 and array.dtype.kind in "fiu":
        other = array.astype("f4") + np.float32(0.5)
    elif way == 7:
        other = np.zeros(0)
    elif way == 8:
        other = np.array(None)
    return other


@pytest.mark.parametrize("contact", [PLAIN, BODY], ids=["plain", "body"])
def test_what_is_saved_is_read_back(contact: CondensedContact, tmp_path: Path):
    again = read_back(content_of(contact, tmp_path), tmp_path / "a.npz")
    assert again is not None
    assert same(again, contact)


@settings(max_examples=100)
@given(which=st.sampled_from(["plain", "body"]), data=st.data())
def test_bytes_that_change_give_an_error_or_the_same_problem(which: str, data: st.DataObject, whole, tmp_path_factory):
    """Flipped, inserted and removed bytes anywhere in the file, and cut ends."""
    content = bytearray(whole[which])
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(content) - 1))
        match data.draw(st.sampled_from(["flip", "insert", "remove", "cut"])):
            case "flip":
                content[at] ^= data.draw(st.integers(1, 255))
            case "insert":
                content[at:at] = data.draw(st.binary(min_size=1, max_size=8))
            case "remove":
                del content[at : at + data.draw(st.integers(1, 64))]
            case _:
                del content[at:]
        if not content:
            break
    found = read_back(bytes(content), tmp_path_factory.getbasetemp() / "bytes.npz")
    assert found is None or same(found, PLAIN if which == "plain" else BODY)


@pytest.mark.slow
@settings(max_examples=100)
@given(which=st.sampled_from(["plain", "body"]), data=st.data())
def test_members_that_change_give_an_error_or_the_same_problem(
    which: str, data: st.DataObject, whole, tmp_path_factory
):
    members = members_of(whole[which])
    name = data.draw(st.sampled_from(sorted(members)))
    way = data.draw(st.integers(0, 12))
    if way <= 8:
        rng = np.random.default_rng(data.draw(st.integers(0, 99)))
        members[name] = npy(altered(array_in(members[name]), way, rng), allow_pickle=True)
    elif way == 9:
        del members[name]
    elif way == 10:
        members[f"{name}x"] = members.pop(name)
    elif way == 11:
        members["nested.npy"] = members[name] = packed(members)
    else:
        members[name] = data.draw(st.binary(max_size=200))
    found = read_back(packed(members), tmp_path_factory.getbasetemp() / "members.npz")
    assert found is None or same(found, PLAIN if which == "plain" else BODY)


@pytest.mark.slow
@settings(max_examples=80)
@given(which=st.sampled_from(["plain", "body"]), way=st.integers(0, 8), seed=st.integers(0, 99), data=st.data())
def test_a_false_problem_with_a_true_checksum_is_refused_or_solvable(
    which: str, way: int, seed: int, data: st.DataObject, whole, tmp_path_factory
):
    """A checksum proves no sense: what is read has to state a problem, to which there is an answer or an error."""
    members = members_of(whole[which])
    names = sorted(name for name in members if name not in ("format.npy", "checksum.npy"))
    name = data.draw(st.sampled_from(names))
    member = altered(array_in(members[name]), way, np.random.default_rng(seed))
    try:
        members = signed({**members, name: npy(member)})
    except ValueError:
        return  # an array of objects, which needs a pickle
    found = read_back(packed(members), tmp_path_factory.getbasetemp() / "signed.npz")
    if found is not None:
        assert np.isfinite(found.compliance).all()
        np.testing.assert_allclose(np.hypot(*found.normals.T), 1.0, atol=1e-9)
        with suppress(BemContactError):
            bemcontact.solve(found, "complementarity")


BREAKS: dict[str, tuple[str, Callable[[np.ndarray], Any], str]] = {
    "doubled normals": ("normals", lambda normals: 2 * normals, "normals must be unit vectors"),
    "fractional zones": ("zone", lambda zone: zone + 0.5, "zone must contain whole numbers"),
    "other zones": ("zone", lambda zone: zone + 7, "zone has numbers from 7"),
    "negative runs": ("run", lambda run: run - 1, "run has numbers from -1"),
    "reversed arc positions": ("arc_position", lambda arc: arc[::-1], "with rising arc_position"),
    "load case of nothing": ("cases.displacement", lambda array: array * np.nan, "cases.displacement has entries"),
    "negative weights": ("weights", lambda weights: -weights, "weights must be positive"),
    "weights of another zone": ("zone_weights", lambda weights: 2 * weights, "add up to the weights"),
    "no run length": ("run_length", lambda length: -length, "run_length must be positive"),
    "a name of numbers": ("name", lambda _: np.zeros(3), "member 'name' is no text: it has the shape"),
    "names of numbers": ("zone_names", lambda _: np.zeros(2), "zone_names must be a list of texts"),
    "units of nothing": ("units", lambda _: np.zeros(2), "member 'units' is no list of pairs: it has the shape"),
    "notes of nothing": ("notes", lambda _: np.array(1.0), "member 'notes' is no list: it has the shape"),
    "dependent motions": ("rigid_motions", lambda R: 0 * R, "independent columns"),
    "tools as numbers": (
        "tools.free",
        lambda free: free.astype(float),
        "tools.free must contain True and False",
    ),
    "a length of many": ("pinned.length", lambda _: np.zeros(3), "member 'pinned.length' is no number"),
    "a length of nothing": ("pinned.length", lambda _: np.array(np.nan), "pinned.length must be a finite number"),
}


@pytest.mark.parametrize("name", BREAKS)
def test_false_members_are_named(name: str, whole, tmp_path: Path):
    member, change, words = BREAKS[name]
    members = members_of(whole["body"])
    members[f"{member}.npy"] = npy(change(array_in(members[f"{member}.npy"])))
    place = tmp_path / "false.npz"
    place.write_bytes(packed(signed(members)))
    with pytest.raises(ProblemError, match=words):
        CondensedContact.load(place)


def test_a_missing_member_is_named(whole, tmp_path: Path):
    members = members_of(whole["body"])
    del members["compliance.npy"]
    (tmp_path / "a.npz").write_bytes(packed(signed(members)))
    with pytest.raises(ProblemError, match=r"a\.npz: member 'compliance' is missing"):
        CondensedContact.load(tmp_path / "a.npz")


def test_members_that_nobody_knows_are_not_read(whole, tmp_path: Path):
    """A gigabyte of zeros beside the problem costs nothing."""
    (tmp_path / "bomb.npz").write_bytes(whole["body"])
    with zipfile.ZipFile(tmp_path / "bomb.npz", "a", zipfile.ZIP_DEFLATED) as package:
        package.writestr("other.npy", bytes(1 << 24))
    reads = []
    original = zipfile.ZipFile.open
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(zipfile.ZipFile, "open", lambda self, item, *a: reads.append(item) or original(self, item, *a))
        assert same(CondensedContact.load(tmp_path / "bomb.npz"), BODY)
    assert not [item for item in reads if getattr(item, "filename", item) == "other.npy"]


def test_compressed_members_are_refused_before_they_are_read(whole, tmp_path: Path):
    (tmp_path / "a.npz").write_bytes(packed(members_of(whole["body"]), zipfile.ZIP_DEFLATED))
    with pytest.raises(ProblemError, match="member 'format' is damaged: it is compressed"):
        CondensedContact.load(tmp_path / "a.npz")


@pytest.mark.parametrize(
    ("name", "large"),
    [
        ("weights", np.zeros(1 << 16)), ("compliance", np.zeros((1 << 8, 1 << 8))), ("name", np.array("a" * (1 << 16))),
        ("format", np.array("a" * (1 << 16))), ("notes", np.array(["a" * (1 << 8)] * (1 << 8))),
    ],
)  # fmt: skip
def test_a_member_that_no_problem_of_this_size_has_is_not_read(name: str, large, whole, tmp_path: Path, monkeypatch):
    """Its head states what the file has, beside four contact points."""
    monkeypatch.setattr(archive, "ROOM", 1 << 12)
    place = tmp_path / "large.npz"
    place.write_bytes(packed({**members_of(whole["plain"]), f"{name}.npy": npy(large)}))
    with pytest.raises(ProblemError, match=rf"member '{name}' is damaged: it has \d+ bytes where compliance and"):
        CondensedContact.load(place)


def test_a_problem_of_the_least_room_is_read(whole, tmp_path: Path, monkeypatch):
    """What is saved needs no more than its head, its names and four times its compliance."""
    monkeypatch.setattr(archive, "ROOM", 1 << 12)
    assert read_back(whole["plain"], tmp_path / "a.npz") is not None
    assert read_back(whole["body"], tmp_path / "b.npz") is not None


@pytest.mark.parametrize("shape", [(1 << 40,), (1 << 62, 1 << 62), (-4, 4), (1 << 31, 1 << 31, 0)])
def test_declared_sizes_are_not_believed(shape: tuple[int, ...], whole, tmp_path: Path):
    members = members_of(whole["plain"])
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": "<f8", "fortran_order": False, "shape": shape})
    members["compliance.npy"] = stream.getvalue() + bytes(128)
    assert read_back(packed(members), tmp_path / "a.npz") is None


def test_sizes_in_the_directory_are_not_believed(whole, tmp_path: Path):
    """The directory of the archive says that each member has 4 GB."""
    content = bytearray(whole["plain"])
    start = 0
    while (start := content.find(b"PK\x01\x02", start)) >= 0:
        content[start + 20 : start + 28] = b"\xf0\xff\xff\xff" * 2
        start += 4
    assert read_back(bytes(content), tmp_path / "a.npz") is None


def test_objects_are_not_unpickled(whole, tmp_path: Path):
    class Loud:
        def __reduce__(self):
            return (pytest.fail, ("unpickled",))

    members = members_of(whole["plain"])
    members["points.npy"] = npy(np.array([Loud()], object), allow_pickle=True)
    (tmp_path / "a.npz").write_bytes(packed(members))
    with pytest.raises(ProblemError, match="member 'points' is damaged: it has data of type object"):
        CondensedContact.load(tmp_path / "a.npz")


def test_places_without_a_file_are_refused(tmp_path: Path):
    for place in (tmp_path, tmp_path / "none.npz", Path("/dev/zero")):
        with pytest.raises(ProblemError, match=str(place)):
            CondensedContact.load(place)


def test_another_problem_is_another_answer(whole, tmp_path: Path):
    """The checksum of one file does not fit the members of another."""
    other = members_of(content_of(replace(PLAIN, initial_gap=PLAIN.initial_gap + 1e-12), tmp_path))
    mixed = {**members_of(whole["plain"]), "initial_gap.npy": other["initial_gap.npy"]}
    (tmp_path / "a.npz").write_bytes(packed(mixed))
    with pytest.raises(ProblemError, match="the file is damaged: its checksum does not fit"):
        CondensedContact.load(tmp_path / "a.npz")


def test_a_member_is_judged_by_its_head_before_it_is_read(tmp_path: Path):
    head = io.BytesIO()
    np.save(head, np.array("bemcontact.condensed.5"))
    path = tmp_path / "large.npz"
    with zipfile.ZipFile(path, "w") as package:
        package.writestr("format.npy", head.getvalue() + bytes(50_000_000))
    tracemalloc.start()
    with pytest.raises(ProblemError, match=r"member 'format' is damaged: it has 500000.. bytes where its shape"):
        CondensedContact.load(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5_000_000
