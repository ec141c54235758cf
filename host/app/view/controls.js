// SPDX-License-Identifier: MIT
// What a mouse, fingers and keys do.
'use strict';

const pointers = new Map();  // those that are down on the stage
const cross2d = {x: 0.5, y: 0.5, isShown: false};  // where Enter asks, in parts of the picture
const held = new Set();  // keys of flying that are down
let press = null, lastFlight = 0;

const partOf = event => {
  const box = stage.getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
};

// ---- Pointers ----

function dragged(event, dx, dy) {
  const height = stage.clientHeight;
  if (event.shiftKey) {
    const {azimuth, elevation} = angles();
    moveSun({azimuth: azimuth + 180 * dx / height, elevation: elevation - 90 * dy / height});
  } else if (event.buttons & 6) moveCamera(orbit => orbit.pan(-dx / height, dy / height));
  else if (event.ctrlKey) moveCamera(orbit => orbit.look(-2 * dx / height, -2 * dy / height));
  else moveCamera(orbit => orbit.turn(-4 * dx / height, 3 * dy / height));
}
// Two fingers pan, and come closer.
function pinched(id, event) {
  const [other] = [...pointers.entries()].filter(([key]) => key !== id).map(([, at]) => at);
  const before = pointers.get(id), height = stage.clientHeight;
  const apart = at => Math.hypot(at.x - other.x, at.y - other.y);
  const factor = apart(before) / Math.max(1, apart({x: event.clientX, y: event.clientY}));
  moveCamera(orbit => {
    orbit.pan(-(event.clientX - before.x) / 2 / height, (event.clientY - before.y) / 2 / height);
    orbit.dolly(Math.max(0.5, Math.min(2, factor)));
  });
}
stage.addEventListener('pointerdown', event => {
  if (event.target.id === 'divider') return;
  stage.focus();
  stage.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
  press = pointers.size === 1 && event.button === 0 ? {x: event.clientX, y: event.clientY} : null;
});
stage.addEventListener('pointermove', event => {
  const before = pointers.get(event.pointerId);
  if (!before) return;
  if (press && Math.hypot(event.clientX - press.x, event.clientY - press.y) < 4) return;
  press = null;
  if (pointers.size > 1) pinched(event.pointerId, event);
  else dragged(event, event.clientX - before.x, event.clientY - before.y);
  pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
});
function released(event) {
  if (!pointers.delete(event.pointerId)) return;
  if (press && event.type === 'pointerup') explain(...partOf(event));
  press = null;
}
stage.addEventListener('pointerup', released);
stage.addEventListener('pointercancel', released);
stage.addEventListener('contextmenu', event => event.preventDefault());
stage.addEventListener('dblclick', turnAboutAnswer);
stage.addEventListener('wheel', event => {
  event.preventDefault();
  moveCamera(orbit => orbit.dolly(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 500)))));
}, {passive: false});

// The point that was asked about is the one that the camera turns about.
function turnAboutAnswer() {
  if (asked.facts && !asked.facts.is_absent)
    moveCamera(orbit => { orbit.target = asked.facts.position.slice(); });
}

function dragOf(element, moved) {
  element.addEventListener('pointerdown', event => {
    element.setPointerCapture(event.pointerId);
    moved(event);
  });
  element.addEventListener('pointermove', event => {
    if (element.hasPointerCapture(event.pointerId)) moved(event);
  });
}
function moveDivider(part) {
  look.divider = Math.max(0, Math.min(1, part));
  byId('divider').setAttribute('aria-valuenow', String(Math.round(100 * look.divider)));
  draw();
}
dragOf(byId('dial'), dragDial);
dragOf(byId('divider'), event => moveDivider(partOf(event)[0]));

// ---- Keys ----

function drawCross(context, ratio) {
  const x = cross2d.x * overlay.width, y = cross2d.y * overlay.height, arm = 12 * ratio;
  for (const [style, width] of [['#000', 4], ['#fff', 2]]) {
    context.strokeStyle = style;
    context.lineWidth = width * ratio;
    context.beginPath();
    context.moveTo(x - arm, y);
    context.lineTo(x + arm, y);
    context.moveTo(x, y - arm);
    context.lineTo(x, y + arm);
    context.stroke();
  }
}
function arrow(x, y, event) {
  if (event.ctrlKey) {
    const [width, height] = fullSize(), pixels = event.shiftKey ? 10 : 1;
    cross2d.isShown = true;
    cross2d.x = Math.max(0, Math.min(1 - 0.5 / width, cross2d.x + x * pixels / width));
    cross2d.y = Math.max(0, Math.min(1 - 0.5 / height, cross2d.y - y * pixels / height));
    draw();
  } else if (event.shiftKey) moveCamera(orbit => orbit.pan(0.03 * x, 0.03 * y));
  else moveCamera(orbit => orbit.turn(0.06 * x, 0.06 * y));
}
const turnSun = (azimuth, elevation) => {
  const now = angles();
  moveSun({azimuth: now.azimuth + azimuth, elevation: now.elevation + elevation});
};
function stepCamera(step) {
  const select = byId('camera');
  select.selectedIndex = (select.selectedIndex + step + select.options.length) % select.options.length;
  chooseCamera(select.value);
}
const keys = {
  ArrowLeft: event => arrow(-1, 0, event), ArrowRight: event => arrow(1, 0, event),
  ArrowUp: event => arrow(0, 1, event), ArrowDown: event => arrow(0, -1, event),
  '+': () => moveCamera(orbit => orbit.dolly(0.9)), '=': () => moveCamera(orbit => orbit.dolly(0.9)),
  '-': () => moveCamera(orbit => orbit.dolly(1 / 0.9)),
  j: () => turnSun(-2, 0), l: () => turnSun(2, 0), i: () => turnSun(0, 2), k: () => turnSun(0, -2),
  '[': () => moveDivider(look.divider - 0.02), ']': () => moveDivider(look.divider + 0.02),
  c: () => { byId('show').selectedIndex ^= 1; look.show = byId('show').value; draw(); },
  r: () => resetCamera(), ',': () => stepCamera(-1), '.': () => stepCamera(1), o: turnAboutAnswer,
  h: () => byId('hours').click(),
  ' ': () => look.scene.animations.length ? byId('play').click() : byId('play-day').click(),
  Enter: () => { cross2d.isShown = true; explain(cross2d.x, cross2d.y); },
  Escape: () => { cross2d.isShown = false; clearAnswer(); },
};
const flights = {w: [0, 0, 1], s: [0, 0, -1], a: [-1, 0, 0], d: [1, 0, 0], q: [0, -1, 0], e: [0, 1, 0]};

function fly() {
  const now = performance.now(), seconds = Math.min(0.1, (now - lastFlight) / 1000);
  lastFlight = now;
  if (held.size === 0) return;
  const bounds = look.scene.bounds, size = length(minus(bounds.slice(3), bounds.slice(0, 3)));
  const step = seconds * size * (held.has('Shift') ? 0.4 : 0.1);
  moveCamera(orbit => {
    for (const key of held)
      if (key in flights) {
        const [right, up, ahead] = times(flights[key], step);
        orbit.move(add([0, up, 0], add(times(orbit.right, right), times(orbit.forward, ahead))));
      }
  });
  requestAnimationFrame(fly);
}
stage.addEventListener('keydown', event => {
  if (event.altKey || event.metaKey || event.target !== stage || !look.scene) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (key in flights && !event.ctrlKey) {
    if (held.size === 0) {
      lastFlight = performance.now();
      requestAnimationFrame(fly);
    }
    held.add(key);
  } else if (key === 'Shift') {
    if (held.size) held.add(key);
    return;
  } else if (key in keys && !(event.ctrlKey && !key.startsWith('Arrow'))) keys[key](event);
  else return;
  event.preventDefault();
});
stage.addEventListener('keyup', event => {
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  held.delete(key);
  if ([...held].every(other => other === 'Shift')) held.clear();
});
stage.addEventListener('blur', () => held.clear());
byId('divider').addEventListener('keydown', event => {
  const step = {ArrowLeft: -0.02, ArrowRight: 0.02}[event.key];
  if (step) moveDivider(look.divider + step);
});
document.addEventListener('keydown', event => {
  if (event.key === '?' && !event.target.matches('input')) byId('help').showModal();
});

// ---- The panel's controls ----

const on = (id, kind, work) => byId(id).addEventListener(kind, event => work(event.target));
on('camera', 'change', select => chooseCamera(select.value));
on('reset', 'click', () => resetCamera());
on('light', 'change', select => chooseLight(select.value));
for (const id of ['azimuth', 'elevation']) on(id, 'input', () => moveSun(angles()));
for (const id of ['place', 'day']) on(id, 'change', loadSuns);
on('hour', 'input', showHour);
on('play-day', 'click', () => play('play-day', stepDay));
on('hours', 'click', () => showHours(!look.hours));
on('sun-angle', 'change', input => { look.sunAngle = Math.max(0, Math.min(89, Number(input.value) || 0)); changed(); });
on('ambient', 'change', select => { look.ambient = select.value; changed(); });
on('rival', 'change', select => chooseRival(select.value));
on('show', 'change', select => { look.show = select.value; draw(); });
on('samples', 'change', select => { look.samples = Number(select.value); changed(); });
on('animation', 'change', select => { chooseAnimation(Number(select.value)); showTime(0); });
on('time', 'input', input => showTime(Number(input.value)));
on('play', 'click', () => play('play', stepAnimation));
on('copy', 'click', button => copy(byId('command').textContent, button));
on('copy-explain', 'click', button => copy(asked.facts.command, button));
on('save', 'click', savePng);
on('clear', 'click', clearAnswer);
on('ask-for-help', 'click', () => byId('help').showModal());
on('toggle', 'click', () => byId('panel').classList.toggle('closed'));

start();
