# SPDX-License-Identifier: MIT
"""The part of check_in_qgis.sh inside QGIS's Python. usage: check_in_qgis.py FOLDER"""

import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
from osgeo import gdal, osr
from qgis.core import (
    QgsApplication,
    QgsCoordinateReferenceSystem,
    QgsFeature,
    QgsGeometry,
    QgsMapRendererParallelJob,
    QgsMapSettings,
    QgsPointXY,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingOutputLayerDefinition,
    QgsProject,
    QgsRasterLayer,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QSize

folder = Path(sys.argv[1])
sys.path[:0] = ["/usr/share/qgis/python/plugins", str(folder / "profile/profiles/default/python/plugins")]
application = QgsApplication([], False)
application.initQgis()

import processing  # noqa: E402  # QGIS must be there
from gnomon_qgis import classFactory  # noqa: E402
from processing.core.Processing import Processing  # noqa: E402

Processing.initialize()
plugin = classFactory(None)
plugin.initProcessing()


def write_dem(path):
    r, c = np.mgrid[0:240, 0:320]
    heights = 400 + 30 * np.sin(r / 23) * np.cos(c / 31) + 12 * np.sin((r + 2 * c) / 17)
    file = gdal.GetDriverByName("GTiff").Create(str(path), 320, 240, 1, gdal.GDT_Float32)
    crs = osr.SpatialReference()
    crs.ImportFromEPSG(25832)
    file.SetProjection(crs.ExportToWkt())
    file.SetGeoTransform((691_000, 10, 0, 5_335_000, 0, -10))
    file.GetRasterBand(1).WriteArray(heights.astype("float32"))


def write_epw(path, latitude):
    """A year of clear hours from 8 to 16 o'clock."""
    head = f"LOCATION,Made,-,-,-,1,{latitude},11.58,1,500\n" + "COMMENTS\n" * 7
    months = (31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)
    rows = [
        f"2026,{month},{day},{hour},0,?" + ",9" * 7 + (",0,0,0" if not 8 < hour <= 16 else ",450,500,100") + ",0" * 19
        for month, days in enumerate(months, 1)
        for day in range(1, days + 1)
        for hour in range(1, 25)
    ]
    path.write_text(head + "\n".join(rows) + "\n")


def points_of(*places):
    layer = QgsVectorLayer("Point?crs=EPSG:25832", "observers", "memory")
    for x, y in places:
        feature = QgsFeature()
        feature.setGeometry(QgsGeometry.fromPointXY(QgsPointXY(x, y)))
        layer.dataProvider().addFeature(feature)
    return layer


class Heard(QgsProcessingFeedback):
    def __init__(self):
        super().__init__(False)
        self.progress = []
        self.progressChanged.connect(self.progress.append)


def read(path, band=1):
    file = gdal.Open(str(path))  # its bands live as long as it does
    return file.GetRasterBand(band).ReadAsArray()


def fails(text, name, **parameters):
    """A run that must fail, and say this."""
    try:
        processing.run(name, {"HEIGHTS": str(dem), "OUTPUT": str(folder / "x.tif"), **parameters})
    except QgsProcessingException as error:
        assert text in str(error), error
        print("refused:", str(error).splitlines()[0][:100])
    else:
        raise AssertionError(f"{name} did not fail: {text}")


def draw(path, style, picture):
    layer = QgsRasterLayer(str(path), picture.stem)
    layer.loadNamedStyle(str(folder / "profile/profiles/default/python/plugins/gnomon_qgis/styles" / style))
    settings = QgsMapSettings()
    settings.setLayers([layer])
    settings.setDestinationCrs(QgsCoordinateReferenceSystem("EPSG:25832"))
    settings.setExtent(layer.extent())
    settings.setOutputSize(QSize(480, 360))
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    image = job.renderedImage()
    colours = {image.pixelColor(x, y).name() for x in range(0, 480, 7) for y in range(0, 360, 7)}
    assert len(colours) >= 2, f"{style} draws one colour"
    image.save(str(picture))


dem = folder / "dem.tif"
write_dem(dem)
observers = points_of((691_915, 5_333_815))
seen = folder / "seen.tif"
context = QgsProcessingContext()
context.setProject(QgsProject.instance())
processing.run("gnomon:viewshed", {"HEIGHTS": str(dem), "OBSERVERS": observers, "OUTPUT": str(seen)}, context=context)
loaded, heard = folder / "loaded.tif", QgsProcessingFeedback(False)
wanted = QgsProcessingOutputLayerDefinition(str(loaded), QgsProject.instance())
processing.run("gnomon:viewshed", {"HEIGHTS": str(dem), "OBSERVERS": observers, "OUTPUT": wanted}, context=context)
((source, details),) = context.layersToLoadOnCompletion().items()
layer = QgsRasterLayer(source)
details.postProcessor().postProcessLayer(layer, context, heard)
assert source == str(loaded) and layer.renderer().type() == "paletted"
own = folder / "own.tif"
subprocess.run(
    [os.environ["GNOMON_STUDY"], "viewshed", str(dem), "691915,5333815", str(own), "--quiet"], check=True
)
assert (read(seen) == read(own)).all() and {*np.unique(read(seen))} == {0, 255}
print("viewshed:", f"{(read(seen) == 255).mean():.1%} seen, the same bytes as gnomon-study's own")

in_degrees = QgsVectorLayer("Point?crs=EPSG:4326", "observers", "memory")
for lon, lat in ((11.5836, 48.1285), (11.6000, 48.1300)):
    feature = QgsFeature()
    feature.setGeometry(QgsGeometry.fromPointXY(QgsPointXY(lon, lat)))
    in_degrees.dataProvider().addFeature(feature)
counts = folder / "counts.tif"
processing.run(
    "gnomon:viewshed",
    {"HEIGHTS": str(dem), "OBSERVERS": in_degrees, "DISTANCE": 1500, "REFRACTION": 0.13, "OUTPUT": str(counts)},
)
assert {*np.unique(read(counts))} == {0, 1, 2}
print("viewshed of two observers in degrees: counts", np.bincount(read(counts).ravel()).tolist())

hours, heard = folder / "hours.tif", Heard()
day = {"START": "2026-12-21T00:00:00", "END": "2026-12-22T00:00:00", "UTC_OFFSET": 1, "STEP": 60}
processing.run("gnomon:sunhours", {"HEIGHTS": str(dem), **day, "OUTPUT": str(hours)}, feedback=heard)
assert 3 < read(hours).mean() < 9 and heard.progress and max(heard.progress) == 100
print("sunhours:", f"{read(hours).mean():.2f} hours on average; progress {sorted(set(heard.progress))[-3:]}")

weather, far = folder / "made.epw", folder / "far.epw"
write_epw(weather, 48.13)
write_epw(far, -48.13)
energy = {name: folder / f"{name}.tif" for name in ("irradiation", "direct", "diffuse")}
heard = Heard()
for result, path in enumerate(energy.values()):
    asked = {"HEIGHTS": str(dem), "WEATHER": str(weather), "RESULT": result, "OUTPUT": str(path)}
    processing.run("gnomon:irradiation", asked, feedback=heard)
total, direct, diffuse = (read(path) for path in energy.values())
assert np.abs(total - direct - diffuse).max() < 1e-3 and (direct > diffuse).all() and max(heard.progress) == 100
beams = 365 * 8 * 0.5  # kWh/m2 at right angles; the sky's horizontal hours have a fifth of them
assert 0.3 * beams < direct.mean() < 0.7 * beams
assert 0.7 * beams / 5 < diffuse.mean() < 1.2 * beams / 5
print("irradiation:", f"{total.mean():.0f} kWh/m2 on average, {diffuse.mean():.0f} of them diffuse")

fails("more than 50 km", "gnomon:irradiation", WEATHER=str(far))
fails("cannot be read as", "gnomon:irradiation", WEATHER=str(dem))
fails("does not stand on the raster", "gnomon:viewshed", OBSERVERS=points_of((0, 0)))
fails("no points", "gnomon:viewshed", OBSERVERS=points_of())
two = points_of((691_915, 5_333_815), (691_955, 5_333_815))
fails("is for one observer", "gnomon:viewshed", OBSERVERS=two, RESULT=2)
program = os.environ["GNOMON_STUDY"]
os.environ["GNOMON_STUDY"] = "/nowhere/gnomon-study"
fails("Install gnomon", "gnomon:viewshed", OBSERVERS=observers)
os.environ["GNOMON_STUDY"] = program

cancelled = Heard()
threading.Timer(1.0, cancelled.cancel).start()
many = points_of(*((691_105 + 10 * i, 5_333_815) for i in range(300)))
try:
    processing.run(
        "gnomon:viewshed", {"HEIGHTS": str(dem), "OBSERVERS": many, "OUTPUT": str(folder / "x.tif")}, feedback=cancelled
    )
except QgsProcessingException as error:
    assert "cancelled" in str(error), error
    assert not (folder / "x.tif").exists()
    print("cancelled: the program ended, no file is left")
else:
    raise AssertionError("the run was not cancelled")

draw(seen, "seen.qml", folder / "seen.png")
draw(counts, "counts.qml", folder / "counts.png")
draw(hours, "sun_hours.qml", folder / "hours.png")
draw(energy["irradiation"], "irradiation.qml", folder / "irradiation.png")
print("all is well; look at seen.png, counts.png, hours.png, irradiation.png")
sys.stdout.flush()
os._exit(0)  # QGIS 3.22 crashes when Python takes its objects down
