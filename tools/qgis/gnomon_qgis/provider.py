# SPDX-License-Identifier: MIT
"""The provider, and its setting: the program gnomon-study."""

from processing.core.ProcessingConfig import ProcessingConfig, Setting
from qgis.core import QgsApplication, QgsProcessingProvider

from .algorithms import Irradiation, SunHours, Viewshed

PROGRAM = "GNOMON_STUDY"


class GnomonProvider(QgsProcessingProvider):
    def id(self):
        return "gnomon"

    def name(self):
        return "gnomon"

    def load(self):
        ProcessingConfig.settingIcons[self.name()] = self.icon()
        text = "The program gnomon-study (of the environment in which gnomon is installed)"
        ProcessingConfig.addSetting(Setting(self.name(), PROGRAM, text, "gnomon-study", valuetype=Setting.FILE))
        ProcessingConfig.readSettings()
        self.refreshAlgorithms()
        return True

    def unload(self):
        ProcessingConfig.removeSetting(PROGRAM)

    def loadAlgorithms(self):  # noqa: N802
        for algorithm in (Viewshed, SunHours, Irradiation):
            self.addAlgorithm(algorithm())


class GnomonPlugin:
    def initProcessing(self):  # noqa: N802  # qgis_process calls it
        self.provider = GnomonProvider()
        QgsApplication.processingRegistry().addProvider(self.provider)

    def initGui(self):  # noqa: N802
        self.initProcessing()

    def unload(self):
        QgsApplication.processingRegistry().removeProvider(self.provider)
