<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis styleCategories="Symbology" version="3.22">
  <pipe>
    <provider><resampling enabled="false"/></provider>
    <rasterrenderer type="singlebandpseudocolor" band="1" opacity="0.8" alphaBand="-1" classificationMin="0" classificationMax="16">
      <rastershader>
        <colorrampshader colorRampType="INTERPOLATED" classificationMode="1" clip="0" minimumValue="0" maximumValue="16">
            <item value="0" color="#000004" label="0 h" alpha="255"/>
            <item value="4" color="#781c6d" label="4 h" alpha="255"/>
            <item value="8" color="#ed6925" label="8 h" alpha="255"/>
            <item value="12" color="#fcb519" label="12 h" alpha="255"/>
            <item value="16" color="#fcffa4" label="16 h" alpha="255"/>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast brightness="0" contrast="0" gamma="1"/>
    <huesaturation saturation="0"/>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
