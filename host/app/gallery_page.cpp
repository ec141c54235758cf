// SPDX-License-Identifier: MIT
// The page's text. Data are written as JSON; a small script builds the table and the comparison from it. Without
// scripts the page shows a note. Colours: orange is wrongly lit, blue wrongly shadowed, as in difference_picture().
#include "gallery_page.hpp"

#include <nlohmann/json.hpp>

namespace gnomon::app {
namespace {

using nlohmann::ordered_json;

const char* const page_head = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>gnomon gallery</title>
<style>
:root { color-scheme: light dark; --line: #8884; --lit: #ff8c00; --dark: #1a73ff; }
* { box-sizing: border-box; }
body { font: 16px/1.45 system-ui, sans-serif; margin: 0 auto; padding: 1rem; max-width: 75rem; }
h1 { font-size: 1.5rem; margin: 0 0 .5rem; }
h2 { font-size: 1.15rem; margin: 1.75rem 0 .5rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0 1rem; margin: 0; font-size: .9rem; }
dt { opacity: .7; } dd { margin: 0; overflow-wrap: anywhere; }
select, button { font: inherit; max-width: 100%; }
.choice { display: flex; flex-wrap: wrap; gap: .5rem 1rem; margin-bottom: .5rem; }
.compare { position: relative; overflow: hidden; touch-action: pan-y; cursor: ew-resize; background: #222; }
.compare img { display: block; width: 100%; height: auto; }
.compare img.over { position: absolute; inset: 0; clip-path: inset(0 calc(100% - var(--at)) 0 0); }
.compare::after { content: ""; position: absolute; top: 0; bottom: 0; left: var(--at); width: 2px; background: #fff; }
.compare span { position: absolute; top: .4rem; padding: 0 .4rem; background: #000a; color: #fff; font-size: .85rem; }
.compare .left { left: .4rem; } .compare .right { right: .4rem; }
#at { width: 100%; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; width: 100%; }
th, td { padding: .3rem .5rem; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; white-space: normal; min-width: 9rem; }
th button { border: 0; background: none; padding: 0; font-weight: 600; cursor: pointer; color: inherit; }
th[aria-sort=ascending] button::after { content: " \2191"; } th[aria-sort=descending] button::after { content: " \2193"; }
tr.front td:first-child::before { content: "\25C6 "; }
.settings { opacity: .7; overflow-wrap: anywhere; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 22rem), 1fr)); gap: 1.25rem; }
.card { border: 1px solid var(--line); padding: .6rem; }
.card h3 { margin: 0; font-size: 1rem; } .card p { margin: .2rem 0 .5rem; font-size: .85rem; }
.card img { width: 100%; height: auto; display: block; margin-top: .3rem; }
.card select { margin-top: .3rem; }
.meaning { margin: .3rem 0 0; font-size: .85rem; opacity: .8; }
.failure { color: #c33; }
.lit { color: var(--lit); } .dark { color: var(--dark); }
</style>
</head>
<body>
<noscript>This page builds its table and pictures with a script: please allow it. Nothing is loaded from elsewhere.</noscript>
<main hidden>
<h1></h1>
<dl id="facts"></dl>
<h2>Compare two</h2>
<div class="choice"><label>left <select id="left"></select></label><label>right <select id="right"></select></label>
<label>show <select id="show"></select></label></div>
<div class="compare"><img alt="right picture"><img class="over" alt="left picture"><span class="left"></span><span class="right"></span></div>
<input id="at" type="range" min="0" max="100" value="50" aria-label="where the left picture ends">
<p class="meaning"></p>
<h2>All</h2>
<p>Errors are against the exact truth of the same run: a pixel is <span class="lit">wrongly lit</span> or
<span class="dark">wrongly shadowed</span> if its visibility is at least half off. Worst tile: the mean error of the worst
32 x 32 pixels. &#9670; marks the Pareto front: nothing here is both faster and less wrong. Click a heading to sort.</p>
<div class="scroll"><table><thead><tr></tr></thead><tbody></tbody></table></div>
<h2>Pictures, errors and diagnostics</h2>
<div class="cards"></div>
</main>
<script type="application/json" id="data">)html";

const char* const page_tail = R"html(</script>
<script>
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const shown = data.exhibits.filter(e => !e.failure);
const $ = s => document.querySelector(s);
const make = (tag, text, name) => {
  const e = document.createElement(tag);
  if (text !== undefined) e.textContent = text;
  if (name) e.className = name;
  return e;
};
const label = e => e.settings ? e.name + " " + e.settings : e.name;
const percent = x => x === 0 ? "0" : (100 * x).toPrecision(3) + " %";
const wrong = e => e.wrongly_lit + e.wrongly_shadowed;
const columns = [
  ["technique", label, label],
  ["ms", e => e.median_ms, e => e.median_ms.toFixed(2)],
  ["memory", e => e.memory_bytes, e => (e.memory_bytes / 1048576).toFixed(1) + " MiB"],
  ["wrong", wrong, e => percent(wrong(e) / e.points)],
  ["wrongly lit", e => e.wrongly_lit, e => percent(e.wrongly_lit / e.points)],
  ["wrongly shadowed", e => e.wrongly_shadowed, e => percent(e.wrongly_shadowed / e.points)],
  ["mean error", e => e.mean_absolute, e => percent(e.mean_absolute)],
  ["worst tile", e => e.worst_tile, e => percent(e.worst_tile)],
  ["SSIM", e => e.ssim, e => e.ssim.toFixed(4)],
];
const onFront = e => !shown.some(o => o !== e && o.median_ms <= e.median_ms && o.mean_absolute <= e.mean_absolute &&
  (o.median_ms < e.median_ms || o.mean_absolute < e.mean_absolute));

document.title = data.title;
$("h1").textContent = data.title;
for (const [name, text] of data.facts) $("#facts").append(make("dt", name), make("dd", text));

// What can be shown of a technique: its picture, its errors, its diagnostics.
const sights = e => [
  { name: "picture", meaning: "", picture: e.picture },
  { name: "errors", meaning: "orange: wrongly lit, blue: wrongly shadowed", picture: e.difference },
  ...e.diagnostics];
const options = (select, names) => names.forEach((name, i) => {
  const o = make("option", name);
  o.value = i;
  select.append(o);
});
const sightNames = [...new Set(shown.flatMap(e => sights(e).map(s => s.name)))];

function compare() {
  const left = shown[$("#left").value], right = shown[$("#right").value], name = sightNames[$("#show").value];
  const [under, over] = document.querySelectorAll(".compare img");
  const meanings = new Set();
  for (const [img, e, side] of [[under, right, ".right"], [over, left, ".left"]]) {
    const sight = sights(e).find(s => s.name === name) || sights(e)[0];
    img.width = data.width; img.height = data.height;
    img.src = sight.picture;
    $(".compare " + side).textContent = label(e) + (sight.name === name ? "" : " has no " + name);
    if (sight.meaning) meanings.add(sight.meaning);
  }
  $(".meaning").textContent = [...meanings].join("; ");
}
const moveTo = value => $(".compare").style.setProperty("--at", value + "%");
for (const id of ["#left", "#right"]) options($(id), shown.map(label));
options($("#show"), sightNames);
$("#right").value = Math.min(1, shown.length - 1);
for (const id of ["#left", "#right", "#show"]) $(id).addEventListener("change", compare);
$("#at").addEventListener("input", e => moveTo(e.target.value));
const drag = e => {
  if (e.type === "pointermove" && !e.buttons) return;
  const box = $(".compare").getBoundingClientRect();
  $("#at").value = 100 * (e.clientX - box.left) / box.width;
  moveTo($("#at").value);
};
for (const type of ["pointerdown", "pointermove"]) $(".compare").addEventListener(type, drag);
$(".compare").addEventListener("dragstart", e => e.preventDefault());
moveTo(50);
compare();

let order = { column: 1, down: false };
function table() {
  const key = columns[order.column][1];
  const rows = [...shown].sort((a, b) => (key(a) < key(b) ? -1 : key(a) > key(b) ? 1 : 0) * (order.down ? -1 : 1));
  document.querySelectorAll("th").forEach((th, i) =>
    th.setAttribute("aria-sort", i !== order.column ? "none" : order.down ? "descending" : "ascending"));
  $("tbody").replaceChildren(...rows.map(e => {
    const row = make("tr", undefined, onFront(e) ? "front" : "");
    columns.forEach(([, , text]) => row.append(make("td", text(e))));
    return row;
  }));
}
columns.forEach(([name], i) => {
  const th = make("th"), button = make("button", name);
  button.addEventListener("click", () => {
    order = { column: i, down: order.column === i ? !order.down : false };
    table();
  });
  th.append(button);
  $("thead tr").append(th);
});
table();

for (const e of data.exhibits) {
  const card = make("article", undefined, "card");
  card.append(make("h3", e.name));
  if (e.settings) card.append(make("div", e.settings, "settings"));
  card.append(make("p", e.summary));
  if (e.failure) {
    card.append(make("p", e.failure, "failure"));
  } else {
    card.append(make("p", `${e.median_ms.toFixed(2)} ms (${e.least_ms.toFixed(2)} to ${e.most_ms.toFixed(2)}), ` +
      `wrong ${percent(wrong(e) / e.points)}`));
    // The picture can be switched to the diagnostics; the errors stay below it.
    const switched = sights(e).filter(s => s.name !== "errors");
    const select = make("select"), meaning = make("p", undefined, "meaning");
    options(select, switched.map(s => s.name));
    select.setAttribute("aria-label", "what to show of " + label(e));
    const show = (img, sight) => {
      img.width = data.width; img.height = data.height; img.loading = "lazy";
      img.alt = label(e) + ": " + sight.name;
      img.src = sight.picture;
      return img;
    };
    const picture = make("img");
    const look = () => {
      show(picture, switched[select.value]);
      meaning.textContent = switched[select.value].meaning;
    };
    select.addEventListener("change", look);
    look();
    if (switched.length > 1) card.append(select);
    card.append(picture, meaning, show(make("img"), sights(e)[1]));
  }
  $(".cards").append(card);
}
$("main").hidden = false;
</script>
</body>
</html>
)html";

ordered_json exhibit_json(const Exhibit& e) {
    ordered_json json{{"name", e.name}, {"settings", e.settings}, {"summary", e.summary}, {"exact", e.exact}};
    if (!e.failure.empty()) {
        json["failure"] = e.failure;
        return json;
    }
    json.update({{"median_ms", e.median_ms},
                 {"least_ms", e.least_ms},
                 {"most_ms", e.most_ms},
                 {"memory_bytes", e.memory_bytes},
                 {"points", e.errors.points},
                 {"wrongly_lit", e.errors.wrongly_lit},
                 {"wrongly_shadowed", e.errors.wrongly_shadowed},
                 {"mean_absolute", e.errors.mean_absolute},
                 {"worst_tile", e.errors.worst_tile},
                 {"ssim", e.errors.ssim},
                 {"picture", e.picture},
                 {"difference", e.difference}});
    json["diagnostics"] = ordered_json::array();
    for (const auto& [name, meaning, picture] : e.diagnostics)
        json["diagnostics"].push_back({{"name", name}, {"meaning", meaning}, {"picture", picture}});
    return json;
}

/// Inside a script element "</script" and "<!--" have a meaning. In JSON, "<" stands only in strings, where its number
/// can replace it.
std::string safe_in_script(std::string json) {
    for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;) json.replace(at, 1, "\\u003c");
    return json;
}

}  // namespace

std::string html_of(const GalleryPage& page) {
    ordered_json data{{"title", page.title}, {"width", page.width}, {"height", page.height}};
    data["facts"] = ordered_json::array();
    for (const auto& [label, text] : page.facts) data["facts"].push_back({label, text});
    data["exhibits"] = ordered_json::array();
    for (const Exhibit& e : page.exhibits) data["exhibits"].push_back(exhibit_json(e));
    return page_head + safe_in_script(data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) + page_tail;
}

}  // namespace gnomon::app
