<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis styleCategories="Symbology" version="3.22">
  <pipe>
    <provider><resampling enabled="false"/></provider>
    <rasterrenderer type="singlebandpseudocolor" band="1" opacity="0.8" alphaBand="-1" classificationMin="0" classificationMax="2000">
      <rastershader>
        <colorrampshader colorRampType="INTERPOLATED" classificationMode="1" clip="0" minimumValue="0" maximumValue="2000">
            <item value="0" color="#000004" label="0 kWh/m2" alpha="255"/>
            <item value="500" color="#781c6d" label="500 kWh/m2" alpha="255"/>
            <item value="1000" color="#ed6925" label="1000 kWh/m2" alpha="255"/>
            <item value="1500" color="#fcb519" label="1500 kWh/m2" alpha="255"/>
            <item value="2000" color="#fcffa4" label="2000 kWh/m2" alpha="255"/>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast brightness="0" contrast="0" gamma="1"/>
    <huesaturation saturation="0"/>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
