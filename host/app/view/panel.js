// SPDX-License-Identifier: MIT
// The panel: camera, light, comparison, explanation, animation, and the commands that do the same.
'use strict';

const asked = {facts: null, width: 0, height: 0};
let suns = [], playing = null;

function fill(select, entries) {
  for (const [value, text] of entries) select.append(new Option(text, value));
}
const lightChoices = () => [['', 'of the start'], ['sun', 'a sun that you move'],
  ...look.scene.lights.map(light => ['name:' + light.name, `${light.name} (${light.type})`])];

// ---- Camera ----

function resetCamera() {
  look.orbit = null;
  changed();
}
function chooseCamera(name) {
  look.camera = name ? {camera: name} : startCamera();
  resetCamera();
}
function startCamera() {
  const names = ['camera', 'eye', 'target', 'up', 'fovy'];
  return Object.fromEntries(names.filter(name => name in look.scene.start).map(name => [name, look.scene.start[name]]));
}
// The camera from here on is the page's own.
function moveCamera(step) {
  if (!shown.facts) return;
  if (!look.orbit) {
    look.orbit = Orbit.of(shown.facts.camera, look.scene.bounds);
    if (look.camera.target) look.orbit.target = vectorOf(look.camera.target);
  }
  step(look.orbit);
  changed();
}

// ---- Light ----

function startLight() {
  const names = ['light', 'light-direction', 'light-position'];
  return Object.fromEntries(names.filter(name => name in look.scene.start).map(name => [name, look.scene.start[name]]));
}
function chooseLight(value) {
  if (value === 'sun') return moveSun(angles());
  showHours(false);
  look.light = value ? {light: value.slice(5)} : startLight();
  changed();
}
const angles = () => ({azimuth: Number(byId('azimuth').value), elevation: Number(byId('elevation').value)});

function moveSun({azimuth, elevation}) {
  azimuth = (azimuth % 360 + 360) % 360;
  elevation = Math.max(0.5, Math.min(90, elevation));
  setSun(vectorText(sunDirection(azimuth, elevation)));
  showAngles({azimuth, elevation});
}
function setSun(direction) {
  showHours(false);
  look.light = {'light-direction': direction};
  byId('light').value = 'sun';
  changed();
}
function showAngles({azimuth, elevation}) {
  byId('azimuth').value = azimuth;
  byId('elevation').value = elevation;
  byId('azimuth-value').textContent = `${azimuth.toFixed(1)}\u00b0`;
  byId('elevation-value').textContent = `${elevation.toFixed(1)}\u00b0`;
  drawDial(azimuth, elevation);
}
// The sky from above: the middle is overhead, the rim the horizon, north above.
function drawDial(azimuth, elevation) {
  const dial = byId('dial'), c = dial.getContext('2d'), middle = dial.width / 2, radius = middle - 14;
  c.clearRect(0, 0, dial.width, dial.height);
  c.strokeStyle = '#9aa';
  c.lineWidth = 2;
  for (const part of [1, 2 / 3, 1 / 3]) {
    c.beginPath();
    c.arc(middle, middle, radius * part, 0, 7);
    c.stroke();
  }
  c.fillStyle = '#eee';
  c.font = '20px sans-serif';
  c.textAlign = 'center';
  c.fillText('N', middle, 16);
  const away = radius * (1 - elevation / 90), a = azimuth * degrees;
  c.fillStyle = '#ffd23f';
  c.beginPath();
  c.arc(middle + away * Math.sin(a), middle - away * Math.cos(a), 12, 0, 7);
  c.fill();
}
function dragDial(event) {
  const box = byId('dial').getBoundingClientRect();
  const x = (event.clientX - box.left) / box.width * 2 - 1, y = (event.clientY - box.top) / box.height * 2 - 1;
  moveSun({azimuth: Math.atan2(x, -y) / degrees, elevation: 90 * (1 - Math.hypot(x, y) / 0.825)});
}

const placeText = () => byId('place').value.replace(/\s/g, '');
async function loadSuns() {
  stopPlaying();
  suns = [];
  const hour = byId('hour');
  try {
    if (byId('day').value)
      suns = await (await ask('suns', {place: placeText(), day: byId('day').value})).json();
    byId('hour-value').textContent = suns.length ? '' : 'no sun';
  } catch (error) {
    byId('hour-value').textContent = error.message;
  }
  hour.disabled = byId('play-day').disabled = suns.length === 0;
  hour.max = Math.max(0, suns.length - 1);
  hour.value = Math.floor(suns.length / 2);
  byId('hours').disabled = suns.length === 0;
  if (look.hours) showHours(suns.length > 0);
}
function showHour() {
  const sun = suns[Number(byId('hour').value)];
  if (!sun) return;
  byId('hour-value').textContent = sun.time.slice(11, 16);
  setSun(sun.direction);
  showAngles(sunAngles(vectorOf(sun.direction)));
}

// The hours of the day as colours; the last one stands for a whole day of sun, so that colours stay while all moves.
function showHours(isOn) {
  byId('hours').setAttribute('aria-pressed', String(isOn));
  if (!isOn && !look.hours) return;
  look.hours = isOn ? {place: placeText(), day: byId('day').value, most: String(suns.length / 6)} : null;
  if (isOn) chooseRival('');
  else changed();
}
function describeHours() {
  const {legend} = shown.path === 'hours' ? shown.facts : {};
  byId('legend').hidden = !legend;
  if (!legend) return;
  byId('colors').style.background = `linear-gradient(to right, ${legend.colors.join(', ')})`;
  byId('most').textContent = `${legend.most.toFixed(1)} ${legend.unit} of sun`;
}

// ---- Play: the day's sun, or the animation ----

function stopPlaying() {
  if (playing) clearInterval(playing.timer);
  playing = null;
  for (const id of ['play', 'play-day']) {
    byId(id).textContent = 'Play';
    byId(id).setAttribute('aria-pressed', 'false');
  }
}
function play(button, step) {
  const isOther = !playing || playing.button !== button;
  stopPlaying();
  if (!isOther) return;
  let last = performance.now();
  const tick = () => {
    const now = performance.now();
    step((now - last) / 1000);
    last = now;
  };
  playing = {button, timer: setInterval(tick, paceMs)};
  byId(button).textContent = 'Pause';
  byId(button).setAttribute('aria-pressed', 'true');
}
function stepDay(seconds) {
  const hour = byId('hour');
  stepDay.part = (stepDay.part || 0) + seconds * 12;
  const steps = Math.floor(stepDay.part);
  if (steps < 1) return;
  stepDay.part -= steps;
  hour.value = (Number(hour.value) + steps) % suns.length;
  showHour();
}
function stepAnimation(seconds) {
  const time = byId('time');
  showTime((Number(time.value) + seconds) % Math.max(Number(time.max), 1e-3));
}
function showTime(seconds) {
  look.time = Math.round(seconds * 1000) / 1000;
  byId('time').value = look.time;
  byId('time-value').textContent = `${look.time.toFixed(2)} s`;
  changed();
}
function chooseAnimation(index) {
  const animation = look.scene.animations[index];
  look.animation = look.scene.animations.length > 1 ? animation.name : null;
  byId('time').max = animation.end_s || 10;
}

// ---- Compare ----

function describeComparison() {
  const {facts} = shown, out = byId('comparison');
  if (!shown.isComparison || !facts) return out.replaceChildren();
  const part = count => `${(100 * count / facts.points).toFixed(3)} %`;
  const span = (kind, text) => Object.assign(document.createElement('span'), {className: kind, textContent: text});
  out.replaceChildren(`exact ${facts.ms.exact.toFixed(1)} ms, ${look.rival} ${facts.ms.rival.toFixed(1)} ms. Wrong: `,
                      part(facts.wrongly_lit + facts.wrongly_shadowed), ' of the pixels, ',
                      span('wrongly-lit', `${part(facts.wrongly_lit)} lit (orange)`), ', ',
                      span('wrongly-shadowed', `${part(facts.wrongly_shadowed)} dark (blue)`), '.');
}
function chooseRival(name) {
  byId('rival').value = look.rival = name;
  if (name) look.hours = null;
  byId('hours').setAttribute('aria-pressed', String(look.hours !== null));
  changed();
}

// ---- Ask ----

// What is said of a pixel stands in the panel and in the picture, which a panel on a phone leaves more room.
function sayAnswer(text) {
  byId('answer').textContent = text || 'Click a pixel: why is it lit, or dark?';
  byId('bubble').textContent = text;
  byId('bubble').hidden = !text;
}
// Explains the pixel at these parts of the picture's width and height.
async function explain(x, y) {
  const [width, height] = fullSize();
  const column = Math.min(width - 1, Math.floor(x * width)), row = Math.min(height - 1, Math.floor(y * height));
  const parameters = {...poseParameters([width, height]), ...look.light, pixel: `${column},${row}`};
  sayAnswer(`Pixel ${column},${row} ...`);
  try {
    const facts = await (await ask('explain', parameters)).json();
    Object.assign(asked, {facts, width, height});
    const decided = facts.is_absent ? '' : ` Decided by the stage ${facts.stage}, arithmetic: ${facts.arithmetic}.`;
    const what = facts.is_absent ? 'the sky' : facts.is_lit ? 'lit' : 'in shadow';
    const [near] = facts.near_misses;
    const missed = near ? ` Triangle ${near.triangle} is missed by ${near.missed_by.toPrecision(3)}, rounded.` : '';
    sayAnswer(`Pixel ${column},${row}: ${what}: ${facts.reason}.${decided}${missed}`);
    byId('explanation').textContent = facts.text;
    byId('explanation').hidden = false;
    byId('copy-explain').disabled = byId('clear').disabled = false;
  } catch (error) {
    if (error.status === undefined) return lost();
    sayAnswer(error.message);
  }
  draw();
}
function clearAnswer() {
  asked.facts = null;
  sayAnswer('');
  byId('explanation').hidden = true;
  byId('copy-explain').disabled = byId('clear').disabled = true;
  draw();
}

function drawOverlay(facts) {
  const box = stage.getBoundingClientRect(), ratio = Math.min(window.devicePixelRatio || 1, 2);
  overlay.width = Math.round(box.width * ratio);
  overlay.height = Math.round(box.height * ratio);
  const context = overlay.getContext('2d'), projection = new Projection(facts.camera, overlay.width, overlay.height);
  if (asked.facts && !asked.facts.is_absent) drawAnswer(context, projection, asked.facts, ratio);
  if (cross2d.isShown) drawCross(context, ratio);
}
function trace(context, points, isClosed) {
  context.beginPath();
  points.forEach(([x, y], i) => i === 0 ? context.moveTo(x, y) : context.lineTo(x, y));
  if (isClosed) context.closePath();
}
function drawTriangle(context, projection, vertices, color, fill, width) {
  trace(context, projection.outline([0, 3, 6].map(i => vertices.slice(i, i + 3))), true);
  context.fillStyle = fill;
  context.fill();
  for (const [style, wide] of [['#000', width + 2], [color, width]]) {
    context.strokeStyle = style;
    context.lineWidth = wide;
    context.stroke();
  }
}
// The receiver in blue, what blocks in orange, near misses in white, and the shadow ray: solid up to what blocks it.
function drawAnswer(context, projection, facts, ratio) {
  for (const {vertices} of facts.receiver) drawTriangle(context, projection, vertices, '#56a0ff', '#56a0ff22', ratio);
  for (const {vertices} of facts.near_misses) drawTriangle(context, projection, vertices, '#fff', '#fff2', ratio);
  facts.occluders.forEach(({vertices}, i) =>
    drawTriangle(context, projection, vertices, '#ff8c00', i === 0 ? '#ff8c0088' : '#ff8c0033', (i === 0 ? 3 : 1.5) * ratio));
  const at = facts.position, light = vectorOf(facts.light.at), bounds = look.scene.bounds;
  const size = length(minus(bounds.slice(3), bounds.slice(0, 3)));
  const toLight = facts.light.directional ? times(unit(light), -size) : minus(light, at);
  const first = facts.occluders[0], end = add(at, toLight);
  const hit = first ? add(at, times(unit(toLight), first.distance)) : end;
  for (const [from, to, dash] of [[at, hit, []], [hit, end, [6 * ratio, 6 * ratio]]])
    for (const [style, width] of [['#000', 4], ['#ffd23f', 2]]) {
      context.setLineDash(dash);
      context.strokeStyle = style;
      context.lineWidth = width * ratio;
      trace(context, projection.outline([from, to], false), false);
      context.stroke();
    }
  context.setLineDash([]);
  const [x, y] = projection.pixel(projection.seen(at));
  context.fillStyle = facts.is_lit ? '#ffd23f' : '#000';
  context.strokeStyle = '#fff';
  context.beginPath();
  context.arc(x, y, 4 * ratio, 0, 7);
  context.fill();
  context.stroke();
}

// ---- Commands and files ----

async function copy(text, button) {
  const label = button.textContent;
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = 'Copied';
  } catch {
    button.textContent = 'Select the text below: the browser lets nothing be copied';
  }
  setTimeout(() => { button.textContent = label; }, 1500);
}
async function savePng() {
  try {
    const {draft, ...parameters} = shown.parameters, path = shown.path === 'hours' ? 'hours' : 'frame';
    const blob = await (await ask(`${path}.png`, parameters)).blob();
    const link = document.createElement('a');
    Object.assign(link, {href: URL.createObjectURL(blob), download: path === 'hours' ? 'hours.png' : 'view.png'});
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  } catch (error) {
    failed(error);
  }
}

document.addEventListener('loaded', () => {
  const {scene} = look, number = new Intl.NumberFormat('en');
  byId('scene').textContent = [`${scene.scene}, ${number.format(scene.triangles)} triangles, ${scene.device}`, ...scene.warnings].join('. ');
  document.title = `${scene.scene} - gnomon view`;
  fill(byId('camera'), [['', 'of the start'], ...scene.cameras.map(name => [name, name])]);
  fill(byId('light'), lightChoices());
  fill(byId('rival'), scene.techniques.map(technique => [technique.name, technique.name]));
  fill(byId('animation'), scene.animations.map((animation, i) => [i, animation.name]));
  byId('animation-part').hidden = scene.animations.length === 0;
  if (scene.animations.length) chooseAnimation(0);
  look.camera = startCamera();
  look.light = startLight();
  if ('time' in scene.start) look.time = Number(scene.start.time);
  look.samples = Number(scene.start.samples);
  look.sunAngle = Number(scene.start['sun-angle'] || 0);
  byId('samples').value = look.samples;
  byId('sun-angle').value = look.sunAngle;
  byId('day').value = new Date().toISOString().slice(0, 10);
  loadSuns();
});
document.addEventListener('shown', () => {
  describeComparison();
  describeHours();
  const {lights} = shown.facts;
  if (lights.length === 1 && lights[0].directional) showAngles(sunAngles(vectorOf(lights[0].at)));
});
