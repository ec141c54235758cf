// SPDX-License-Identifier: MIT
// Which picture is asked for next, and what is shown. While anything moves, pictures have the resolution that keeps the
// pace; once all stands still, they become sharp, then smooth, then soft. The newest request wins.
'use strict';

const token = new URLSearchParams(location.search).get('token') || '';
const client = Array.from(crypto.getRandomValues(new Uint8Array(8)), b => b.toString(16).padStart(2, '0')).join('');
const byId = id => document.getElementById(id);
const stage = byId('stage'), picture = byId('picture'), overlay = byId('overlay');

const paceMs = 1000 / 30, stillAfterMs = 160, leastScale = 0.25;
const levels = {moving: 0, sharp: 1, smooth: 2, soft: 3};

// What is looked at. `light` has the parameters of the light, `camera` those of a camera that nobody has moved, `hours`
// those of the day whose hours are coloured.
const look = {scene: null, camera: {}, orbit: null, light: {}, time: null, animation: null, sunAngle: 0, ambient: 'constant',
              samples: 8, rival: '', show: 'divider', divider: 0.5, hours: null};
const shown = {number: 0, level: -1, facts: null, image: null, parameters: null, isComparison: false, path: ''};
let scale = 1, lastArrival = 0, number = 0, inFlight = 0, mostInFlight = 1, isDirty = false, lastInput = 0, stillTimer = 0, isLost = false;
const trail = [];  // times of arrival of the last second

async function ask(path, parameters = {}) {
  const answer = await fetch(`${path}?${new URLSearchParams(parameters)}`,
                             {headers: {'X-Gnomon-Token': token, 'X-Gnomon-Client': client}});
  if (answer.ok) return answer;
  const error = new Error(await answer.text());
  error.status = answer.status;
  throw error;
}

function say(text, isWrong = false) {
  byId('message').hidden = !text;
  byId('message').classList.toggle('wrong', isWrong);
  byId('message').textContent = text;
}

// The picture's size at full resolution.
function fullSize() {
  const ratio = Math.min(window.devicePixelRatio || 1, 2), box = stage.getBoundingClientRect();
  const shrink = Math.min(1, Math.sqrt(4e6 / Math.max(1, box.width * box.height * ratio * ratio)));
  return [box.width, box.height].map(side => Math.max(16, Math.round(side * ratio * shrink)));
}

const isDirectional = () => !shown.facts || shown.facts.lights.every(light => light.directional);
const isSoft = () => look.sunAngle > 0 && isDirectional() && !look.rival && !look.hours;
const isSmooth = () => look.hours !== null || (look.samples > 1 && !look.rival);

// The options of all commands: the camera and the pose, for a picture of this size.
function poseParameters(size) {
  const parameters = {size: size.join('x'), ...(look.orbit ? look.orbit.parameters() : look.camera)};
  if (look.time !== null) parameters.time = String(look.time);
  if (look.animation !== null) parameters.animation = look.animation;
  return parameters;
}
// The options of gnomon render, or of gnomon hours, for a picture of this level. Hours are finer when they are smooth.
function parametersOf(level) {
  let size = fullSize();
  if (level === levels.moving) size = size.map(side => Math.max(16, Math.round(side * scale)));
  if (look.hours) return {...poseParameters(size), ...look.hours, step: level < levels.smooth ? '60' : '10'};
  const parameters = {...poseParameters(size), ...look.light};
  if (look.rival) return {...parameters, technique: look.rival};
  if (level >= levels.smooth && isSmooth()) parameters.samples = String(look.samples);
  if (level >= levels.soft && isSoft()) {
    parameters['sun-angle'] = floatText(look.sunAngle);
    if ('sun-samples' in look.scene.start) parameters['sun-samples'] = look.scene.start['sun-samples'];
  }
  if (level >= levels.sharp && look.ambient !== 'constant') parameters.ambient = look.ambient;
  return parameters;
}

// The level after this one that shows more; none if this is the last.
function levelAfter(level) {
  for (let next = level + 1; next <= levels.soft; ++next)
    if (next === levels.sharp || (next === levels.smooth && isSmooth()) || (next === levels.soft && isSoft())) return next;
  return -1;
}
const lastLevel = () => isSoft() ? levels.soft : isSmooth() ? levels.smooth : levels.sharp;

// To be called when something that the picture shows has changed.
function changed() {
  isDirty = true;
  lastInput = performance.now();
  clearTimeout(stillTimer);
  stillTimer = setTimeout(() => refine(levels.sharp), stillAfterMs);
  pump();
}
function pump() {
  if (!isDirty || inFlight >= mostInFlight || isLost || !look.scene) return;
  isDirty = false;
  request(levels.moving);
}
function refine(level) {
  if (inFlight > 0) stillTimer = setTimeout(() => refine(level), 10);
  else if (!isLost && look.scene) request(level);
}

async function request(level) {
  const mine = ++number, parameters = parametersOf(level), isComparison = !look.hours && look.rival !== '';
  const path = look.hours ? 'hours' : isComparison ? 'compare' : 'frame', sent = performance.now();
  const isAlone = inFlight === 0;
  if (level === levels.moving) parameters.draft = '1';
  ++inFlight;
  try {
    const answer = await ask(`${path}.jpg`, parameters);
    const facts = JSON.parse(answer.headers.get('X-Gnomon'));
    const image = await createImageBitmap(await answer.blob());
    if (isAlone && level === levels.moving) mostInFlight = inFlightFor(facts.ms, performance.now() - sent);
    if (mine > shown.number) show({number: mine, level, facts, image, parameters, isComparison, path}, sent);
    if (level !== levels.moving || performance.now() - lastInput > stillAfterMs) continueAfter(level, mine);
  } catch (error) {
    if (error.status !== 409) failed(error, parameters);
  } finally {
    --inFlight;
    pump();
  }
}
// A second request on the way gives the device work while a picture is encoded, sent and decoded. Where these take less
// than half of the device's time, it would rather wait in the queue, and show the input so much later.
function inFlightFor({jpeg, ...stages}, waited) {
  const device = Object.values(stages).reduce((sum, ms) => sum + ms, 0);
  return waited > 1.5 * device ? 2 : 1;
}
function continueAfter(level, mine) {
  if (isDirty || mine !== number || level === levels.moving) return;
  const next = levelAfter(level);
  if (next >= 0) request(next);
}

function show(frame, sent) {
  if (shown.image) shown.image.close();
  Object.assign(shown, frame);
  const now = performance.now();
  if (frame.level === levels.moving) keepPace(now, sent);
  lastArrival = now;
  trail.push(now);
  while (trail[0] < now - 1000) trail.shift();
  say('');
  draw();
  describe(frame, now - sent);
  document.body.dataset.level = String(frame.level);
  document.body.dataset.last = String(frame.level === lastLevel());
  document.dispatchEvent(new Event('shown'));
}

// Pictures that arrive too slowly become smaller, and larger again.
function keepPace(now, sent) {
  const took = Math.min(now - sent, Math.max(now - lastArrival, 1));
  const factor = Math.max(0.8, Math.min(1.1, Math.sqrt(paceMs / took)));
  scale = Math.max(leastScale, Math.min(1, scale * factor));
  if (scale > 0.93) scale = 1;
}

function draw() {
  const {facts, image} = shown;
  if (!image) return;
  const width = image.width, height = shown.isComparison ? image.height / 3 : image.height;
  if (picture.width !== width || picture.height !== height) Object.assign(picture, {width, height});
  const context = picture.getContext('2d');
  const isSplit = shown.isComparison && look.show === 'divider';
  if (!shown.isComparison) context.drawImage(image, 0, 0);
  else if (!isSplit) context.drawImage(image, 0, 2 * height, width, height, 0, 0, width, height);
  else {
    const left = Math.round(width * look.divider);
    context.drawImage(image, 0, height, width, height, 0, 0, width, height);
    if (left > 0) context.drawImage(image, 0, 0, left, height, 0, 0, left, height);
  }
  for (const id of ['divider', 'left', 'right']) byId(id).hidden = !isSplit;
  byId('divider').style.left = 100 * look.divider + '%';
  byId('right').textContent = look.rival;
  drawOverlay(facts);
}

function describe({facts, level, image, isComparison, path}, waited) {
  const words = path === 'hours' ? Array(4).fill(`${facts.suns} suns`) : {[levels.moving]: 'moving', [levels.sharp]: 'sharp', [levels.smooth]: `${look.samples} samples`,
                 [levels.soft]: `${look.samples} samples, sun of ${look.sunAngle} degrees`};
  const height = isComparison ? image.height / 3 : image.height;
  const rate = level === levels.moving ? `${trail.length} pictures/s, ` : '';
  byId('facts').textContent = `${image.width} x ${height}, ${words[level]}, ${rate}${waited.toFixed(0)} ms`;
  if (level === levels.moving) return;
  byId('command').textContent = facts.command;
}

function failed(error, parameters) {
  if (error.status === undefined) return lost();
  say(error.message, true);
  document.dispatchEvent(new CustomEvent('refused', {detail: parameters}));
}

// The server does not answer: the page says so, and asks again until it does.
function lost() {
  isLost = true;
  say('The server does not answer: gnomon view has ended, or the connection to its machine is cut. The page goes on when it is back.', true);
  setTimeout(start, 1500);
}

// Waits for the scene, and shows what is being done until then.
async function start() {
  try {
    for (let began = performance.now();;) {
      const state = await (await ask('state')).json();
      if (state.failure) return say(state.failure, true);
      if (!state.doing) {
        const isFirst = !look.scene;
        look.scene = state;
        isLost = false;
        if (isFirst) document.dispatchEvent(new Event('loaded'));
        say('the first picture (compiles kernels the first time) ...');
        return changed();
      }
      say(`${state.doing} ... ${((performance.now() - began) / 1000).toFixed(0)} s`);
      await new Promise(resolve => setTimeout(resolve, 100));
    }
  } catch (error) {
    if (error.status === undefined) lost();
    else say(error.message, true);
  }
}

new ResizeObserver(() => look.scene && changed()).observe(stage);
