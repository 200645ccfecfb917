"""What is asked: the body, what acts on it, and the rigid surfaces that it may touch; frozen, checked, no numerics."""

from bemcontact.problem.boundary import Boundary
from bemcontact.problem.closed_form import Crack, FlatPunch, Hertz, ProppedBeam, ShrinkFit, Uniform
from bemcontact.problem.conditions import AxisFields, Condition, Field
from bemcontact.problem.contact_zone import ContactZone
from bemcontact.problem.curves import Edge
from bemcontact.problem.geometry import Arc, EllipseArc, Grading, Line
from bemcontact.problem.load_case import LoadCase
from bemcontact.problem.loads import Centrifugal, Gravity, Loads, Temperature
from bemcontact.problem.material import Material
from bemcontact.problem.problem import MeshDensity, Problem, Units
from bemcontact.problem.reference import Reference, Table, Values
from bemcontact.problem.rigid_surface import (
    Circle,
    Closest,
    DeflectedContour,
    Plane,
    Polyline,
    RigidSurface,
    Shape,
    Spline,
)
from bemcontact.problem.rigid_tool import RigidTool, ToolAction, ToolDisplacement, ToolForce
from bemcontact.problem.variant import Variant

__all__ = [
    "Arc",
    "AxisFields",
    "Boundary",
    "Centrifugal",
    "Circle",
    "Closest",
    "Condition",
    "ContactZone",
    "Crack",
    "DeflectedContour",
    "Edge",
    "EllipseArc",
    "Field",
    "FlatPunch",
    "Grading",
    "Gravity",
    "Hertz",
    "Line",
    "LoadCase",
    "Loads",
    "Material",
    "MeshDensity",
    "Plane",
    "Polyline",
    "Problem",
    "ProppedBeam",
    "Reference",
    "RigidSurface",
    "RigidTool",
    "Shape",
    "ShrinkFit",
    "Spline",
    "Table",
    "Temperature",
    "ToolAction",
    "ToolDisplacement",
    "ToolForce",
    "Uniform",
    "Units",
    "Values",
    "Variant",
]
