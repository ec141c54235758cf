# SPDX-License-Identifier: MIT
"""The side of a point's surface, which decides facing, and the technique of a call."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

#: The exact technique, which all calls take that name no other.
EXACT = "frustum-traced"


@dataclass(frozen=True, eq=False)
class Side:
    """The side of its surface that a point belongs to: it is dark unless the light is strictly on that side, decided
    exactly. Without a side a point on the far side of its own surface may be lit. Make it by one of the functions
    below; a call takes one side for all of its points."""

    kind: Literal["none", "eye", "normals", "front"]
    value: Any = None

    @staticmethod
    def none() -> Side:
        """No side: no point is dark for its facing. The default."""
        return Side("none")

    @staticmethod
    def eye(position: Any) -> Side:
        """(3,): the side of the point's receiver that is seen from there. Needs receivers=."""
        return Side("eye", position)

    @staticmethod
    def normals(normals: Any) -> Side:
        """(..., 3), one per point, of any length: the normal's side."""
        return Side("normals", normals)

    @staticmethod
    def front() -> Side:
        """The side of the point's receiver from which its corners run counter-clockwise. Needs receivers=."""
        return Side("front")

    @staticmethod
    def vertices(up: Any = None) -> VertexSide:
        """Each point is a vertex of the mesh, which no triangle around it shadows. It is dark unless the light is
        strictly in front of these triangles (their corners run counter-clockwise there); where they do not close around
        it, in front of the planes of all of them. On a lattice, a vertex within a step of a triangle that lacks it as a
        corner is lifted off that triangle.

        up: (3,): the mesh is a height field in this direction. A point is dark unless the light is strictly above the
        one or two triangles over which its ray leaves; where it leaves over none, at a border or beside nodata,
        strictly above the planes of all triangles around the point.
        """
        return VertexSide(up)


@dataclass(frozen=True, eq=False)
class VertexSide:
    """What Side.vertices() makes: a call with it returns AtVertices. No Side, so that types tell the two apart."""

    up: Any = None


@dataclass(frozen=True)
class Technique:
    """A technique of gnomon.techniques() with settings of its own, by name."""

    name: str = EXACT
    settings: Mapping[str, object] = field(default_factory=dict)
