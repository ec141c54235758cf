# SPDX-License-Identifier: MIT
"""The QGIS plugin of gnomon: a Processing provider."""


def classFactory(iface):  # noqa: N802  # QGIS calls it by this name
    from .provider import GnomonPlugin

    return GnomonPlugin()
