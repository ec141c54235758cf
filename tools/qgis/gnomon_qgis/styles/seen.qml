<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis styleCategories="Symbology" version="3.22">
  <pipe>
    <provider><resampling enabled="false"/></provider>
    <rasterrenderer type="paletted" band="1" opacity="0.6" alphaBand="-1">
      <colorPalette>
        <paletteEntry value="255" color="#1a9641" label="seen" alpha="255"/>
        <paletteEntry value="127" color="#fdae61" label="undecided" alpha="255"/>
        <paletteEntry value="0" color="#404040" label="hidden" alpha="120"/>
      </colorPalette>
    </rasterrenderer>
    <brightnesscontrast brightness="0" contrast="0" gamma="1"/>
    <huesaturation saturation="0"/>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
