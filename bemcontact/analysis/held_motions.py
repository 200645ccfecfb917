"""Free motions that only slopes and levers as drawn hold: how far a body moves along them is not known.

All that is said of this follows from the eigenvalues of T, see `MotionSeries`: which amounts are not known, and which
motions a body goes on in where it has moved to. If a load or a noticeable slope drives it there, that is the verdict.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np
import scipy

from bemcontact.analysis.motion_series import UNSEEN, MotionSeries
from bemcontact.analysis.moved_contact import Judgement, MovedContact, noted
from bemcontact.arrays import Array, BoolArray, magnitudes, norm, row_norms
from bemcontact.assessment.accuracy import Accuracy, ErrorBar
from bemcontact.assessment.penetration import Misfit, Penetration
from bemcontact.bem.body import Body
from bemcontact.bem.body_motions import amounts
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.condense import Condensation
from bemcontact.bem.free_motions import FreeMotions
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.known_motions import KnownMotions
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen

MOVES_ON = 0.5
"""Eigenvalue of T from which the series adds as much as the first motion, or more, so that its amount is not known."""
TAKES_PART = 0.01
"""Part of a motion in one whose amount is not known from which its own is not known.

Nor is it if as much again of the latter changes it by a part that is noted."""
NOT_KNOWN = "not known: only slopes and levers as drawn hold it, which move with the body"
"""Note on a motion without an amount."""
LOOSE = 0.8
"""Eigenvalue from which a body goes on to five times of the first motion, or farther."""
NOTHING = 0.95
"""Eigenvalue from which nothing holds a motion: it is one up to the error of the mesh."""
DRIVEN = 1e-6
"""Force along a motion, over that of contact that moves in it, that is more than rounded numbers."""
PURE = 0.01
"""Part of what drives all motions that contact does not resist, from which it drives one of them."""
EXACT = 0.99
"""Part of a motion without any along lines of force from which it is exactly that, but for the error of the mesh."""
NAMED = 0.01
"""Least share of a free motion that a sentence names, and by which two bodies move together."""


@frozen
class MovingBody:
    """Free motions of a solution, with the boundary behind the contact points.

    Parameters
    ----------
    body, contact : that move
    known : what is known of their amounts, as of `body_motions.amounts`
    errors : (k,) of the amounts [rad] or [L], because normals and levers are those as drawn; zero where not known
    unsure : part of the largest displacement [L] by motions whose amount is not known
    """

    body: Body
    contact: CondensedContact
    known: KnownMotions
    errors: Array
    unsure: float

    @classmethod
    def of(
        cls, condensation: Condensation, boundary: BoundaryState, solution: ContactSolution, series: MotionSeries
    ) -> Self:
        """The motions of a solution with this series."""
        body, contact = condensation.body, condensation.contact
        held, errors, unheld = _held(series, solution.rigid_amplitudes, noted(body.problem))
        amplitudes, moved = solution.rigid_amplitudes, boundary.displacement
        found, arms = amounts(body, amplitudes, moved), np.where(turns(body), body.seen.arms, 1.0)
        known = KnownMotions.of(contact, solution, np.where(turns(body), found, 0.0), held, turns(body))
        most = np.unravel_index(magnitudes(moved).argmax(), moved.shape[:2])
        ways = body.seen_ways[body.mesh.elements[most]]
        unsure = abs(norm(moved[most]) - norm(moved[most] - ways @ unheld @ (found * arms)))
        return cls(body=body, contact=contact, known=known, errors=errors / arms, unsure=unsure)

    def judged(self, accuracy: Accuracy) -> Accuracy:
        """Accuracy without error bars of what is not known, and with the errors of slopes and levers in the others."""
        return replace(accuracy, bars=tuple(map(self._judged, accuracy.bars)))

    def _judged(self, bar: ErrorBar) -> ErrorBar:
        """An error bar, if it is of a motion, or of the largest displacement."""
        if bar.quantity == "displacement" and bar.bar is not None and bar.value is not None:
            part = self.unsure / bar.value if bar.value else 0.0
            if part <= max(bar.bar, noted(self.body.problem)):
                return replace(bar, bar=bar.bar + part)
            moving = " and the ".join(self.known.unknown)
            amount = "amount is" if len(self.known.unknown) == 1 else "amounts are"
            why = f"not known: it has a part of the {moving}, whose {amount} not known"
            return replace(bar, value=None, bar=None, at=None, note=why)
        if bar.quantity not in ("motion", "rotation") or bar.value is None or bar.bar is None:
            return bar
        known, error = self._of_mover(bar)
        if not known:
            return replace(bar, value=None, bar=None, note=NOT_KNOWN)
        part = error / abs(bar.value)
        return replace(bar, bar=bar.bar + part) if part >= noted(self.body.problem) else bar

    def _of_mover(self, bar: ErrorBar) -> tuple[bool, float]:
        """Whether the amount of a motion or a rotation is known, and its error [L] or [rad]."""
        names, tools = self.contact.motion_names, self.contact.tools
        if bar.mover in names:
            return bar.mover not in self.known.unknown, float(self.errors[names.index(bar.mover)])
        number = tools.names.index(str(bar.mover))
        ways = slice(0, 2) if bar.quantity == "motion" else slice(2, 3)
        moved = abs(tools.amplitudes[3 * number : 3 * number + 3][ways])
        amplitudes = self.errors * np.where(turns(self.body), self.body.seen.arms, 1.0)
        return bool(self.known.tools[number, ways].all()), float(norm(moved @ amplitudes))


def turns(body: Body) -> BoolArray:
    """Which free motions (k,) turn something."""
    return np.isfinite(body.seen.arms)


def _held(series: MotionSeries, amplitudes: Array, part: float) -> tuple[BoolArray, Array, Array]:
    """Free motions (k,) that something holds beside slopes and levers as drawn, and the errors (k,) by these [L].

    From amplitudes (k,), and the `part` by which a change of one is noted. The errors are zero where nothing else
    holds. Also the part (k, k) of amplitudes along the ways that nothing else holds.
    """
    if not series.steps.any():
        return np.ones(len(amplitudes), bool), np.zeros(len(amplitudes)), np.zeros((len(amplitudes), len(amplitudes)))
    form, free, others = series.split(MOVES_ON)
    count, sizes = free.shape[1], series.sizes
    known = form[count:, count:]
    mixed = scipy.linalg.solve_sylvester(form[:count, :count], -known, form[:count, count:]) if count else form[:0]
    unheld = free @ (free.T + mixed @ others.T) if count else np.zeros_like(form)
    amplitudes = amplitudes * sizes
    most = np.maximum(part * abs(amplitudes), UNSEEN * abs(amplitudes).max(initial=0.0))
    held = (row_norms(free) <= TAKES_PART) & (abs(unheld @ amplitudes) <= most)
    first = others.T @ amplitudes
    further = np.linalg.solve(np.eye(len(known)) - known, known @ first)
    errors = np.where(held, abs(others @ further) / sizes, 0.0)
    return held, errors, unheld / sizes[:, None] * sizes


@frozen
class LooseMotions:
    """Motions in which bodies go on where they have moved to, for hardly anything holds them there.

    Parameters
    ----------
    first : the solution, and where its motion takes contact
    series : of its steps
    free : the k free motions of contact
    ways : (n, 2, k) motion of the contact points against their surfaces in each of them
    gained : (k,) work in each of them that forces gain by the motion
    """

    first: MovedContact
    series: MotionSeries
    free: FreeMotions
    ways: Array
    gained: Array

    def judged(self) -> Judgement:
        """Find what goes on although it should not, or else note what a little friction holds.

        A flat block slides on a round support, whose normals are tilted beside the place where it touches. It would
        move until the tilt balances the load, but takes the place of contact with it. So does a disc that a couple
        rolls along a plane: it would turn until the lever of the pressure balances the couple. A motion that slopes
        drive by a small part of the forces, as that of a roller between bodies that bend, is noted.
        """
        first, found = self.first, [*map(self._motion, self._together())]
        if not found:
            return None, ()
        lengths = first.contact.lengths_by_zone @ (first.solution.pressure > 0)
        least = first.noted * float(lengths[lengths > 0].min(initial=np.inf))
        pushed = [it for it in found if (1 + it.part) * it.moved >= least and not it.driven]  # else noise of the mesh
        refused = [it for it in found if it.driven and (it.part >= NOTHING or it.moved >= (1 - it.part) * least)]
        if refused := [*refused, *(it for it in pushed if it.push >= first.noted)]:
            return self._refused(max(refused, key=lambda it: it.moved)), ()
        if said := [it for it in pushed if it.part >= NOTHING and it.push > DRIVEN]:
            most = max(said, key=lambda it: it.push)
            driven = ", and no load drives it" * most.exact
            words = (
                f"no contact holds the {self._named(most)}{driven}: {_pushes(most)}; its amount is not known, and a "
                "little friction holds it"
            )
            return None, (words,)
        return None, ()

    @property
    def amplitudes(self) -> Array:
        """Amplitudes (k,) of the first solution in these motions, without those of others."""
        ways, sizes = self.series.split(LOOSE)[1], self.series.sizes
        return ways @ (ways.T @ (self.first.solution.rigid_amplitudes * sizes)) / sizes

    def left_out_of(self, contact: CondensedContact) -> CondensedContact:
        """A contact with these motions held where the first solution has them, for no judgement needs their amounts."""
        others, sizes = self.series.split(LOOSE)[2], self.series.sizes
        if others.shape[1] == contact.free_motions:
            return contact
        others = others / sizes[:, None]
        return CondensedContact.from_compliance(
            contact.compliance, contact.offset + contact.rigid_motions @ self.amplitudes, contact.weights,
            rigid_motions=contact.rigid_motions @ others, motion_load=contact.motion_load @ others,
        )  # fmt: skip

    def _refused(self, it: "_Loose") -> Penetration:
        """Say that a motion goes on."""
        first, contact = self.first, self.first.contact
        i = int(np.argmax(contact.weights * first.solution.pressure * abs(contact.rigid_motions @ it.way)))
        why = " against the load" if it.driven else f": {_pushes(it)}"
        words = (
            f"{'No contact holds' if it.part >= NOTHING else 'Contact hardly holds'} the {self._named(it)}{why}. Only "
            "slopes and levers as drawn seem to hold it, and they move with the body. Along this motion contact moves "
            f"by {first.length(it.moved)}, from there on by {100 * it.part:.0f} % of that, and so on. Prescribe a "
            "displacement that holds the body in this direction."
        )
        return first.misfit(Misfit.MOVED, words, i, it.moved)

    def _named(self, it: "_Loose") -> str:
        """Name a motion."""
        return self.free.combined(np.where(abs(it.way) < NAMED * abs(it.way).max(), 0.0, it.way)[:, None]).describe()[0]

    def _together(self) -> Iterator[Array]:
        """Amplitudes (k, j) of the motions of each body, or of each group of bodies that move together."""
        ways = self.series.split(LOOSE)[1] / self.series.sizes[:, None]
        if not ways.shape[1]:
            return
        moved, size, turned = np.linalg.svd(self.free.coefficients.T @ ways, full_matrices=False)
        ways = ways @ turned.T / size
        parts = moved.reshape(-1, 3, ways.shape[1])
        linked = abs(np.einsum("axi,byi->abxy", parts, parts)).max(axis=(2, 3)) > NAMED
        for group in np.unique(np.linalg.matrix_power(linked, len(parts)), axis=0):
            _, own, combined = np.linalg.svd(parts[group].reshape(-1, ways.shape[1]))
            if (own > 0.5).any():
                yield ways @ combined[: len(own)][own > 0.5].T

    def _motion(self, ways: Array) -> "_Loose":
        """That of some motions, with amplitudes (k, j), that load or slopes drive most."""
        first, contact, sizes, unresisted = self.first, self.first.contact, self.series.sizes, self.series.unresisted
        force, ways = contact.weights * first.solution.pressure, np.linalg.qr(ways * sizes[:, None])[0]
        goes = self.ways / sizes @ ways
        load = unresisted.T @ (contact.motion_load / sizes)
        along, least = ways.T @ unresisted @ load, DRIVEN * float(force @ np.sqrt((goes**2).sum(axis=(1, 2))))
        driven = norm(along) > max(least, PURE * norm(load))
        work = along if driven else ways.T @ (self.gained / sizes)
        steps = ways @ np.linalg.lstsq(np.einsum("n,nxj,nxk->jk", force, goes, goes), work)[0]
        steps = steps if steps.any() else ways[:, 0]
        free = unresisted @ (unresisted.T @ steps)
        exact = norm(free) > EXACT * norm(steps)
        steps = free if exact else steps
        way = steps / sizes
        goes = self.ways @ way
        most = float(force @ magnitudes(goes)) or 1.0
        return _Loose(
            way=way / np.copysign(norm(way), way[abs(way).argmax()]),
            part=float(steps @ self.series.steps @ steps / (steps @ steps)),
            moved=abs(float(np.einsum("n,nx,nx", force, first.moved.motion, goes))) / most,
            driven=driven and exact,
            exact=exact,
            push=abs(float(self.gained @ way)) / most,
        )


class _Loose(NamedTuple):
    """A motion that goes on.

    Parameters
    ----------
    way : (k,) its amplitudes
    part : by which it goes on
    moved : by which contact has moved along it [L]
    driven : whether a load acts along it
    exact : whether this is certain: no line of force has a part along it
    push : force along it at the displaced places, over the force of all contacts that move in it: so it is the
        coefficient of friction that holds the body there
    """

    way: Array
    part: float
    moved: float
    driven: bool
    exact: bool
    push: float


def _pushes(it: _Loose) -> str:
    """Say by how much slopes push, or loads if they are not told from slopes."""
    return f"slopes{' or loads' * (not it.exact)} push along it by {100 * it.push:.2g} % of the force of contact"
