<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis styleCategories="Symbology" version="3.22">
  <pipe>
    <provider><resampling enabled="false"/></provider>
    <rasterrenderer type="singlebandpseudocolor" band="1" opacity="0.8" alphaBand="-1" classificationMin="0" classificationMax="100">
      <rastershader>
        <colorrampshader colorRampType="INTERPOLATED" classificationMode="1" clip="0" minimumValue="0" maximumValue="100">
            <item value="0" color="#1a9641" label="0 m: seen" alpha="255"/>
            <item value="5" color="#ffffbf" label="5 m" alpha="255"/>
            <item value="20" color="#fdae61" label="20 m" alpha="255"/>
            <item value="100" color="#d7191c" label="100 m and more" alpha="255"/>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast brightness="0" contrast="0" gamma="1"/>
    <huesaturation saturation="0"/>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
