import type { Band, Line, Panel, Samples, TimeSeries } from '../document';
import { h } from '../dom';
import { format_number, with_unit } from '../numbers';
import { palette } from '../theme';
import { axis, clipped, Looks, mount, translucent, uPlot, y_axis_size, type LineLook } from './frame';
import { follow_touch, zoom_group, type ZoomGroup } from './zoom';

// In a joined table, a gap of one line stays a gap where only other lines have samples (uPlot's JoinNullMode.Expand).
const kExpand = 2 as uPlot.JoinNullMode;

interface Drawn {
  line: Line;
  x: number[];
  band?: Band & { at: number[] };
  look: LineLook;
}

/** Index of the first abscissa not below `value`. */
function lower_bound(x: number[], value: number): number {
  let low = 0;
  let high = x.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((x[middle] as number) < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

function nearest(x: number[], value: number): number {
  const after = lower_bound(x, value);
  if (after === 0) return 0;
  if (after === x.length) return after - 1;
  return value - (x[after - 1] as number) < (x[after] as number) - value ? after - 1 : after;
}

function extremes(x: number[], values: Samples[], from: number, to: number): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  // One sample more on either side: lines enter and leave the window.
  const first = Math.max(0, lower_bound(x, from) - 1);
  const last = Math.min(x.length, lower_bound(x, to) + 1);
  for (const series of values) {
    for (let k = first; k < last; ++k) {
      const value = series[k];
      if (value === null || value === undefined) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}

/** Half the median width of a band in a window: what is typical, whatever the first seconds of a filter look like. */
function typical_half_width(band: Band & { at: number[] }, from: number, to: number): number {
  const widths: number[] = [];
  for (let k = lower_bound(band.at, from); k < band.at.length && (band.at[k] as number) <= to; ++k) {
    const low = band.low[k];
    const high = band.high[k];
    if (low !== null && low !== undefined && high !== null && high !== undefined) widths.push((high - low) / 2);
  }
  widths.sort((a, b) => a - b);
  return widths[widths.length >> 1] ?? 0;
}

/** Range of the ordinate for what is in sight: the lines entirely, the bands unless they would flatten the lines. */
function y_range(drawn: Drawn[], from: number, to: number): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  for (const { line, x } of drawn) {
    const [a, b] = extremes(x, [line.y], from, to);
    low = Math.min(low, a);
    high = Math.max(high, b);
  }
  let band_low = Infinity;
  let band_high = -Infinity;
  let typical = 0;
  for (const { band } of drawn) {
    if (!band) continue;
    const [a, b] = extremes(band.at, [band.low, band.high], from, to);
    band_low = Math.min(band_low, a);
    band_high = Math.max(band_high, b);
    typical = Math.max(typical, typical_half_width(band, from, to));
  }
  if (!(low <= high)) [low, high] = band_low <= band_high ? [band_low, band_high] : [0, 1];
  const allowed = Math.max(0.6 * (high - low), 3 * typical);
  const bottom = Math.max(Math.min(low, band_low), low - allowed);
  const top = Math.min(Math.max(high, band_high), high + allowed);
  const margin = top > bottom ? 0.06 * (top - bottom) : Math.max(1e-3, 0.05 * Math.abs(top));
  return [bottom - margin, top + margin];
}

function draw_spans(plot: uPlot, figure: TimeSeries, with_labels: boolean): void {
  const colours = palette();
  clipped(plot, (context) => {
    const { bbox } = plot;
    for (const span of figure.spans) {
      const left = Math.max(bbox.left, plot.valToPos(span.from, 'x', true));
      const right = Math.min(bbox.left + bbox.width, plot.valToPos(span.to, 'x', true));
      if (!(right > left)) continue;
      context.fillStyle = colours.spans[span.tone];
      context.fillRect(left, bbox.top, right - left, bbox.height);
      if (!with_labels || span.label === '') continue;
      context.font = `600 ${Math.round(10.5 * uPlot.pxRatio)}px system-ui, sans-serif`;
      context.fillStyle = colours.soft_ink;
      context.textBaseline = 'top';
      context.textAlign = 'left';
      const pad = 5 * uPlot.pxRatio;
      if (context.measureText(span.label).width + 2 * pad < right - left) context.fillText(span.label, left + pad, bbox.top + pad);
    }
  });
}

function draw_band(plot: uPlot, band: Band & { at: number[] }, colour: string): void {
  const from = plot.scales.x?.min ?? 0;
  const to = plot.scales.x?.max ?? 1;
  const first = Math.max(0, lower_bound(band.at, from) - 1);
  const last = Math.min(band.at.length, lower_bound(band.at, to) + 1);
  clipped(plot, (context) => {
    context.fillStyle = translucent(colour, 24);
    let piece: [number, number, number][] = [];
    const flush = () => {
      if (piece.length > 1) {
        context.beginPath();
        piece.forEach(([x, , high], k) => (k === 0 ? context.moveTo(x, high) : context.lineTo(x, high)));
        for (let k = piece.length - 1; k >= 0; --k) context.lineTo((piece[k] as number[])[0] as number, (piece[k] as number[])[1] as number);
        context.closePath();
        context.fill();
      }
      piece = [];
    };
    for (let k = first; k < last; ++k) {
      const low = band.low[k];
      const high = band.high[k];
      if (low === null || low === undefined || high === null || high === undefined) flush();
      else piece.push([plot.valToPos(band.at[k] as number, 'x', true), plot.valToPos(low, 'y', true), plot.valToPos(high, 'y', true)]);
    }
    flush();
  });
}

function swatch(look: LineLook, style: Line['style'], has_band: boolean): HTMLElement {
  const index = Math.max(-1, palette().lines.indexOf(look.colour(palette())));
  const name = index >= 0 ? `--line-${index + 1}` : look.dash.length > 0 ? '--reference' : '--measured';
  const kind = style === 'markers' ? 'dots' : look.dash.length > 0 ? 'dashed' : 'solid';
  return h('span', { class: `swatch ${kind}${has_band ? ' banded' : ''}`, style: `--colour: var(${name})`, 'aria-hidden': 'true' });
}

function draw_panel(figure: TimeSeries, panel: Panel, looks: Looks, group: ZoomGroup, last: boolean, first: boolean, clock: HTMLElement): HTMLElement {
  const drawn: Drawn[] = panel.lines.map((line) => {
    const entry: Drawn = { line, x: figure.xs[line.x] ?? [], look: looks.of(line.name, line.role) };
    if (line.band) entry.band = { ...line.band, at: figure.xs[line.band.x] ?? [] };
    return entry;
  });
  const values = drawn.map(() => h('span', { class: 'value' }));
  const legend = h(
    'ul',
    { class: 'legend' },
    ...drawn.map((each, k) =>
      h(
        'li',
        {},
        swatch(each.look, each.line.style, each.band !== undefined),
        h('span', { class: 'name' }, each.line.name),
        values[k],
      ),
    ),
  );
  const host = h('div', { class: 'plot' });
  const element = h('div', { class: 'panel' }, h('div', { class: 'panel-head' }, h('span', { class: 'panel-label' }, with_unit(panel.label, panel.unit)), legend), host);

  const read = (at: number | null) => {
    drawn.forEach(({ line, x, band }, k) => {
      const node = values[k] as HTMLElement;
      let text = '';
      if (at !== null && x.length > 0) {
        const index = nearest(x, at);
        const value = line.y[index];
        text = format_number(value);
        if (band && value !== null && value !== undefined) {
          const other = nearest(band.at, at);
          const low = band.low[other];
          const high = band.high[other];
          if (low !== null && low !== undefined && high !== null && high !== undefined) text += ` ± ${format_number((high - low) / 2, 2)}`;
        }
      }
      node.textContent = text;
    });
    clock.textContent = at === null ? '' : `${figure.x.label} ${format_number(at, 6)} ${figure.x.unit}`;
  };

  queueMicrotask(() => {
    const tables = drawn.map(({ line, x }) => [x, line.y] as uPlot.AlignedData);
    const same = drawn.every(({ x }) => x === drawn[0]?.x);
    const data = same
      ? ([drawn[0]?.x ?? [], ...drawn.map(({ line }) => line.y)] as uPlot.AlignedData)
      : uPlot.join(tables, tables.map(() => [kExpand, kExpand]));
    const options = (width: number, height: number): uPlot.Options => ({
      width,
      height,
      legend: { show: false },
      padding: [6, 10, last ? 0 : 4, 0],
      scales: {
        x: { time: false, range: (_plot, min, max) => (min === null || max === null ? group.full() : [min, max]), min: group.full()[0], max: group.full()[1] },
        y: { range: () => y_range(drawn, ...group.window) },
      },
      axes: [axis('x', { size: last ? 26 : 4, labels: last }), axis('y', { size: y_axis_size(width) })],
      series: [
        {},
        ...drawn.map(
          ({ line, look }): uPlot.Series => ({
            label: line.name,
            stroke: () => look.colour(palette()),
            width: look.width,
            dash: look.dash,
            ...(line.style === 'markers' ? { paths: () => null } : {}),
            points: { show: line.style === 'markers', size: 4.5, width: 0, fill: () => look.colour(palette()) },
          }),
        ),
      ],
      cursor: {
        y: false,
        points: { size: 6, width: 0 },
        drag: { x: true, y: false, setScale: false },
        sync: { key: `time/${figure.axis}`, setSeries: false, scales: ['x', null] },
        bind: {
          dblclick: () => () => {
            group.reset();
            return null;
          },
        },
      },
      hooks: {
        drawAxes: [
          (plot) => {
            draw_spans(plot, figure, first);
            for (const { band, look } of drawn) if (band) draw_band(plot, band, look.colour(palette()));
          },
        ],
        setSelect: [
          (plot) => {
            const { left, width: selected } = plot.select;
            // The selection shows in all linked plots; only the one under the pointer zooms.
            if (group.grasped === plot && selected > 4) group.zoom(plot.posToVal(left, 'x'), plot.posToVal(left + selected, 'x'));
            plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          },
        ],
        setCursor: [
          (plot) => {
            const left = plot.cursor.left ?? -1;
            read(left >= 0 ? plot.posToVal(left, 'x') : null);
          },
        ],
      },
    });
    const plot = mount(host, () => panel.height + (last ? 22 : 0), (width, height) => new uPlot(options(width, height), data, host));
    group.add(plot);
    follow_touch(plot);
    (host as HTMLElement & { uplot?: uPlot }).uplot = plot;
  });
  return element;
}

/** What the shaded spans are, also where they are too narrow for their label. */
function span_key(figure: TimeSeries): HTMLElement | null {
  const tones = new Map(figure.spans.filter((span) => span.label !== '').map((span) => [span.label, span.tone]));
  if (tones.size === 0) return null;
  return h(
    'ul',
    { class: 'legend' },
    ...[...tones].map(([label, tone]) => h('li', {}, h('span', { class: `patch ${tone}`, 'aria-hidden': 'true' }), h('span', { class: 'name' }, label))),
  );
}

/** Panels above each other over one abscissa, with uncertainty bands, shaded spans, and zoom linked through the page. */
export function draw_time_series(figure: TimeSeries): HTMLElement {
  const group = zoom_group(figure.axis);
  for (const x of figure.xs) if (x.length > 0) group.extend(x[0] as number, x[x.length - 1] as number);
  for (const span of figure.spans) group.extend(span.from, span.to);
  const looks = new Looks();
  const clock = h('span', { class: 'clock' });
  return h(
    'div',
    { class: figure.panels.length > 3 ? 'time-series tall' : 'time-series', 'data-axis': figure.axis },
    ...figure.panels.map((panel, k) => draw_panel(figure, panel, looks, group, k === figure.panels.length - 1, k === 0, clock)),
    h('div', { class: 'abscissa' }, h('span', {}, with_unit(figure.x.label, figure.x.unit)), span_key(figure), clock),
  );
}

export { swatch };
