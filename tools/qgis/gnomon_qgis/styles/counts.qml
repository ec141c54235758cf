<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis styleCategories="Symbology" version="3.22">
  <pipe>
    <provider><resampling enabled="false"/></provider>
    <rasterrenderer type="singlebandpseudocolor" band="1" opacity="0.8" alphaBand="-1" classificationMin="0" classificationMax="16">
      <rastershader>
        <colorrampshader colorRampType="INTERPOLATED" classificationMode="1" clip="0" minimumValue="0" maximumValue="16">
            <item value="0" color="#404040" label="0" alpha="60"/>
            <item value="1" color="#ffffb2" label="1" alpha="255"/>
            <item value="2" color="#fecc5c" label="2" alpha="255"/>
            <item value="4" color="#fd8d3c" label="4" alpha="255"/>
            <item value="8" color="#f03b20" label="8" alpha="255"/>
            <item value="16" color="#bd0026" label="16 and more" alpha="255"/>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast brightness="0" contrast="0" gamma="1"/>
    <huesaturation saturation="0"/>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
