"""The problem as the user gives it: body, conditions, loads, contact zones, tools; frozen and checked."""

from bemcontact.problem.boundary import Boundary
from bemcontact.problem.conditions import AxisFields, Centrifugal, Condition, Field, Gravity, Loads, Temperature
from bemcontact.problem.contact_zone import ContactZone, RigidTool, ToolAction, ToolDisplacement, ToolForce
from bemcontact.problem.curves import Edge
from bemcontact.problem.geometry import Arc, EllipseArc, Grading, Line
from bemcontact.problem.load_case import LoadCase
from bemcontact.problem.problem import Material, MeshDensity, Problem, Units, Variant
from bemcontact.problem.reference import (
    Crack,
    FlatPunch,
    Hertz,
    ProppedBeam,
    Reference,
    ShrinkFit,
    Table,
    Uniform,
    Values,
)
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
