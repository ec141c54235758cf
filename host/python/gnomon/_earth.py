# SPDX-License-Identifier: MIT
"""The Earth as a sphere."""

#: Its mean radius in metres.
EARTH_RADIUS = 6_371_000.0


def per_square_of(refraction: float, radius: float = EARTH_RADIUS) -> float:
    """The depth of the ground below a plane that touches it, over the squared distance (1/m): its curvature, less the
    part k = `refraction` of it that rays along the ground follow."""
    return (1 - refraction) / (2 * radius)
