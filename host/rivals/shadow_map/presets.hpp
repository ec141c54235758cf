// SPDX-License-Identifier: MIT
// Named compositions of the shadow-map family: a line each, registered as techniques of their own.
#pragma once

#include <string_view>

namespace gnomon {

struct ShadowMapPreset {
    std::string_view name;
    std::string_view summary;   ///< with authors and year
    std::string_view settings;  ///< "key=value key=value": on top of technique shadow-map's defaults
};

inline constexpr ShadowMapPreset presets[] = {
    {"pcf", "percentage-closer filtering, the mean of 3 x 3 comparisons (Reeves, Salesin, Cook 1987)",
     "lookup=pcf taps=3 slope-bias=2.5"},
    {"gaussian-12-tap", "soft edges by 12 comparisons at Gaussian-distributed offsets (NVIDIA SDK 8, 2004)",
     "lookup=twelve softness=1.5 slope-bias=4"},
    {"fast-9x9", "smooth 9 x 9 filter that reads each texel once (Gruen 2010)", "lookup=gaussian taps=9 slope-bias=5"},
    {"adaptive-bias", "hard shadow map, each texel compared with the receiver's plane there (Dou et al. 2014)",
     "bias=adaptive"},
    {"dual-layer", "hard shadow map half-way between the two nearest layers (Weiskopf and Ertl 2003)",
     "bias=dual constant-bias=0.00001"},
    {"pcss", "percentage-closer soft shadows: penumbra as wide as blockers and light make it (Fernando 2005)",
     "lookup=pcss taps=7 bias=adaptive"},
    {"vsm", "variance shadow map (Donnelly and Lauritzen 2006)", "store=variance prefilter=gaussian"},
    {"vsm-remap", "variance shadow map, the least visibility cut off against light bleeding (Lauritzen 2007)",
     "store=variance prefilter=gaussian bleeding=0.3"},
    {"vsm-edges", "variance shadow map on shadow edges only (Sterna 2011)",
     "store=variance prefilter=gaussian edges-only=on constant-bias=0.002"},
    {"vsm-mip", "variance shadow map filtered over each pixel's footprint by a mip chain (Donnelly and Lauritzen 2006)",
     "store=variance prefilter=mip"},
    {"layered-vsm", "variance shadow map in layers of depth (Lauritzen and McCool 2008)",
     "store=layered layers=4 prefilter=gaussian"},
    {"convolution", "convolution shadow map: the comparison as a Fourier series (Annen et al. 2007)",
     "store=convolution terms=16 prefilter=gaussian size=1024"},
    {"esm", "exponential shadow map (Annen et al. 2008; Salvi 2008)",
     "store=exponential exponent=80 prefilter=gaussian"},
    {"evsm2", "exponential variance shadow map, positive exponent (Lauritzen and McCool 2008)",
     "store=evsm2 exponent=40 prefilter=gaussian"},
    {"evsm4", "exponential variance shadow map, both exponents (Lauritzen and McCool 2008)",
     "store=evsm4 exponent=40 negative-exponent=5 prefilter=gaussian"},
    {"ewgf", "exponentially warped Gaussian filter (Gumbau et al. 2013)", "store=ewgf exponent=40 prefilter=gaussian"},
    {"msm64", "moment shadow map, Hamburger, 64-bit texels (Peters and Klein 2015)",
     "store=moments bits=64 prefilter=gaussian"},
    {"msm128", "moment shadow map, Hamburger, 128-bit texels (Peters and Klein 2015)",
     "store=moments bits=128 prefilter=gaussian"},
    {"psm", "perspective shadow map in its practical form (Stamminger and Drettakis 2002; Kozlov 2004)",
     "projection=psm"},
    {"lispsm", "light-space perspective shadow map, optimal n (Wimmer, Scherzer, Purgathofer 2004)",
     "projection=lispsm"},
    {"logpsm", "logarithmic perspective shadow map, truly logarithmic raster (Lloyd et al. 2008)", "projection=logpsm"},
    {"logpsm-faces", "logarithmic maps for the sides of the view frustum, texels shared by error (Lloyd et al. 2008)",
     "projection=logpsm partition=faces share-texels=on size=1024"},
    {"rtw", "rectilinear texture warping, hybrid analysis (Rosen 2012)", "warp=hybrid"},
    {"pssm", "parallel-split shadow maps, cascades between fixed planes (Zhang et al. 2006)",
     "cascades=4 lambda=0.5 depth-range=planes fit=frustum size=1024"},
    {"sdsm", "sample distribution shadow maps, cascades where the points are (Lauritzen, Salvi, Lefohn 2011)",
     "cascades=4 lambda=1 size=1024"},
    {"stabilised-cascades", "cascades that do not swim: bounding spheres on a grid of texels (Valient 2008)",
     "cascades=4 lambda=0.7 fit=sphere size=1024"},
    {"quantised-cascades", "cascades that hardly swim: quantised scale and offset (Zhang et al. 2009)",
     "cascades=4 lambda=0.7 fit=quantised size=1024"},
};

}  // namespace gnomon
