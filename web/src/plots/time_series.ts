import type { Band, Panel, TimeSeries } from '../document';
import { h } from '../dom';
import { format_number, with_unit } from '../numbers';
import { palette } from '../theme';
import { axis, clipped, Looks, mount, OrdinateWidth, translucent, uPlot } from './frame';
import { lower_bound, median_spacing, sample_at, with_gaps } from './gaps';
import { legend_entry, range_button, SeriesSwitch } from './legend';
import { in_rows } from './label_rows';
import { ordinate_of, type Drawn, type Ordinate } from './ordinate';
import { stacked, time_series_picture, type PanelPicture } from './picture';
import { window_rows, type WindowAxis } from './windows';
import { follow_touch, zoom_group, type PanelView, type ZoomGroup } from './zoom';

// In a joined table, a gap of one line stays a gap where only other lines have samples (uPlot's JoinNullMode.Expand).
const kExpand = 2 as uPlot.JoinNullMode;
/** A selection thinner than this in one direction zooms in the other only [CSS px]. */
const kThinSelection = 30;
/** Room for half a label of the abscissa at its right end [CSS px]. */
const kRightPadding = 14;

/** What the panels of a figure share. */
interface Shared {
  figure: TimeSeries;
  looks: Looks;
  group: ZoomGroup;
  ordinates: OrdinateWidth;
  shown: SeriesSwitch;
  clock: HTMLElement;
  windows: WindowAxis | null;
  /** How each panel looks now, for its picture. */
  pictures: (() => PanelPicture)[];
}

function draw_spans(plot: uPlot, figure: TimeSeries, with_labels: boolean): void {
  const colours = palette();
  clipped(plot, (context) => {
    const { bbox } = plot;
    const pad = 5 * uPlot.pxRatio;
    const row_height = 13 * uPlot.pxRatio;
    context.font = `600 ${Math.round(10.5 * uPlot.pxRatio)}px system-ui, sans-serif`;
    context.textBaseline = 'top';
    context.textAlign = 'left';
    const labels: { label: string; left: number; width: number }[] = [];
    for (const span of figure.spans) {
      const left = Math.max(bbox.left, plot.valToPos(span.from, 'x', true));
      const right = Math.min(bbox.left + bbox.width, plot.valToPos(span.to, 'x', true));
      if (!(right > left)) continue;
      context.fillStyle = colours.spans[span.tone];
      context.fillRect(left, bbox.top, right - left, bbox.height);
      if (!with_labels || span.label === '') continue;
      const width = context.measureText(span.label).width + 2 * pad;
      if (width < right - left) labels.push({ label: span.label, left, width });
    }
    context.fillStyle = colours.soft_ink;
    for (const { label, left, row } of in_rows(labels)) {
      const top = pad + row * row_height;
      if (top + row_height < bbox.height) context.fillText(label, left + pad, bbox.top + top);
    }
  });
}

/** The seams between windows of a broken abscissa. */
function draw_breaks(plot: uPlot, windows: WindowAxis): void {
  clipped(plot, (context) => {
    const { bbox } = plot;
    context.fillStyle = palette().grid;
    for (const [from, to] of windows.breaks()) {
      const left = plot.valToPos(from, 'x', true);
      context.fillRect(left, bbox.top, plot.valToPos(to, 'x', true) - left, bbox.height);
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

/** Arrowheads along the edge beyond which a line goes on. */
function draw_beyond(plot: uPlot, { line, x, look }: Drawn): void {
  const low = plot.scales.y?.min ?? 0;
  const high = plot.scales.y?.max ?? 1;
  const ratio = uPlot.pxRatio;
  clipped(plot, (context) => {
    const { bbox } = plot;
    context.fillStyle = look.colour(palette());
    for (let left = bbox.left + 12 * ratio; left < bbox.left + bbox.width; left += 28 * ratio) {
      const value = line.y[Math.min(x.length - 1, lower_bound(x, plot.posToVal(left, 'x', true)))];
      if (value === null || value === undefined || (value >= low && value <= high)) continue;
      const edge = value > high ? bbox.top + ratio : bbox.top + bbox.height - ratio;
      const inside = edge + (value > high ? 7 : -7) * ratio;
      context.beginPath();
      context.moveTo(left, edge);
      context.lineTo(left - 4 * ratio, inside);
      context.lineTo(left + 4 * ratio, inside);
      context.fill();
    }
  });
}

/** The lines of a panel with their abscissae. */
function drawn_lines({ figure, looks }: Shared, panel: Panel): Drawn[] {
  return panel.lines.map((line) => {
    const x = figure.xs[line.x] ?? [];
    const entry: Drawn = { line, x, spacing: median_spacing(x), look: looks.of(line.name, line.role) };
    if (line.band) entry.band = { ...line.band, at: figure.xs[line.band.x] ?? [] };
    return entry;
  });
}

/** All lines over one sequence of abscissae, as uPlot takes them. */
function table_of(drawn: Drawn[]): uPlot.AlignedData {
  if (drawn.every(({ x }) => x === drawn[0]?.x)) return [drawn[0]?.x ?? [], ...drawn.map(({ line }) => line.y)] as uPlot.AlignedData;
  const tables = drawn.map(({ line, x }) => [x, line.y] as uPlot.AlignedData);
  return uPlot.join(tables, tables.map(() => [kExpand, kExpand]));
}

/** "12.3 ± 0.4"; a dash where there is no sample. */
function reading({ line, x, spacing, band }: Drawn, at: number): string {
  const index = sample_at(x, line.y, at, spacing);
  const value = index === null ? null : line.y[index];
  if (!band || index === null) return format_number(value);
  const k = sample_at(band.at, band.low, at, median_spacing(band.at));
  const low = k === null ? null : band.low[k];
  const high = k === null ? null : band.high[k];
  if (low === null || low === undefined || high === null || high === undefined) return format_number(value);
  return `${format_number(value)} ± ${format_number((high - low) / 2, 2)}`;
}

function series_options({ line, look }: Drawn): uPlot.Series {
  return {
    label: line.name,
    stroke: () => look.colour(palette()),
    width: look.width,
    dash: look.dash,
    ...(line.style === 'markers' ? { paths: () => null } : {}),
    points: { show: line.style === 'markers', size: 4.5, width: 0, fill: () => look.colour(palette()) },
  };
}

/** The sample of a joined table that the cursor marks on a line: none in a gap. */
function marked_sample(drawn: Drawn[]): (plot: uPlot, series: number, closest: number, at: number) => number | null {
  return (plot, series, closest, at) => {
    const each = drawn[series - 1];
    if (!each) return closest;
    const index = sample_at(each.x, each.line.y, at, each.spacing);
    return index === null ? null : lower_bound(plot.data[0] as number[], each.x[index] as number);
  };
}

/** Zooms to what was selected in a plot: in time together with the other plots, upwards this panel alone. */
function zoom_selection(plot: uPlot, group: ZoomGroup, view: PanelView): void {
  const { left, top, width, height } = plot.select;
  // The selection shows in all linked plots; only the one under the pointer zooms.
  if (group.grasped === plot && width > 4 && height > 4) {
    const { clientWidth, clientHeight } = plot.over;
    if (height < clientHeight - 1) view.y = [plot.posToVal(top + height, 'y'), plot.posToVal(top, 'y')];
    if (width < clientWidth - 1) group.zoom(plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x'));
    else group.refresh(plot);
  }
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
}

/** A panel on the page. */
interface DrawnPanel {
  drawn: Drawn[];
  view: PanelView;
  ordinate: Ordinate;
  visible: () => Drawn[];
  /** Whether the user wants the range of all lines, those that flatten the others too. */
  full_range: () => boolean;
  /** Says in the legend which lines leave the panel. */
  mark: (off_scale: Set<Drawn>) => void;
  /** Shows the values at an abscissa; null: none. */
  read: (at: number | null) => void;
}

function panel_scales({ group }: Shared, drawing: DrawnPanel): uPlot.Scales {
  return {
    x: { time: false, range: (_plot, min, max) => (min === null || max === null ? group.full() : [min, max]), min: group.full()[0], max: group.full()[1] },
    y: {
      range: () => {
        drawing.ordinate = ordinate_of(drawing.visible(), ...group.window, drawing.full_range());
        return drawing.view.y ?? drawing.ordinate.range;
      },
    },
  };
}

function panel_hooks({ figure, group, windows }: Shared, drawing: DrawnPanel, first: boolean): uPlot.Hooks.Arrays {
  return {
    drawAxes: [
      (plot) => {
        if (windows) draw_breaks(plot, windows);
        draw_spans(plot, figure, first);
        for (const { band, look } of drawing.visible()) if (band) draw_band(plot, band, look.colour(palette()));
      },
    ],
    draw: [
      (plot) => {
        group.place(plot);
        for (const line of drawing.ordinate.off_scale) draw_beyond(plot, line);
        drawing.mark(drawing.ordinate.off_scale);
      },
    ],
    setSelect: [(plot) => zoom_selection(plot, group, drawing.view)],
    setCursor: [
      (plot) => {
        const left = plot.cursor.left ?? -1;
        drawing.read(left >= 0 ? plot.posToVal(left, 'x') : null);
      },
    ],
  };
}

function panel_options(shared: Shared, drawing: DrawnPanel, first: boolean, last: boolean): Omit<uPlot.Options, 'width' | 'height'> {
  const { figure, group, ordinates, windows } = shared;
  return {
    legend: { show: false },
    padding: [6, kRightPadding, last ? 0 : 4, 0],
    scales: panel_scales(shared, drawing),
    axes: [
      axis('x', { size: last ? 26 : 4, labels: last, ...(windows ? { ticks: (plot, low, high) => windows.ticks(low, high, plot.bbox.width / uPlot.pxRatio, 70) } : {}) }),
      axis('y', { size: ordinates.size }),
    ],
    series: [{}, ...drawing.drawn.map(series_options)],
    cursor: {
      y: false,
      points: { size: 6, width: 0 },
      dataIdx: marked_sample(drawing.drawn) as unknown as uPlot.Cursor.DataIdxRefiner,
      drag: { x: true, y: true, uni: kThinSelection, setScale: false },
      sync: { key: `time/${figure.axis}`, setSeries: false, scales: ['x', null] },
      bind: {
        dblclick: () => () => {
          group.reset();
          return null;
        },
      },
    },
    hooks: panel_hooks(shared, drawing, first),
  };
}

function draw_panel(shared: Shared, panel: Panel, first: boolean, last: boolean): HTMLElement {
  const { figure, group, shown, clock, windows } = shared;
  const drawn = drawn_lines(shared, panel);
  let plot: uPlot | null = null;
  const values = drawn.map(() => h('span', { class: 'value' }));
  const range = range_button(() => plot && group.refresh(plot));
  const entries = drawn.map((each, k) => legend_entry(each.line, each.look, each.line.style, each.band !== undefined, shown, values[k] as HTMLElement));
  const drawing: DrawnPanel = {
    drawn,
    view: { y: null },
    ordinate: { range: [0, 1], off_scale: new Set() },
    visible: () => drawn.filter(({ line }) => shown.shows(line.name, line.role)),
    full_range: () => range.pressed(),
    mark: (off_scale) => {
      entries.forEach((entry, k) => entry.mark(off_scale.has(drawn[k] as Drawn)));
      range.offer(off_scale.size > 0);
    },
    read: (at) => {
      const moment = at === null || !windows ? at : windows.moment(at);
      drawn.forEach((each, k) => {
        const seen = at !== null && each.x.length > 0 && shown.shows(each.line.name, each.line.role);
        (values[k] as HTMLElement).textContent = seen ? reading(each, at) : '';
      });
      clock.textContent = moment === null ? '' : `${figure.x.label} ${format_number(moment, 6)} ${figure.x.unit}`;
    },
  };
  shown.on_change(() => {
    plot?.batch(() => drawn.forEach(({ line }, k) => plot?.setSeries(k + 1, { show: shown.shows(line.name, line.role) })));
    drawing.read(null);
  });
  shared.pictures.push(() => ({ panel, drawn: drawing.visible(), y: drawing.view.y ?? drawing.ordinate.range }));
  const host = h('div', { class: 'plot' });
  queueMicrotask(() => {
    const options = panel_options(shared, drawing, first, last);
    const made = mount(host, () => panel.height + (last ? 22 : 0), (width, height) => new uPlot({ ...options, width, height }, table_of(drawn), host));
    plot = made;
    group.add(made, drawing.view);
    follow_touch(made);
    (host as HTMLElement & { uplot?: uPlot }).uplot = made;
  });
  return h(
    'div',
    { class: 'panel' },
    h('div', { class: 'panel-head' }, h('span', { class: 'panel-label' }, with_unit(panel.label, panel.unit)), range.element, h('ul', { class: 'legend' }, ...entries.map((each) => each.element))),
    host,
  );
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

/** A figure on the page, and how it looks now as a picture. */
export interface DrawnFigure {
  element: HTMLElement;
  picture: () => SVGSVGElement;
}

/** One row of panels over one abscissa. */
function draw_row(figure: TimeSeries, looks: Looks, shown: SeriesSwitch, windows: WindowAxis | null): DrawnFigure {
  const group = zoom_group(figure.axis);
  for (const x of figure.xs) if (x.length > 0) group.extend(x[0] as number, x[x.length - 1] as number);
  for (const span of figure.spans) group.extend(span.from, span.to);
  const clock = h('span', { class: 'clock' });
  const element = h('div', { class: figure.panels.length > 3 ? 'time-series tall' : 'time-series', 'data-axis': figure.axis });
  const ordinates = new OrdinateWidth((width) => element.style.setProperty('--ordinate', `${width}px`));
  const shared: Shared = { figure, looks, group, ordinates, shown, clock, windows, pictures: [] };
  element.append(
    ...figure.panels.map((panel, k) => draw_panel(shared, panel, k === 0, k === figure.panels.length - 1)),
    h('div', { class: 'abscissa' }, h('span', {}, with_unit(figure.x.label, figure.x.unit)), span_key(figure) ?? '', clock),
  );
  return { element, picture: () => time_series_picture(figure, shared.pictures.map((each) => each()), group.window, windows) };
}

/**
 * Panels above each other over one abscissa, with uncertainty bands, shaded spans, and zoom linked through the page. A
 * figure with windows shows these side by side.
 */
export function draw_time_series(given: TimeSeries): DrawnFigure {
  const figure = with_gaps(given);
  const looks = new Looks();
  const shown = new SeriesSwitch();
  if ((figure.windows ?? []).length === 0) return draw_row(figure, looks, shown, null);
  const rows = window_rows(figure).map((row) => draw_row(row.figure, looks, shown, row.axis));
  return { element: h('div', { class: 'windows' }, ...rows.map((row) => row.element)), picture: () => stacked(rows.map((row) => row.picture())) };
}
