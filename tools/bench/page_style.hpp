// SPDX-License-Identifier: MIT
// The page's style: light and dark, desktop and phone. s0 to s11 are the colours of the charts' series.
#pragma once

namespace gnomon::bench {

inline constexpr const char* page_style = R"(
:root { color-scheme: light dark; --ink: #1c2430; --faint: #5d6a7a; --line: #d9dfe6; --paper: #ffffff; --panel: #f6f8fa;
  --c0: #0b63b5; --c1: #c2410c; --c2: #1b7f4b; --c3: #8b3fb0; --c4: #a16207; --c5: #3f4650; --c6: #be185d; --c7: #64748b;
  --c8: #0e8f9e; --c9: #7a4b22; --c10: #6a9a12; --c11: #5b4bd6; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6ebf1; --faint: #9aa7b6; --line: #313b47; --paper: #12171d;
  --panel: #1a212a; --c0: #5aa9f5; --c1: #fb923c; --c2: #4ec98a; --c3: #c893e8; --c4: #e0b341; --c5: #d5dbe3;
  --c6: #f472b6; --c7: #94a3b8; --c8: #2fd0e0; --c9: #c79a6b; --c10: #a9d84a; --c11: #a5a0ff; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1240px; padding: 24px 16px 64px; color: var(--ink); background: var(--paper);
  font: 15px/1.5 system-ui, sans-serif; }
h1 { font-size: 26px; margin: 0 0 4px; } h2 { font-size: 20px; margin: 44px 0 4px; padding-top: 16px;
  border-top: 1px solid var(--line); } h3 { font-size: 16px; margin: 24px 0 4px; } p { margin: 4px 0 10px; max-width: 75ch; }
.note, figcaption, .source { color: var(--faint); font-size: 13px; }
.scroll, .chart { overflow-x: auto; } .chart svg { width: 100%; min-width: 520px; max-width: 900px; display: block; }
table { border-collapse: collapse; font-size: 13px; margin: 6px 0 12px; } th, td { padding: 3px 10px 3px 0;
  text-align: left; white-space: nowrap; border-bottom: 1px solid var(--line); } th { color: var(--faint);
  font-weight: 600; white-space: normal; vertical-align: bottom; } td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
td.bad { color: var(--c1); font-weight: 600; }
summary { cursor: pointer; color: var(--faint); margin: 6px 0; }
.gallery { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 480px), 1fr)); gap: 12px; }
figure { margin: 0; } .pair { display: grid; grid-template-columns: 1fr 1fr; gap: 4px; }
figure img { width: 100%; display: block; border: 1px solid var(--line); }
.legend { display: flex; flex-wrap: wrap; gap: 4px 16px; font-size: 13px; margin: 6px 0; padding: 0; list-style: none; }
.swatch { display: inline-block; width: 11px; height: 11px; border-radius: 2px; margin-right: 5px; }
ol.front { font-size: 13px; margin: 4px 0; padding-left: 22px; columns: 2 300px; }
svg text { font: 12px system-ui, sans-serif; fill: var(--ink); } svg .tick, svg .axis { fill: var(--faint); }
svg .label { font-weight: 600; } .grid { stroke: var(--line); } .front { fill: none; stroke: var(--faint);
  stroke-dasharray: 5 4; } .mark { stroke: var(--paper); } .mark.hollow { fill-opacity: 0.15; stroke-width: 2; }
.line { fill: none !important; stroke-width: 2; }
.s0 { fill: var(--c0); background: var(--c0); } .s1 { fill: var(--c1); background: var(--c1); }
.s2 { fill: var(--c2); background: var(--c2); } .s3 { fill: var(--c3); background: var(--c3); }
.s4 { fill: var(--c4); background: var(--c4); } .s5 { fill: var(--c5); background: var(--c5); }
.s6 { fill: var(--c6); background: var(--c6); } .s7 { fill: var(--c7); background: var(--c7); }
.s8 { fill: var(--c8); background: var(--c8); } .s9 { fill: var(--c9); background: var(--c9); }
.s10 { fill: var(--c10); background: var(--c10); } .s11 { fill: var(--c11); background: var(--c11); }
.line.s0, .hollow.s0 { stroke: var(--c0); } .line.s1, .hollow.s1 { stroke: var(--c1); } .line.s2, .hollow.s2 { stroke: var(--c2); }
.line.s3, .hollow.s3 { stroke: var(--c3); } .line.s4, .hollow.s4 { stroke: var(--c4); } .line.s5, .hollow.s5 { stroke: var(--c5); }
.line.s6, .hollow.s6 { stroke: var(--c6); } .line.s7, .hollow.s7 { stroke: var(--c7); } .line.s8, .hollow.s8 { stroke: var(--c8); }
.line.s9, .hollow.s9 { stroke: var(--c9); } .line.s10, .hollow.s10 { stroke: var(--c10); } .line.s11, .hollow.s11 { stroke: var(--c11); }
)";

}  // namespace gnomon::bench
