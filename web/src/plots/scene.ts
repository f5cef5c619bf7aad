import type { Scene } from '../document';
import { h, icon, svg } from '../dom';
import { format_number, with_unit } from '../numbers';
import { palette, type Palette } from '../theme';
import { lower_bound } from './gaps';
import { blank, fill, stroke } from './picture';
import { bounds, kFirstView, seen, turned, type Stroke, type View } from './space';
import type { DrawnFigure } from './time_series';
import { zoom_group } from './zoom';

const kWidth = 480;
/** Turn of the view by a pixel of the pointer's way, and by a key [rad]. */
const kByPixel = 0.008;
const kByKey = Math.PI / 18;
const kPlay = 'M8 5.5v13l10.5-6.5z';
const kPause = 'M8 5.5v13M16 5.5v13';

let scenes = 0;

/** What the joints are at a moment, on straight lines between samples. */
function values_at(scene: Scene, motion: number, at: number): number[] {
  const { samples } = scene;
  const k = Math.min(samples.length - 1, Math.max(1, lower_bound(samples, at)));
  const from = samples[k - 1] ?? 0;
  const to = samples[k] ?? from;
  const share = to > from ? Math.min(1, Math.max(0, (at - from) / (to - from))) : 0;
  return (scene.motions[motion]?.values ?? []).map((values) => {
    const low = values[k - 1] ?? values[0] ?? 0;
    return low + share * ((values[k] ?? low) - low);
  });
}

type Looks = (each: Stroke) => Record<string, string | number>;

/** The looks on the page: the style sheet colours them, in both themes and on paper. */
const on_page: Looks = (each) => ({ class: `scene-${each.kind} ${each.tone}`, ...(each.kind === 'line' ? { 'stroke-width': each.size } : {}) });

/** The same in plain colours, for a picture that stands alone. */
function plain(colours: Palette): Looks {
  const tones = { ground: colours.soft_ink, body: colours.lines[0] ?? colours.ink, link: colours.measured, person: colours.lines[1] ?? colours.ink, outline: colours.soft_ink };
  return (each) => {
    const colour = tones[each.tone];
    if (each.kind === 'label') return { ...fill(colours.soft_ink), 'text-anchor': 'middle' };
    if (each.kind === 'ball') return fill(colour);
    if (each.kind === 'face') return { ...fill(colour), 'fill-opacity': each.tone === 'ground' ? 0.08 : 0.55, stroke: colour, 'stroke-width': 1 };
    return { ...stroke(colour, each.size), 'stroke-linecap': 'round', 'stroke-linejoin': 'round', ...(each.tone === 'outline' ? { 'stroke-dasharray': '5 4' } : {}) };
  };
}

function element_of(each: Stroke, looks: Looks): SVGElement {
  const points = each.points.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(' ');
  const [x = 0, y = 0] = each.points[0] ?? [];
  const attributes = looks(each);
  if (each.kind === 'face') return svg('polygon', { points, ...attributes });
  if (each.kind === 'line') return svg('polyline', { points, ...attributes });
  if (each.kind === 'ball') return svg('circle', { cx: x.toFixed(1), cy: y.toFixed(1), r: each.size.toFixed(1), ...attributes });
  return svg('text', { x: x.toFixed(1), y: y.toFixed(1), ...attributes }, each.text);
}

/** Turns the view by the pointer (a finger drawn up and down scrolls the page) and by the arrow keys. */
function follow_view(drawing: SVGSVGElement, turn: (azimuth: number, elevation: number) => void, reset: () => void): void {
  let last: [number, number] | null = null;
  drawing.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    drawing.setPointerCapture(event.pointerId);
    last = [event.clientX, event.clientY];
  });
  drawing.addEventListener('pointermove', (event) => {
    if (!last) return;
    turn((last[0] - event.clientX) * kByPixel, (event.clientY - last[1]) * kByPixel);
    last = [event.clientX, event.clientY];
  });
  for (const end of ['pointerup', 'pointercancel'] as const) drawing.addEventListener(end, () => (last = null));
  drawing.addEventListener('dblclick', reset);
  const keys: Record<string, [number, number]> = { ArrowLeft: [kByKey, 0], ArrowRight: [-kByKey, 0], ArrowUp: [0, kByKey], ArrowDown: [0, -kByKey] };
  drawing.addEventListener('keydown', (event) => {
    const by = keys[event.key];
    if (by) turn(...by);
    else if (event.key === 'Home') reset();
    else return;
    event.preventDefault();
  });
}

/** Lets a clock run from `from()` to an end, as fast as the world's. */
class Player {
  private frame = 0;
  readonly button = h('button', { type: 'button', class: 'play', click: () => (this.playing ? this.stop() : this.start()) });

  constructor(
    private readonly begin: () => number,
    private readonly end: () => number,
    private readonly show: (at: number) => void,
  ) {
    this.draw();
  }

  get playing(): boolean {
    return this.frame !== 0;
  }

  start(): void {
    let at = this.begin();
    let before: number | null = null;
    const tick = (now: number) => {
      at += before === null ? 0 : (now - before) / 1000;
      before = now;
      const end = this.end();
      this.show(Math.min(at, end));
      if (at >= end) return this.stop();
      this.frame = requestAnimationFrame(tick);
    };
    this.frame = requestAnimationFrame(tick);
    this.draw();
  }

  stop(): void {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.draw();
  }

  private draw(): void {
    this.button.replaceChildren(icon(this.playing ? kPause : kPlay));
    this.button.title = this.playing ? 'Pause' : 'Play';
    this.button.setAttribute('aria-label', this.button.title);
  }
}

/** Number, unit and name of every joint; as many decimals for all moments. */
function readings(scene: Scene): { element: HTMLElement; show: (values: number[]) => void } {
  const outputs = scene.joints.map(() => h('dd', {}));
  const decimals = scene.joints.map((_, k) => {
    let most = 0;
    for (const motion of scene.motions) for (const value of motion.values[k] ?? []) most = Math.max(most, Math.abs(value ?? 0));
    return most > 0 ? Math.min(2, Math.max(0, 2 - Math.floor(Math.log10(most)))) : 1;
  });
  return {
    element: h('dl', { class: 'scene-values' }, ...scene.joints.map((joint, k) => h('div', {}, h('dt', {}, with_unit(joint.name, joint.unit)), outputs[k]))),
    show: (values) => outputs.forEach((output, k) => (output.textContent = (values[k] ?? 0).toFixed(decimals[k]).replace(/^-(?=[0.]*$)/, '').replace('-', '\u2212'))),
  };
}

function motion_choice(scene: Scene, id: string, choose: (motion: number) => void): HTMLElement | null {
  if (scene.motions.length < 2) return null;
  const select: HTMLSelectElement = h('select', { id, change: () => choose(select.selectedIndex) }, ...scene.motions.map((motion) => h('option', {}, motion.name)));
  return h('div', { class: 'scene-choice' }, h('label', { for: id }, scene.choice), select);
}

/** A drawing in space with a slider of time, which is marked in the figures over the same time. */
export function draw_scene(scene: Scene): DrawnFigure {
  const first = scene.samples[0] ?? 0;
  const last = scene.samples[scene.samples.length - 1] ?? first;
  const group = zoom_group(scene.axis);
  const extent = bounds(scene);
  let view: View = kFirstView;
  let motion = 0;
  let at = first;

  const drawing = svg('svg', { viewBox: `0 0 ${kWidth} ${scene.height}`, class: 'scene-drawing', tabindex: 0, role: 'img', 'aria-label': `${scene.title}. Drag, or use the arrow keys, to turn the view.` });
  const strokes = () => seen(scene, values_at(scene, motion, at), view, extent, kWidth, scene.height);
  const values = readings(scene);
  const clock = h('output', { class: 'scene-clock' });
  const draw = () => {
    drawing.replaceChildren(...strokes().map((each) => element_of(each, on_page)));
    values.show(values_at(scene, motion, at));
  };
  const slider: HTMLInputElement = h('input', { type: 'range', min: first, max: last, step: 'any', value: first, 'aria-label': with_unit(scene.x.label, scene.x.unit) });
  const show = (moment: number) => {
    at = Math.min(last, Math.max(first, moment));
    slider.value = String(at);
    clock.textContent = `${format_number(at, at < 10 ? 3 : at < 100 ? 4 : 5)} ${scene.x.unit}`;
    slider.setAttribute('aria-valuetext', clock.textContent);
    draw();
  };
  const go = (moment: number) => {
    show(moment);
    group.mark(at);
  };
  // What is zoomed in is played, from the start again once it has come to its end.
  const stretch = (): [number, number] => [Math.max(first, group.window[0]), Math.min(last, group.window[1])];
  const player = new Player(() => (at >= stretch()[0] && at < stretch()[1] - 1e-3 ? at : stretch()[0]), () => stretch()[1], go);
  slider.addEventListener('input', () => {
    player.stop();
    go(Number(slider.value));
  });
  slider.addEventListener('keydown', (event) => {
    const step = (last - first) / (event.shiftKey ? 20 : 200);
    const by = { ArrowRight: step, ArrowUp: step, ArrowLeft: -step, ArrowDown: -step }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    player.stop();
    go(at + by);
  });
  group.on_point((moment) => {
    if (!player.playing) go(moment);
  });
  follow_view(
    drawing,
    (azimuth, elevation) => {
      view = turned(view, azimuth, elevation);
      draw();
    },
    () => {
      view = kFirstView;
      draw();
    },
  );
  if (scene.samples.length > 0) group.extend(first, last);
  show(first);
  const choice = motion_choice(scene, `scene-motion-${++scenes}`, (chosen) => {
    motion = chosen;
    draw();
  });
  const element = h('div', { class: 'scene' }, choice, drawing, values.element, h('div', { class: 'scene-controls' }, player.button, slider, clock));
  const picture = () => {
    const made = blank(kWidth, scene.height);
    made.append(...strokes().map((each) => element_of(each, plain(palette()))));
    return made;
  };
  return { element, picture };
}
