"""Structures: matrices of mass, damping and stiffness with contacts on a moving belt."""

import copy
import dataclasses
import hashlib
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np
import scipy.sparse as sp

from squealpipe.parameters import finite_number
from squealpipe.structures.contact import (
    Contact,
    by_rows,
    directions,
    same_directions,
    transversals,
)
from squealpipe.structures.friction import Friction, default_mu, friction_of, has_own_mu
from squealpipe.structures.matrices import checked_mass, real_square, sum_of_products
from squealpipe.structures.meshes.faces import Rotation
from squealpipe.structures.meshes.structure_mesh import StructureMesh
from squealpipe.structures.pencil import sparse_rows
from squealpipe.structures.speed_terms import SpeedTerms
from squealpipe.systems.inputs.values import brief, numbers_in_si
from squealpipe.systems.inputs.words import says_what_was_meant
from squealpipe.validation import real_array


class ReducedFrom(NamedTuple):
    """Origin of a reduced structure.

    Attributes:
        whole: the structure of all degrees of freedom.
        frequency_max: end of the band in which the modes of both are compared, Hz; None: all.
        truth: modes of the whole (:class:`.agreement.Truth`), where they are known already.
        directions: static responses of each contact among the coordinates: 0 none, 1 the normal
            one, 2 both.
    """

    whole: "ContactStructure"
    frequency_max: float | None
    truth: Any = None
    directions: int = 0


@says_what_was_meant
class ContactStructure:
    """M q̈ + C q̇ + K q = f + Σ (nᵢ Nᵢ + tᵢ Tᵢ): an elastic structure with contacts on a belt.

    Friction Tᵢ is μ(|wᵢ|) Nᵢ sgn wᵢ in slip, at most μ_s Nᵢ in stick, with the sliding speed
    wᵢ = speedᵢ · belt_speed − tᵢᵀq̇. Consistent units of any system work; names here are SI's.
    Numbers may be texts with a unit, like ``7.2 km/h``.

    Args:
        mass: M, (n, n), dense or sparse, symmetric and positive definite, kg.
        stiffness: K, N/m; parts that are not symmetric are allowed.
        damping: C, N s/m; likewise. None: none.
        modal_damping: a damping ratio for all modes, or one for each of the lowest: the modes are
            those of (M, K + Σ kᵢ nᵢnᵢᵀ), without friction. Up to 1000 degrees of freedom all are
            meant, beyond those up to the largest frequency asked for, or as many as ratios.
        contacts: :class:`Contact` each.
        mu: coefficient of friction of the contacts that have none of their own, 0.5 by default;
            with a table a factor of it, 1 by default.
        belt_speed: V, m/s, 2 by default; its sign is the direction. With a rotation it is Ω, rad/s,
            that of the rotation by default, and ``speed`` of a contact is its radius in m.
        friction_law, mu_static, friction_speed: as in ``Parameters``; speeds of a table are in m/s,
            whatever ``friction_speed`` is.
        load: f, (n,), N; None: −Σ nᵢ preloadᵢ, which balances the preloads at rest; 0: none.
        mesh: nodes, facets and what each degree of freedom is, for names and pictures.
        names: of the degrees of freedom, ``"12.1"`` (node.direction) each, which contacts may then
            use in place of numbers; None: those of the mesh.
        rotation: of the body that rubs, about an axis.
        speed_terms: parts of damping and stiffness that change with speed, gyroscopic and
            centrifugal ones: ``{"damping": [(matrix, power), …], "stiffness": [(matrix, power),
            …]}`` adds each matrix times (Ω/Ω₀)^power, where Ω is ``belt_speed`` and Ω₀ that of the
            rotation, or without one the structure's ``belt_speed``; powers are whole numbers.

    Raises:
        ValueError: matrices that do not fit each other, a mass that is not positive definite,
            numbers that are not finite or not real, or a contact whose directions are parallel.
    """

    def __init__(
        self,
        mass: Any,
        stiffness: Any,
        damping: Any = None,
        *,
        modal_damping: float | Sequence[float] = 0.0,
        contacts: Sequence[Contact] = (),
        mu: float | None = None,
        belt_speed: float | None = None,
        friction_law: Any = "coulomb",
        mu_static: float | None = None,
        friction_speed: float = 1.0,
        load: Any = None,
        mesh: StructureMesh | None = None,
        rotation: Rotation | None = None,
        names: Sequence[str] | None = None,
        speed_terms: Any = None,
    ) -> None:
        self.mesh = _fitting_mesh(mesh)
        """Nodes, facets and degrees of freedom; of a reduced structure those of the whole."""
        if names is None and self.mesh is not None:
            names = self.mesh.names
        self.names = _distinct(names)
        """Names ``node.direction`` of the degrees of freedom; None where they have none."""
        mass, stiffness, damping = (
            numbers_in_si(name, matrix, units)
            for name, matrix, units in (
                ("mass", mass, "kg"),
                ("stiffness", stiffness, "N m-1"),
                ("damping", damping, "N s m-1"),
            )
        )
        self.mass = checked_mass(real_square("mass", mass), self.names)
        self.size = int(self.mass.shape[0])
        """Degrees of freedom n."""
        self._refuse_other_sizes()
        self.given_stiffness = real_square("stiffness", stiffness, self.size)
        """K without speed terms."""
        if (self.given_stiffness.diagonal() < 0).all():
            raise ValueError(
                f"stiffness is negative at all {self.size} degrees of freedom: change its sign"
            )
        nothing = sp.csr_array((self.size, self.size))
        self.given_damping = (
            nothing if damping is None else real_square("damping", damping, self.size)
        )
        """C without speed terms."""
        self.modal_damping = _ratios(modal_damping, self.size)
        if rotation is not None and not isinstance(rotation, Rotation):
            raise ValueError(f"rotation = {brief(rotation)}: a Rotation is needed")
        self.rotation = rotation
        """Rotation of the body that rubs; None where a belt runs straight on."""
        if belt_speed is None:
            belt_speed = 2.0 if rotation is None else rotation.speed
        unit = "m s-1" if rotation is None else "rad s-1"
        self.belt_speed = finite_number("belt_speed", belt_speed, unit)
        reference = self.belt_speed if rotation is None else rotation.speed
        self.speed_terms = SpeedTerms.of(speed_terms, self.size, reference)
        """Parts of damping and stiffness that change with speed."""
        self.assemble()
        self.take_contacts(
            contacts,
            friction_law=friction_law,
            mu=mu,
            mu_static=mu_static,
            friction_speed=friction_speed,
            load=load,
        )
        self.modes: np.ndarray | None = None
        """Modes of a reduced structure, (n of the whole, n): amplitudes → displacements."""
        self.record: dict[str, Any] = {}
        """Record of a reduced structure: how many modes were kept, and their errors."""
        self.reduced_from: ReducedFrom | None = None
        """Origin of a reduced structure."""

    def take_contacts(
        self,
        contacts: Sequence[Contact],
        *,
        friction_law: Any,
        mu: float | None,
        mu_static: float | None,
        friction_speed: float,
        load: Any,
    ) -> None:
        """Check and keep contacts, friction and load.

        Directions of contacts are those of before where they stay: to check them takes as long as
        everything else.
        """
        before = getattr(self, "contacts", None)
        for name in ("preloads", "stiffnesses", "with_tables"):
            vars(self).pop(name, None)  # of the contacts of before
        if not isinstance(contacts, Sequence):
            raise ValueError(  # noqa: TRY004 (of all arguments mistakes are values)
                f"contacts = {brief(contacts)}: a list of Contact is needed"
            )
        self.contacts = tuple(contacts)
        for contact in self.contacts:
            if not isinstance(contact, Contact):
                raise ValueError(f"contacts: {brief(contact)} is no Contact")  # noqa: TRY004
        self.contacts = tuple(by_rows(contact, self.names) for contact in self.contacts)
        if before is None or not same_directions(before, self.contacts):
            self.normals, self.tangentials = directions(self.contacts, self.size)
            self.transversals = transversals(
                self.contacts, self.normals, self.tangentials
            )
        self.friction = Friction(
            friction_law=friction_law,
            mu=default_mu(friction_law) if mu is None else finite_number("mu", mu, "1"),
            mu_static=(
                None
                if mu_static is None
                else finite_number("mu_static", mu_static, "1")
            ),
            friction_speed=finite_number("friction_speed", friction_speed, "m s-1"),
        )
        self.frictions = tuple(
            friction_of(contact, self.friction) for contact in self.contacts
        )
        """Friction of each contact: its own law and coefficients, or the structure's."""
        self.given_load = numbers_in_si("load", load, "N")
        self.load = self._load(self.given_load)

    def _refuse_other_sizes(self) -> None:
        """Raise if mesh or names are of another number of degrees of freedom."""
        for key, given in (
            ("mesh", None if self.mesh is None else self.mesh.degree_of_freedom),
            ("names", self.names),
        ):
            if given is not None and len(given) != self.size:
                raise ValueError(
                    f"{key}: {len(given)} degrees of freedom are named, but the matrices have "
                    f"{self.size}"
                )

    @property
    def mu(self) -> float:
        """Coefficient of friction of the contacts that have none of their own."""
        return self.friction.mu

    @property
    def has_own_mu(self) -> np.ndarray:
        """Mask of the contacts whose coefficient is not the structure's, (contacts,)."""
        return np.array([has_own_mu(contact) for contact in self.contacts], bool)

    @property
    def mu_of_contacts(self) -> np.ndarray:
        """Coefficient of each contact, its own or the structure's, (contacts,)."""
        return np.array([friction.mu for friction in self.frictions])

    def with_common_mu(self) -> Self:
        """Return the structure with the ``mu`` of its contacts as its own, where all have one.

        Contacts of a single face all have the same, and so the structure's can be varied. Where
        they differ, or have laws or limits of stick of their own, it is itself.
        """
        own = {contact.mu for contact in self.contacts}
        has_law = any(
            contact.friction_law is not None or contact.mu_static is not None
            for contact in self.contacts
        )
        if len(own) != 1 or None in own or has_law or self.mu_static is not None:
            return self
        contacts = [dataclasses.replace(contact, mu=None) for contact in self.contacts]
        other = self.with_(contacts=contacts, mu=own.pop())
        if self.reduced_from is not None:
            origin = self.reduced_from
            other.modes, other.mesh = self.modes, self.mesh
            other.record = self.record
            other.reduced_from = origin._replace(whole=origin.whole.with_common_mu())
        return other

    @property
    def mu_static(self) -> float | None:
        """Limit of stick of the contacts that have the structure's friction."""
        return self.friction.mu_static

    @property
    def largest_mu(self) -> float:
        """The largest structure's ``mu`` that limits of stick allow; infinite without any."""
        own = self.has_own_mu
        free = [
            friction
            for friction, is_own in zip(self.frictions, own, strict=True)
            if not is_own
        ]
        return min((each.largest_mu for each in [self.friction, *free]), default=np.inf)

    @cached_property
    def preloads(self) -> np.ndarray:
        """Preload of each contact, N."""
        return _fixed([contact.preload for contact in self.contacts])

    @cached_property
    def stiffnesses(self) -> np.ndarray:
        """Stiffness of each contact at its preload, N/m."""
        return _fixed([contact.stiffness_at_preload for contact in self.contacts])

    @cached_property
    def with_tables(self) -> list[int]:
        """Numbers of the contacts whose force is a table of several pieces."""
        return [i for i, contact in enumerate(self.contacts) if len(contact.lines) > 1]

    def pressing(self, nearing: np.ndarray) -> np.ndarray:
        """Return the normal force of each contact as if it could pull, N.

        Args:
            nearing: nᵀq, (…, contacts), m.
        """
        force = self.preloads - self.stiffnesses * nearing
        for i in self.with_tables:
            force[..., i] = self.contacts[i].force(-nearing[..., i])
        return np.asarray(force)

    @property
    def tangential_stiffnesses(self) -> np.ndarray:
        """Stiffness of each contact's spring in series with friction, N/m; 0 without one."""
        springs = [contact.tangential_stiffness or 0.0 for contact in self.contacts]
        return np.array(springs)

    @property
    def speeds(self) -> np.ndarray:
        """Belt speed at each contact over ``belt_speed``."""
        return np.array([contact.speed for contact in self.contacts])

    @property
    def speed_unit(self) -> str:
        """CF unit of ``belt_speed``."""
        return "m s-1" if self.rotation is None else "rad s-1"

    def assemble(self) -> None:
        """Add the speed terms at the belt's speed to the matrices."""
        terms, speed = self.speed_terms, self.belt_speed
        self.stiffness: Any = self.given_stiffness
        self.damping: Any = self.given_damping
        if terms.stiffness:
            whole = self.given_stiffness + terms.at("stiffness", speed)
            self.stiffness = sp.csr_array(whole)
        if terms.damping:
            whole = self.given_damping + terms.at("damping", speed)
            self.damping = sp.csr_array(whole)

    def at_speed(self, belt_speed: float) -> Self:
        """Return the structure with the matrices of a speed; itself if they do not change with it.

        Raises:
            ValueError: a speed of 0 where a term has a negative power.
        """
        if not self.speed_terms.vary or belt_speed == self.belt_speed:
            return self
        other = copy.copy(self)
        other.belt_speed = float(belt_speed)
        other.assemble()
        return other

    @property
    def stiffness_at_rest(self) -> sp.csr_array:
        """K + Σ kᵢ nᵢnᵢᵀ without what changes with speed, the symmetric part."""
        springs = sum_of_products(self.normals * self.stiffnesses, self.normals)
        whole = self.given_stiffness + springs + self.speed_terms.still("stiffness")
        return sparse_rows(0.5 * (whole + whole.T))

    def _load(self, load: Any) -> np.ndarray:
        if load is None:
            return (
                -self.normals @ self.preloads if self.contacts else np.zeros(self.size)
            )
        vector = real_array("load", load)
        if vector.ndim == 0 and vector == 0:
            return np.zeros(self.size)
        if vector.shape != (self.size,):
            raise ValueError(
                f"load has shape {vector.shape}: {self.size} finite numbers are needed, or 0"
            )
        return vector

    def __repr__(self) -> str:
        names = ", ".join(contact.name for contact in self.contacts) or "none"
        return (
            f"Structure({self.size} degrees of freedom; contacts {names}; mu = {self.mu:g}, "
            f"belt_speed = {self.belt_speed:g})"
        )

    def with_(self, **changes: Any) -> Self:
        """Return the structure with other arguments.

        A reduced structure keeps its origin if only friction or the belt changes; with other
        matrices, contacts or loads it has none.
        """
        # these mean the same for a structure and for a reduced one; others belong to the matrices
        of_sliding = {"mu", "belt_speed", "friction_law", "mu_static", "friction_speed"}
        if set(changes) <= of_sliding | {"contacts", "load", "modal_damping"}:
            other = self._with_same_matrices(changes)
        else:
            other = type(self)(**{**self.arguments, **changes})
        if self.reduced_from is not None and set(changes) <= of_sliding:
            origin = self.reduced_from
            other.modes, other.mesh = self.modes, self.mesh
            other.reduced_from = origin._replace(
                whole=origin.whole.with_(**changes), truth=None
            )
        return other

    def _with_same_matrices(self, changes: Mapping[str, Any]) -> Self:
        """Return the structure with other contacts, friction or damping of modes.

        Its matrices have been checked: doing so again takes most of the time in which a parameter
        is varied.
        """
        other = copy.copy(self)
        if self.modes is not None:  # mesh and names are those of the whole
            other.mesh = other.names = None
        given = {**self.arguments, **changes}
        other.modal_damping = _ratios(given["modal_damping"], self.size)
        if "belt_speed" in changes:
            other.belt_speed = finite_number(
                "belt_speed", given["belt_speed"], self.speed_unit
            )
            other.assemble()
        of_contacts = ("friction_law", "mu", "mu_static", "friction_speed", "load")
        other.take_contacts(
            given["contacts"], **{name: given[name] for name in of_contacts}
        )
        other.modes, other.record, other.reduced_from = None, {}, None
        return other

    @property
    def arguments(self) -> dict[str, Any]:
        """Return the arguments that make this structure, by name."""
        friction = self.friction
        return {
            "mass": self.mass,
            "stiffness": self.given_stiffness,
            "damping": self.given_damping,
            "modal_damping": self.modal_damping,
            "contacts": self.contacts,
            "mu": friction.mu,
            "belt_speed": self.belt_speed,
            "friction_law": friction.friction_law,
            "mu_static": friction.mu_static,
            "friction_speed": friction.friction_speed,
            "load": self.given_load,
            "mesh": self.mesh if self.modes is None else None,
            "rotation": self.rotation,
            "names": self.names if self.modes is None else None,
            "speed_terms": self.speed_terms,
        }

    def as_dict(self) -> dict[str, Any]:
        """Numbers and names as JSON takes them; of the matrices and directions a hash."""
        content = hashlib.sha256()
        for matrix in (self.mass, self.given_damping, self.given_stiffness):
            for part in (matrix.indptr, matrix.indices, matrix.data):
                content.update(np.ascontiguousarray(part).tobytes())
        for array in (self.normals, self.tangentials, self.load, self.transversals):
            content.update(np.ascontiguousarray(array).tobytes())
        contacts = {
            contact.name: {
                "stiffness": contact.stiffness_at_preload,
                "preload": contact.preload,
                "speed": contact.speed,
            }
            | ({} if contact.origin is None else contact.origin.as_dict())
            | {
                key: getattr(contact, key)
                for key in (
                    *("mu", "friction_law", "mu_static", "law"),
                    "tangential_stiffness",
                )
                if getattr(contact, key) is not None
            }
            for contact in self.contacts
        }
        return {
            "degrees_of_freedom": self.size,
            "matrices": content.hexdigest()[:16],
            "modal_damping": self.modal_damping.tolist(),
            "contacts": contacts,
            "mu": self.mu,
            "belt_speed": self.belt_speed,
            "friction_law": self.friction.friction_law,
            "mu_static": self.friction.mu_static,
            "friction_speed": self.friction.friction_speed,
            **({} if self.rotation is None else {"rotation": self.rotation.as_dict()}),
            **({"speed_terms": self.speed_terms.as_list()} if self.speed_terms else {}),
        }


def _fixed(values: Sequence[Any]) -> np.ndarray:
    """Return an array that cannot be changed."""
    array = np.array(values, float)
    array.setflags(write=False)
    return array


def _fitting_mesh(mesh: StructureMesh | None) -> StructureMesh | None:
    if mesh is not None and not isinstance(mesh, StructureMesh):
        raise ValueError(f"mesh = {brief(mesh)}: a StructureMesh is needed")
    return mesh


def _distinct(names: Sequence[str] | None) -> tuple[str, ...] | None:
    """Return names of degrees of freedom, each of which is there once."""
    if names is None:
        return None
    if not isinstance(names, list | tuple) or not all(
        isinstance(name, str) for name in names
    ):
        raise ValueError(
            f"names = {brief(names)}: a list of names like '12.1' is needed"
        )
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"names: {twice!r} is there twice; each row needs its own")
    return tuple(names)


def _ratios(given: Any, size: int) -> np.ndarray:
    """Damping ratios, one number or one for each of the lowest modes."""
    several = numbers_in_si("modal_damping", given, "1")
    several = several.tolist() if isinstance(several, np.ndarray) else several
    if isinstance(several, Sequence) and not isinstance(several, str):
        ratios = np.array([finite_number("modal_damping", one, "1") for one in several])
    else:
        ratios = np.array(finite_number("modal_damping", several, "1"))
    if ratios.size > size or not (ratios >= 0).all():
        raise ValueError(
            f"modal_damping = {brief(given)}: a ratio of 0 or greater is needed, or at most {size} "
            "of them"
        )
    return ratios
