import type { Estimate, IntervalPlot } from '../document';
import { h, svg } from '../dom';
import { format_number, format_ticks, nice_ticks, with_unit } from '../numbers';
import { status_label } from '../status';
import { palette } from '../theme';
import { text_width } from './frame';
import { range_button } from './legend';
import { blank } from './picture';
import type { DrawnFigure } from './time_series';

type Row = IntervalPlot['rows'][number];

const kTrack = 15;
const kAxis = 20;
const kTop = 5;
/** Least room at either end of a row [CSS px]. */
const kSide = 10;

// Shapes distinguish the methods where colours do not.
const kMarkers = ['circle', 'square', 'diamond', 'triangle'] as const;

function marker(method: number, x: number, y: number): SVGElement {
  const shape = kMarkers[method % kMarkers.length];
  const r = 4;
  if (shape === 'circle') return svg('circle', { cx: x, cy: y, r });
  if (shape === 'square') return svg('rect', { x: x - r + 0.5, y: y - r + 0.5, width: 2 * r - 1, height: 2 * r - 1 });
  const path =
    shape === 'diamond'
      ? `M${x} ${y - r - 1}L${x + r + 1} ${y}L${x} ${y + r + 1}L${x - r - 1} ${y}Z`
      : `M${x} ${y - r - 0.5}L${x + r + 0.5} ${y + r - 0.5}L${x - r - 0.5} ${y + r - 0.5}Z`;
  return svg('path', { d: path });
}

/** A name that may go on in a new line after an underscore. */
function breakable(name: string): (string | Node)[] {
  return name.split(/(?<=_)/).flatMap((part) => [part, h('wbr')]);
}

function finite(values: (number | null)[]): number[] {
  return values.filter((value): value is number => value !== null && Number.isFinite(value));
}

/** The value in the middle of those sorted. */
function median(values: number[]): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[(sorted.length - 1) >> 1] ?? 0;
}

/** A value further than this many typical widths and spreads from the middle of a row has failed: it sets no scale. */
const kFar = 8;

/** Range of some rows, and whether an estimate lies outside it. */
function range_of(rows: Row[], everything: boolean): { range: [number, number]; leaves: boolean } {
  const estimates = rows.flatMap((row) => row.estimates);
  const centres = finite([...estimates.map((each) => each.value), ...rows.map((row) => row.reference)]);
  const ends = finite(estimates.flatMap((each) => [each.low, each.high]));
  if (centres.length + ends.length === 0) return { range: [0, 1], leaves: false };
  const widths = estimates.map((each) => (each.high ?? NaN) - (each.low ?? NaN)).filter((width) => width >= 0);
  const typical = median(widths);
  const middle = median(centres);
  const spread = Math.max(typical, median(centres.map((each) => Math.abs(each - middle))));
  const near = everything || rows.length > 1 || !(spread > 0) ? centres : centres.filter((each) => Math.abs(each - middle) <= kFar * spread);
  let low = Math.min(...near, ...ends);
  let high = Math.max(...near, ...ends);
  // A method that failed has an interval that hides all others: cut it (an arrow shows that it goes on).
  if (!everything && typical > 0 && near.length > 0) {
    low = Math.max(low, Math.min(...near) - 3 * typical);
    high = Math.min(high, Math.max(...near) + 3 * typical);
  }
  const margin = high > low ? 0.05 * (high - low) : Math.max(1e-6, 0.1 * Math.abs(high));
  return { range: [low - margin, high + margin], leaves: near.length < centres.length || ends.some((each) => each < low || each > high) };
}

function describe(plot: IntervalPlot, row: Row, each: Estimate): string {
  const status = each.status === '' ? '' : ` (${status_label(each.status)})`;
  return `${plot.methods[each.method] ?? ''}: ${row.name} = ${format_number(each.value)} ${row.unit}, 95 % from ${format_number(each.low)} to ${format_number(each.high)}${status}`;
}

function draw_row(plot: IntervalPlot, row: Row, range: [number, number], width: number, hidden: Set<number>): SVGSVGElement {
  const tracks = plot.methods.length;
  const height = kTop + tracks * kTrack + kAxis;
  const { ticks, step } = nice_ticks(range[0], range[1], Math.max(2, Math.min(6, (width - 2 * kSide) / 90)));
  const labels = format_ticks(ticks, step);
  // Half a label stands beyond either end.
  const side = Math.max(kSide, ...labels.map((label) => Math.ceil(0.5 * text_width(label)) + 1));
  const left = side;
  const right = width - side;
  const x = (value: number) => left + ((value - range[0]) / (range[1] - range[0])) * (right - left);
  const picture = svg('svg', { width, height, viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': row.estimates.map((each) => describe(plot, row, each)).join('; ') });
  const bottom = kTop + tracks * kTrack;
  ticks.forEach((tick, k) => {
    picture.append(svg('line', { class: tick === 0 || Math.abs(tick) < step * 1e-6 ? 'zero' : 'grid', x1: x(tick), x2: x(tick), y1: 0, y2: bottom }));
    picture.append(svg('text', { class: 'tick', x: x(tick), y: bottom + 14, 'text-anchor': 'middle' }, labels[k]));
  });
  if (row.reference !== null) {
    const at = x(row.reference);
    picture.append(svg('line', { class: 'reference', x1: at, x2: at, y1: 0, y2: bottom }));
  }
  for (const each of row.estimates) {
    if (each.value === null || hidden.has(each.method)) continue;
    const y = kTop + (each.method + 0.5) * kTrack;
    const group = svg('g', { class: `estimate line-${(each.method % 6) + 1}${each.status === 'rejected' || each.status === 'not_excited' ? ' hollow' : ''}` }, svg('title', {}, describe(plot, row, each)));
    if (each.low !== null && each.high !== null) {
      const from = Math.max(left, x(each.low));
      const to = Math.min(right, x(each.high));
      // An interval that lies outside entirely has its arrowhead alone.
      if (to >= from) group.append(svg('line', { class: 'whisker', x1: from, x2: to, y1: y, y2: y }));
      if (x(each.low) < left) group.append(svg('path', { class: 'arrow', d: `M${left + 5} ${y - 4}L${left} ${y}L${left + 5} ${y + 4}` }));
      else if (from <= right) group.append(svg('line', { class: 'cap', x1: from, x2: from, y1: y - 4, y2: y + 4 }));
      if (x(each.high) > right) group.append(svg('path', { class: 'arrow', d: `M${right - 5} ${y - 4}L${right} ${y}L${right - 5} ${y + 4}` }));
      else if (to >= left) group.append(svg('line', { class: 'cap', x1: to, x2: to, y1: y - 4, y2: y + 4 }));
    }
    const at = x(each.value);
    if (at >= left && at <= right) group.append(marker(each.method, at, y));
    else {
      const [edge, inward] = at < left ? [left, 6] : [right, -6];
      group.append(svg('path', { class: 'beyond', d: `M${edge} ${y}L${edge + inward} ${y - 4}L${edge + inward} ${y + 4}Z` }));
    }
    picture.append(group);
  }
  return picture;
}

/** The style sheet's rules for a picture that stands alone. */
function picture_rules(): string {
  const colours = palette();
  const lines = colours.lines.map((colour, k) => `.estimate.line-${k + 1}{stroke:${colour};fill:${colour}}`).join('');
  return `.grid{stroke:${colours.grid}}.zero{stroke:${colours.soft_ink}}.tick,.name{fill:${colours.soft_ink};font-size:11.5px}.reference{stroke:${colours.reference};stroke-width:1.6;stroke-dasharray:4 3}.estimate{stroke-width:1.8}${lines}.estimate.hollow{fill:${colours.surface}}.estimate .arrow{fill:none}`;
}

/** All rows with their names, and the key of the methods. */
function interval_picture(plot: IntervalPlot, hidden: Set<number>, ranges: [number, number][]): SVGSVGElement {
  const width = 960;
  const name_width = 190;
  const rows = plot.rows.map((row, k) => draw_row(plot, row, ranges[k] as [number, number], width - name_width, hidden));
  const height = rows.reduce((sum, each) => sum + Number(each.getAttribute('height')) + 6, 0) + 44;
  const picture = blank(width, height);
  picture.append(svg('style', {}, picture_rules()));
  let left = name_width;
  plot.methods.forEach((method, k) => {
    if (hidden.has(k)) return;
    picture.append(svg('g', { class: `estimate line-${(k % 6) + 1}` }, marker(k, left + 6, 20)), svg('text', { class: 'name', x: left + 16, y: 24 }, method));
    left += 40 + text_width(method);
  });
  let top = 36;
  rows.forEach((each, k) => {
    const row = plot.rows[k] as Row;
    picture.append(svg('text', { class: 'name', x: 14, y: top + 16 }, with_unit(row.name, row.unit)));
    each.setAttribute('x', String(name_width));
    each.setAttribute('y', String(top));
    picture.append(each);
    top += Number(each.getAttribute('height')) + 6;
  });
  return picture;
}

/** Estimates of several methods with their intervals, a row per parameter, each row with its own scale unless shared. */
export function draw_interval_plot(plot: IntervalPlot): DrawnFigure {
  const list = h('div', { class: 'interval-rows' });
  const hidden = new Set<number>();
  const everything = range_button(() => draw(true));
  const visible = (row: Row): Row => ({ ...row, estimates: row.estimates.filter((each) => !hidden.has(each.method)) });
  const hosts = plot.rows.map((row) => {
    const host = h('div', { class: 'interval-picture' });
    list.append(
      h('div', { class: 'interval-row' }, h('div', { class: 'interval-name' }, h('span', {}, ...breakable(row.name)), row.unit === '' ? null : h('small', {}, `[${row.unit}]`)), host),
    );
    return host;
  });
  const ranges = () => {
    const shared = plot.shared_scale ? range_of(plot.rows.map(visible), everything.pressed()) : null;
    const each = plot.rows.map((row) => shared ?? range_of([visible(row)], everything.pressed()));
    everything.offer(each.some(({ leaves }) => leaves));
    return each.map(({ range }) => range);
  };
  let drawn = 0;
  const draw = (again: boolean) => {
    const width = hosts[0] ? Math.floor(hosts[0].clientWidth) : 0;
    if (width <= 0 || (width === drawn && !again)) return;
    drawn = width;
    const all = ranges();
    plot.rows.forEach((row, k) => hosts[k]?.replaceChildren(draw_row(plot, row, all[k] as [number, number], width, hidden)));
  };
  new ResizeObserver(() => draw(false)).observe(list);
  const method_entry = (method: string, k: number) => {
    const key = svg('svg', { width: 22, height: 12, viewBox: '0 0 22 12', 'aria-hidden': 'true' }, svg('g', { class: `estimate line-${(k % 6) + 1}` }, svg('line', { class: 'whisker', x1: 1, x2: 21, y1: 6, y2: 6 }), marker(k, 11, 6)));
    const button = h(
      'button',
      {
        type: 'button',
        class: 'switch',
        'aria-pressed': 'true',
        title: 'Show or hide',
        click: () => {
          if (!hidden.delete(k)) hidden.add(k);
          button.setAttribute('aria-pressed', String(!hidden.has(k)));
          draw(true);
        },
      },
      key,
      h('span', { class: 'name' }, method),
    );
    return h('li', {}, button);
  };
  const legend = h(
    'ul',
    { class: 'legend' },
    ...plot.methods.map(method_entry),
    plot.rows.some((row) => row.reference !== null)
      ? h('li', {}, h('span', { class: 'swatch reference-key', 'aria-hidden': 'true' }), h('span', { class: 'name' }, plot.reference))
      : null,
  );
  return {
    element: h('div', { class: 'intervals' }, h('div', { class: 'panel-head' }, everything.element, legend), list),
    picture: () => interval_picture(plot, hidden, ranges()),
  };
}
