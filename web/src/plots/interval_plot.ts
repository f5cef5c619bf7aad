import type { Estimate, IntervalPlot } from '../document';
import { h, svg } from '../dom';
import { format_number, format_ticks, nice_ticks } from '../numbers';
import { status_label } from '../status';

type Row = IntervalPlot['rows'][number];

const kTrack = 15;
const kAxis = 20;
const kTop = 5;

// Shapes tell the methods apart where colours do not.
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

function finite(values: (number | null)[]): number[] {
  return values.filter((value): value is number => value !== null && Number.isFinite(value));
}

function range_of(rows: Row[]): [number, number] {
  const estimates = rows.flatMap((row) => row.estimates);
  const centre = finite([...estimates.map((each) => each.value), ...rows.map((row) => row.reference)]);
  const ends = finite(estimates.flatMap((each) => [each.low, each.high]));
  let low = Math.min(...centre, ...ends);
  let high = Math.max(...centre, ...ends);
  if (!(low <= high)) return [0, 1];
  // A method that failed has an interval that hides all others: cut it (an arrow shows that it goes on).
  const widths = estimates.map((each) => (each.high ?? NaN) - (each.low ?? NaN)).filter((width) => width >= 0).sort((a, b) => a - b);
  const typical = widths[(widths.length - 1) >> 1] ?? 0;
  if (typical > 0 && centre.length > 0) {
    low = Math.max(low, Math.min(...centre) - 3 * typical);
    high = Math.min(high, Math.max(...centre) + 3 * typical);
  }
  const margin = high > low ? 0.05 * (high - low) : Math.max(1e-6, 0.1 * Math.abs(high));
  return [low - margin, high + margin];
}

function describe(plot: IntervalPlot, row: Row, each: Estimate): string {
  const status = each.status === '' ? '' : ` (${status_label(each.status)})`;
  return `${plot.methods[each.method] ?? ''}: ${row.name} = ${format_number(each.value)} ${row.unit}, 95 % from ${format_number(each.low)} to ${format_number(each.high)}${status}`;
}

function draw_row(plot: IntervalPlot, row: Row, range: [number, number], width: number, left: number): SVGSVGElement {
  const tracks = plot.methods.length;
  const height = kTop + tracks * kTrack + kAxis;
  const right = width - 14;
  const x = (value: number) => left + ((value - range[0]) / (range[1] - range[0])) * (right - left);
  const picture = svg('svg', { width, height, viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': row.estimates.map((each) => describe(plot, row, each)).join('; ') });
  const { ticks, step } = nice_ticks(range[0], range[1], Math.max(2, Math.min(6, (right - left) / 90)));
  const labels = format_ticks(ticks, step);
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
    if (each.value === null) continue;
    const y = kTop + (each.method + 0.5) * kTrack;
    const group = svg('g', { class: `estimate line-${(each.method % 6) + 1}${each.status === 'rejected' || each.status === 'not_excited' ? ' hollow' : ''}` }, svg('title', {}, describe(plot, row, each)));
    if (each.low !== null && each.high !== null) {
      const from = Math.max(left, x(each.low));
      const to = Math.min(right, x(each.high));
      group.append(svg('line', { class: 'whisker', x1: from, x2: to, y1: y, y2: y }));
      if (x(each.low) >= left) group.append(svg('line', { class: 'cap', x1: from, x2: from, y1: y - 4, y2: y + 4 }));
      else group.append(svg('path', { class: 'arrow', d: `M${left + 5} ${y - 4}L${left} ${y}L${left + 5} ${y + 4}` }));
      if (x(each.high) <= right) group.append(svg('line', { class: 'cap', x1: to, x2: to, y1: y - 4, y2: y + 4 }));
      else group.append(svg('path', { class: 'arrow', d: `M${right - 5} ${y - 4}L${right} ${y}L${right - 5} ${y + 4}` }));
    }
    const at = x(each.value);
    if (at >= left && at <= right) group.append(marker(each.method, at, y));
    picture.append(group);
  }
  return picture;
}

/** Estimates of several methods with their intervals, a row per parameter, each row with its own scale unless shared. */
export function draw_interval_plot(plot: IntervalPlot): HTMLElement {
  const list = h('div', { class: 'interval-rows' });
  const shared = plot.shared_scale ? range_of(plot.rows) : null;
  const rows = plot.rows.map((row) => {
    const host = h('div', { class: 'interval-picture' });
    list.append(
      h('div', { class: 'interval-row' }, h('div', { class: 'interval-name' }, h('span', {}, row.name), row.unit === '' ? null : h('small', {}, `[${row.unit}]`)), host),
    );
    return { row, host, range: shared ?? range_of([row]) };
  });
  let drawn = 0;
  const draw = () => {
    const width = rows[0] ? Math.floor(rows[0].host.clientWidth) : 0;
    if (width <= 0 || width === drawn) return;
    drawn = width;
    for (const { row, host, range } of rows) host.replaceChildren(draw_row(plot, row, range, width, 6));
  };
  new ResizeObserver(draw).observe(list);
  const legend = h(
    'ul',
    { class: 'legend' },
    ...plot.methods.map((method, k) => {
      const key = svg('svg', { width: 22, height: 12, viewBox: '0 0 22 12', 'aria-hidden': 'true' }, svg('g', { class: `estimate line-${(k % 6) + 1}` }, svg('line', { class: 'whisker', x1: 1, x2: 21, y1: 6, y2: 6 }), marker(k, 11, 6)));
      return h('li', {}, key, h('span', { class: 'name' }, method));
    }),
    plot.rows.some((row) => row.reference !== null)
      ? h('li', {}, h('span', { class: 'swatch reference-key', 'aria-hidden': 'true' }), h('span', { class: 'name' }, plot.reference))
      : null,
  );
  return h('div', { class: 'intervals' }, h('div', { class: 'panel-head' }, legend), list);
}
