# SPDX-License-Identifier: MIT
"""The algorithms: viewsheds, and hours of sun."""

import json
import tempfile
from pathlib import Path

from qgis.core import (
    QgsCoordinateTransform,
    QgsProcessing,
    QgsProcessingAlgorithm,
    QgsProcessingException,
    QgsProcessingLayerPostProcessorInterface,
    QgsProcessingParameterDateTime,
    QgsProcessingParameterDistance,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterRasterLayer,
)

from . import study_process

STYLES = Path(__file__).parent / "styles"


class _Styled(QgsProcessingLayerPostProcessorInterface):
    """Gives a result the style of a file when QGIS loads it."""

    made = []  # QGIS does not keep them

    @staticmethod
    def of(style):
        one = _Styled()
        one.style = str(STYLES / style)
        _Styled.made[:] = [*_Styled.made[-15:], one]
        return one

    def postProcessLayer(self, layer, context, feedback):  # noqa: N802
        layer.loadNamedStyle(self.style)
        layer.triggerRepaint()


class _Algorithm(QgsProcessingAlgorithm):
    HEIGHTS, OUTPUT = "HEIGHTS", "OUTPUT"

    def createInstance(self):  # noqa: N802
        return type(self)()

    def group(self):
        return ""

    def groupId(self):  # noqa: N802
        return ""

    def _add(self, parameter, text=None):
        if text:
            parameter.setHelp(text)
        self.addParameter(parameter)

    def _add_heights(self):
        self._add(
            QgsProcessingParameterRasterLayer(self.HEIGHTS, "Heights"),
            "A DEM or DSM in a file, north up, on a map in metres (a UTM zone, a national grid).",
        )

    def _file_of_heights(self, parameters, context):
        layer = self.parameterAsRasterLayer(parameters, self.HEIGHTS, context)
        file = layer.source() if layer is not None else ""
        if not Path(file).exists():
            raise QgsProcessingException(f"Heights: {file or 'the layer'} is no file: export it as GeoTIFF first")
        return layer, file

    def _style(self, context, output, style):
        if context.willLoadLayerOnCompletion(output):
            context.layerToLoadOnCompletionDetails(output).setPostProcessor(_Styled.of(style))


class Viewshed(_Algorithm):
    OBSERVERS, HEIGHT, TARGET, DISTANCE, RESULT = "OBSERVERS", "HEIGHT", "TARGET_HEIGHT", "DISTANCE", "RESULT"
    REFRACTION = "REFRACTION"
    RESULTS = ("seen", "counts", "heights")

    def name(self):
        return "viewshed"

    def displayName(self):  # noqa: N802
        return "Viewshed (exact)"

    def shortHelpString(self):  # noqa: N802
        return (
            "Which cells of a raster of heights observers see. Each line of sight is decided in exact arithmetic.\n\n"
            "One observer gives 255 for cells that are seen and 0 for others; several give the number of observers "
            "that see each cell. The Earth's curvature counts, less refraction."
        )

    def initAlgorithm(self, config=None):  # noqa: N802
        self._add_heights()
        self._add(
            QgsProcessingParameterFeatureSource(self.OBSERVERS, "Observers", [QgsProcessing.TypeVectorPoint]),
            "Points on the raster, in any CRS. Each stands on the ground below it.",
        )
        number = QgsProcessingParameterNumber
        for key, text, default, least, help_text in (
            (self.HEIGHT, "Height of eyes above the ground (m)", 2.0, 0.001, "The same for all observers."),
            (self.TARGET, "Height of targets above the ground (m)", 0.0, 0.0, "0: the ground itself is looked at."),
        ):
            self._add(number(key, text, number.Double, default, minValue=least), help_text)
        self._add(
            QgsProcessingParameterDistance(self.DISTANCE, "Greatest distance", None, self.HEIGHTS, True, 0.0),
            "Cells farther away are not seen. Empty: no limit.",
        )
        self._add(
            number(self.REFRACTION, "Refraction coefficient k", number.Double, 1 / 7, maxValue=0.999),
            "The part of the Earth's curvature that rays along the ground follow.",
        )
        self._add(
            QgsProcessingParameterEnum(
                self.RESULT, "Result",
                ["Seen, or the number of observers", "Number of observers", "Height from which each cell is seen (m)"],
                defaultValue=0,
            ),
            "The last one is for one observer.",
        )
        self._add(QgsProcessingParameterRasterDestination(self.OUTPUT, "Viewshed"))

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        layer, heights = self._file_of_heights(parameters, context)
        places = self._places(parameters, context, layer)
        output = self.parameterAsOutputLayer(parameters, self.OUTPUT, context)
        what = self.RESULTS[self.parameterAsEnum(parameters, self.RESULT, context)]
        if what == "seen" and len(places) > 1:
            what = "counts"
        arguments = ["--what", what]
        for key, option in (
            (self.HEIGHT, "--height"),
            (self.TARGET, "--target-height"),
            (self.DISTANCE, "--distance"),
            (self.REFRACTION, "--refraction"),
        ):
            if parameters.get(key) is not None:
                arguments.append(f"{option}={self.parameterAsDouble(parameters, key, context)!r}")
        with tempfile.TemporaryDirectory(prefix="gnomon-") as folder:
            table = Path(folder) / "observers.csv"
            table.write_text("x,y\n" + "".join(f"{x!r},{y!r}\n" for x, y in places))
            arguments += ["--folder", str(Path(folder) / "study")]
            study_process.run(["viewshed", heights, str(table), output, *arguments], feedback)
        self._style(context, output, f"{what}.qml")
        return {self.OUTPUT: output}

    def _places(self, parameters, context, layer):
        source = self.parameterAsSource(parameters, self.OBSERVERS, context)
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(parameters, self.OBSERVERS))
        to_map = QgsCoordinateTransform(source.sourceCrs(), layer.crs(), context.transformContext())
        places = []
        for feature in source.getFeatures():
            for vertex in feature.geometry().vertices():
                at = to_map.transform(vertex.x(), vertex.y())
                places.append((at.x(), at.y()))
        if not places:
            raise QgsProcessingException("Observers: the layer has no points")
        return places


class SunHours(_Algorithm):
    START, END, STEP, OFFSET = "START", "END", "STEP", "UTC_OFFSET"

    def name(self):
        return "sunhours"

    def displayName(self):  # noqa: N802
        return "Hours of sun (exact shadows)"

    def shortHelpString(self):  # noqa: N802
        return (
            "Hours of sun on each cell of a raster of heights between two moments, with exact shadows. Band 1 is the "
            "sum, band 2 its undecided part. The raster's CRS gives the place on the Earth."
        )

    def initAlgorithm(self, config=None):  # noqa: N802
        self._add_heights()
        moment = QgsProcessingParameterDateTime
        self._add(moment(self.START, "From", moment.DateTime, "2026-06-21T00:00:00"), "Local time.")
        self._add(moment(self.END, "To", moment.DateTime, "2026-06-22T00:00:00"), "Local time.")
        number = QgsProcessingParameterNumber
        self._add(
            number(self.STEP, "Step (minutes)", number.Double, 30.0, minValue=1 / 60),
            "The sun in the middle of each step counts for the whole step.",
        )
        self._add(
            number(self.OFFSET, "Local time less UTC (hours)", number.Double, 0.0, minValue=-14, maxValue=14),
            "1 for Central European Time, 2 in its summer.",
        )
        self._add(QgsProcessingParameterRasterDestination(self.OUTPUT, "Hours of sun"))

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        _, heights = self._file_of_heights(parameters, context)
        output = self.parameterAsOutputLayer(parameters, self.OUTPUT, context)
        moments = (self.parameterAsDateTime(parameters, key, context) for key in (self.START, self.END))
        start, end = (moment.toString("yyyy-MM-ddTHH:mm:ss") for moment in moments)
        with tempfile.TemporaryDirectory(prefix="gnomon-") as folder:
            settings = Path(folder) / "study.toml"
            lines = {
                "raster": heights,
                "start": start,
                "end": end,
                "step": self.parameterAsDouble(parameters, self.STEP, context),
                "utc_offset": self.parameterAsDouble(parameters, self.OFFSET, context),
                "outputs": ["hours"],
            }
            settings.write_text("".join(f"{key} = {json.dumps(value)}\n" for key, value in lines.items()))
            study_process.run(["run", str(settings)], feedback)
            study_process.run(["export", str(settings.with_suffix("")), output, "--what", "sun_hours"], feedback)
        self._style(context, output, "sun_hours.qml")
        return {self.OUTPUT: output}
