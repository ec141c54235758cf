# SPDX-License-Identifier: MIT
"""Exact hard shadows and sun visibility on any OpenCL device.

For any set of points gnomon says whether a light reaches them past a mesh of triangles, with the answer that ray
tracing would give in exact arithmetic: the same bits on every device.

    scene = gnomon.Scene(vertices, faces)
    lit = scene.lit(points, direction=(0.1, 0, -1))     # bool, one per point

Coordinates may be in any unit. float32 values are taken as they are, float64 values are snapped once to a lattice
(Scene.lattice). See Scene.lit() for the contract.

Every call that returns numpy arrays has waited for the device. A call with pyopencl arrays works on their queue, and
waits for it, too (the table of waits in gnomon.hpp: Technique::run).
"""

from . import _gnomon
from ._cut_outs import CutOut, CutOutCounts, CutOuts
from ._devices import Device, devices, use
from ._earth import EARTH_RADIUS
from ._gnomon import (
    Cancelled,
    DeviceDescription,
    DeviceNotFoundError,
    OpenCLError,
    SettingDescription,
    TechniqueDescription,
    techniques,
)
from ._lattice import Lattice
from ._lights import Lights, LightsResult
from ._page import Page, view
from ._scene import AtVertices, Scene, View
from ._side import Side, Technique, VertexSide
from ._study import study
from ._viewshed import REFRACTION, Viewshed, ViewshedGrid, viewshed
from ._visible_from import VisibleFrom

__version__: str = _gnomon.__version__  # type: ignore[attr-defined]  # nanobind's stub leaves it out

__all__ = [
    "AtVertices",
    "Cancelled",
    "CutOut",
    "CutOutCounts",
    "CutOuts",
    "Device",
    "DeviceDescription",
    "DeviceNotFoundError",
    "EARTH_RADIUS",
    "Lattice",
    "Lights",
    "LightsResult",
    "OpenCLError",
    "Page",
    "REFRACTION",
    "Scene",
    "SettingDescription",
    "Side",
    "Technique",
    "TechniqueDescription",
    "VertexSide",
    "View",
    "Viewshed",
    "ViewshedGrid",
    "VisibleFrom",
    "__version__",
    "devices",
    "study",
    "techniques",
    "use",
    "view",
    "viewshed",
]
