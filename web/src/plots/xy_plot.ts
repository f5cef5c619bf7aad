import type { XYPlot, XYSeries } from '../document';
import { h } from '../dom';
import { decade_ticks, format_number, with_unit } from '../numbers';
import { palette } from '../theme';
import { area_outline } from './areas';
import { axis, clipped, Looks, mount, OrdinateWidth, translucent, uPlot, type LineLook } from './frame';
import { legend_entry, range_button, SeriesSwitch } from './legend';
import { kept_range, stretching, union_of, type Range } from './ordinate';
import { xy_picture } from './picture';
import type { DrawnFigure } from './time_series';
import { add_zoomable, follow_touch, zoom_changed } from './zoom';

/** Room around the plotting area [CSS px]. */
const kTopPadding = 8;
const kRightPadding = 12;
const kAbscissaSize = 26;

/** A selection thinner than this in one direction zooms in the other only [CSS px]. */
const kThinSelection = 30;

function span_of(values: (number | null)[]): Range {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value === null) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

function padded([low, high]: Range, share: number): Range {
  const margin = high > low ? share * (high - low) : Math.max(1e-3, 0.05 * Math.abs(high));
  return [low - margin, high + margin];
}

/** The middle of a range with another length. */
function stretched([low, high]: Range, length: number): Range {
  const middle = 0.5 * (low + high);
  return [middle - 0.5 * length, middle + 0.5 * length];
}

function draw_series(plot: uPlot, series: XYSeries, look: LineLook): void {
  const colour = series.opacity < 1 ? translucent(look.colour(palette()), 100 * series.opacity) : look.colour(palette());
  const ratio = uPlot.pxRatio;
  const at = (k: number): Range | null => {
    const x = series.x[k];
    const y = series.y[k];
    if (x === null || x === undefined || y === null || y === undefined) return null;
    return [plot.valToPos(x, 'x', true), plot.valToPos(y, 'y', true)];
  };
  clipped(plot, (context) => {
    context.lineWidth = (series.width > 0 ? series.width : look.width) * ratio;
    context.lineCap = series.width > 2 ? 'round' : 'butt';
    context.lineJoin = series.width > 2 ? 'round' : 'miter';
    context.strokeStyle = colour;
    if (series.style === 'line') {
      context.setLineDash(look.dash.map((length) => length * ratio));
      context.beginPath();
      let pen_down = false;
      for (let k = 0; k < series.x.length; ++k) {
        const point = at(k);
        if (!point) pen_down = false;
        else if (pen_down) context.lineTo(...point);
        else {
          context.moveTo(...point);
          pen_down = true;
        }
      }
      context.stroke();
      return;
    }
    const crowded = series.x.length > 600;
    const radius = (series.width > 0 ? 0.5 * series.width : crowded ? 1.7 : 2.6) * ratio;
    context.fillStyle = crowded ? translucent(colour, 60) : colour;
    const zero = plot.valToPos(0, 'y', true);
    for (let k = 0; k < series.x.length; ++k) {
      const point = at(k);
      if (!point) continue;
      if (series.style === 'stems') {
        context.beginPath();
        context.moveTo(point[0], zero);
        context.lineTo(...point);
        context.stroke();
      }
      context.beginPath();
      context.arc(point[0], point[1], series.style === 'stems' ? 2 * ratio : radius, 0, 2 * Math.PI);
      context.fill();
    }
  });
}

function draw_guides(plot: uPlot, figure: XYPlot): void {
  const colours = palette();
  const ratio = uPlot.pxRatio;
  clipped(plot, (context) => {
    const { bbox } = plot;
    context.strokeStyle = colours.reference;
    context.fillStyle = colours.soft_ink;
    context.lineWidth = 1.2 * ratio;
    context.setLineDash([6 * ratio, 4 * ratio]);
    context.font = `${Math.round(10.5 * ratio)}px system-ui, sans-serif`;
    for (const guide of figure.guides) {
      context.beginPath();
      if (guide.direction === 'horizontal') {
        const y = plot.valToPos(guide.value, 'y', true);
        context.moveTo(bbox.left, y);
        context.lineTo(bbox.left + bbox.width, y);
        context.textAlign = 'right';
        context.textBaseline = 'bottom';
        context.fillText(guide.label, bbox.left + bbox.width - 4 * ratio, y - 2 * ratio);
      } else {
        const x = plot.valToPos(guide.value, 'x', true);
        context.moveTo(x, bbox.top);
        context.lineTo(x, bbox.top + bbox.height);
        context.textAlign = 'left';
        context.textBaseline = 'top';
        context.fillText(guide.label, x + 4 * ratio, bbox.top + 4 * ratio);
      }
      context.stroke();
    }
  });
}

function draw_areas(plot: uPlot, figure: XYPlot): void {
  const range: Range = [plot.scales.y?.min ?? 0, plot.scales.y?.max ?? 1];
  clipped(plot, (context) => {
    context.fillStyle = palette().spans.primary;
    for (const area of figure.areas ?? []) {
      context.beginPath();
      area_outline(area, range).forEach(([x, y], k) => (k === 0 ? context.moveTo : context.lineTo).call(context, plot.valToPos(x, 'x', true), plot.valToPos(y, 'y', true)));
      context.fill();
    }
  });
}

/** A plot of decades as one over logarithms. */
function over_logarithms(figure: XYPlot): XYPlot {
  const log = (x: number | null) => (x !== null && x > 0 ? Math.log10(x) : null);
  return {
    ...figure,
    series: figure.series.map((each) => ({ ...each, x: each.x.map(log) })),
    areas: (figure.areas ?? []).map((each) => ({ ...each, x: each.x.map(log) })),
    guides: figure.guides.flatMap((each) => (each.direction === 'horizontal' ? [each] : each.value > 0 ? [{ ...each, value: Math.log10(each.value) }] : [])),
  };
}

/** The point nearest to the pointer, within 24 px. */
function find_point(plot: uPlot, visible: XYSeries[], left: number, top: number): { series: XYSeries; k: number } | null {
  let best: { series: XYSeries; k: number } | null = null;
  let distance = 24 * 24;
  for (const series of visible) {
    for (let k = 0; k < series.x.length; ++k) {
      const x = series.x[k];
      const y = series.y[k];
      if (x === null || x === undefined || y === null || y === undefined) continue;
      const square = (plot.valToPos(x, 'x') - left) ** 2 + (plot.valToPos(y, 'y') - top) ** 2;
      if (square < distance) {
        distance = square;
        best = { series, k };
      }
    }
  }
  return best;
}

interface Full {
  x: Range;
  y: Range;
  off_scale: Set<XYSeries>;
}

/** The ranges that show everything but series that would flatten all others, unless `everything` is to be seen. */
function full_ranges(figure: XYPlot, visible: XYSeries[], everything: boolean): Full {
  const measured = visible.map((each) => each.role === 'measured');
  const none = visible.map(() => false);
  const xs = visible.map((each) => span_of(each.x));
  const ys = visible.map((each) => span_of(each.y));
  const wide = everything ? none : stretching(xs, measured);
  const tall = everything ? none : stretching(ys, measured);
  const leaves = none.map((_, k) => (wide[k] ?? false) || (tall[k] ?? false));
  const with_guides = (range: Range, direction: 'horizontal' | 'vertical'): Range => {
    const all = union_of([range, span_of(figure.guides.filter((each) => each.direction === direction).map((each) => each.value))]);
    return all[0] <= all[1] ? all : [0, 1];
  };
  let x = with_guides(kept_range(xs, leaves), 'vertical');
  let y = with_guides(kept_range(ys, leaves), 'horizontal');
  if (visible.some((each) => each.style === 'stems')) y = [Math.min(0, y[0]), Math.max(0, y[1])];
  if (figure.equal_axes) x = y = union_of([x, y]);
  return { x: padded(x, 0.04), y: padded(y, 0.07), off_scale: new Set(visible.filter((_, k) => leaves[k])) };
}

/** What is in sight. */
interface Window {
  x: Range;
  y: Range;
}

/** A plot on the page. */
interface Drawing {
  figure: XYPlot;
  look: Map<XYSeries, LineLook>;
  visible: () => XYSeries[];
  ordinates: OrdinateWidth;
  full: Full;
  zoomed: Window | null;
  plot: uPlot | null;
}

/** The scales of a plot of this size. One length of a unit for both axes: the range that has more room is made longer. */
function scales_of({ figure, ordinates, full, zoomed }: Drawing, plot_width: number, plot_height: number): [Range, Range] {
  const { x, y } = zoomed ?? full;
  if (!figure.equal_scale) return [x, y];
  const width = Math.max(1, plot_width - ordinates.width - kRightPadding);
  const height = Math.max(1, plot_height - kAbscissaSize - kTopPadding);
  const unit = Math.max((x[1] - x[0]) / width, (y[1] - y[0]) / height);
  return [stretched(x, unit * width), stretched(y, unit * height)];
}

/** Shows the scales, later: a plot that is being laid out takes none. */
function apply(drawing: Drawing): void {
  queueMicrotask(() => {
    const { plot } = drawing;
    if (!plot) return;
    const [x, y] = scales_of(drawing, plot.width, plot.height);
    if (plot.scales.x?.min === x[0] && plot.scales.x?.max === x[1] && plot.scales.y?.min === y[0] && plot.scales.y?.max === y[1]) return plot.redraw(false);
    plot.batch(() => {
      plot.setScale('x', { min: x[0], max: x[1] });
      plot.setScale('y', { min: y[0], max: y[1] });
    });
  });
}

function set_zoom(drawing: Drawing, to: Window | null): void {
  drawing.zoomed = to;
  apply(drawing);
  zoom_changed();
}

/** Zooms to what was selected. */
function zoom_selection(drawing: Drawing, plot: uPlot): void {
  const { left, top, width, height } = plot.select;
  if (width > 4 && height > 4) {
    set_zoom(drawing, {
      x: [plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x')],
      y: [plot.posToVal(top + height, 'y'), plot.posToVal(top, 'y')],
    });
  }
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
}

/** The point under the pointer in words. */
function reading(drawing: Drawing, plot: uPlot): string {
  const { left = -1, top = -1 } = plot.cursor;
  const found = left >= 0 ? find_point(plot, drawing.visible(), left, top) : null;
  if (!found) return '';
  const x = found.series.x[found.k] ?? NaN;
  return `${found.series.name}: ${format_number(drawing.figure.log_x ? 10 ** x : x)}, ${format_number(found.series.y[found.k])}`;
}

function plot_options(drawing: Drawing, readout: HTMLElement, width: number, height: number): uPlot.Options {
  return {
    width,
    height,
    legend: { show: false },
    padding: [kTopPadding, kRightPadding, 0, 0],
    scales: {
      // The plot does not know its size yet when it asks for the first time.
      x: { time: false, range: (plot) => scales_of(drawing, plot.width || width, plot.height || height)[0] },
      y: { range: (plot) => scales_of(drawing, plot.width || width, plot.height || height)[1] },
    },
    axes: [axis('x', { size: kAbscissaSize, ...(drawing.figure.log_x ? { ticks: (plot, low, high) => decade_ticks(low, high, plot.bbox.width / uPlot.pxRatio / 40) } : {}) }), axis('y', { size: drawing.ordinates.size })],
    series: [{}, { stroke: 'transparent', points: { show: false } }],
    cursor: {
      drag: { x: true, y: true, uni: kThinSelection, setScale: false },
      points: { show: false },
      bind: {
        dblclick: () => () => {
          set_zoom(drawing, null);
          return null;
        },
      },
    },
    hooks: {
      draw: [
        (plot) => {
          draw_areas(plot, drawing.figure);
          draw_guides(plot, drawing.figure);
          for (const series of drawing.visible()) draw_series(plot, series, drawing.look.get(series) as LineLook);
        },
      ],
      setSize: [() => apply(drawing)],
      setSelect: [(plot) => zoom_selection(drawing, plot)],
      setCursor: [(plot) => (readout.textContent = reading(drawing, plot))],
    },
  };
}

function key_of(series: XYSeries): string {
  return `${series.role}/${series.name}`;
}

/** The legend; series of one name are one entry: the stretches of a drive, say. */
function legend_entries({ figure, look }: Drawing, shown: SeriesSwitch) {
  const firsts = new Map([...figure.series].reverse().map((series) => [key_of(series), series]));
  return figure.series
    .filter((series) => firsts.get(key_of(series)) === series)
    .map((series) => ({ key: key_of(series), entry: legend_entry(series, look.get(series) as LineLook, series.style === 'line' ? 'line' : 'markers', false, shown) }));
}

function area_key({ areas }: XYPlot): HTMLElement[] {
  return [...new Set((areas ?? []).map((each) => each.name))].map((name) => h('li', {}, h('span', { class: 'patch primary', 'aria-hidden': 'true' }), h('span', { class: 'name' }, name)));
}

/** Markers, lines and stems over a free abscissa. */
export function draw_xy_plot(given: XYPlot): DrawnFigure {
  const figure = given.log_x ? over_logarithms(given) : given;
  const looks = new Looks();
  const shown = new SeriesSwitch();
  const visible = () => figure.series.filter((each) => shown.shows(each.name, each.role));
  const readout = h('span', { class: 'clock' });
  const host = h('div', { class: 'plot' });
  const element = h('div', { class: 'xy' });
  const ordinates = new OrdinateWidth((width) => {
    element.style.setProperty('--ordinate', `${width}px`);
    apply(drawing);
  }, true);
  const drawing: Drawing = {
    figure,
    look: new Map(figure.series.map((series) => [series, looks.of(series.name, series.role)])),
    visible,
    ordinates,
    full: full_ranges(figure, visible(), false),
    zoomed: null,
    plot: null,
  };
  const range = range_button(() => refresh());
  const entries = legend_entries(drawing, shown);
  const refresh = () => {
    drawing.full = full_ranges(figure, visible(), range.pressed());
    const gone = new Set([...drawing.full.off_scale].map(key_of));
    for (const { key, entry } of entries) entry.mark(gone.has(key));
    range.offer(gone.size > 0);
    apply(drawing);
  };
  add_zoomable({
    get is_zoomed() {
      return drawing.zoomed !== null;
    },
    reset: () => set_zoom(drawing, null),
  });
  shown.on_change(refresh);
  queueMicrotask(() => {
    const { full } = drawing;
    const made = mount(host, () => figure.height, (width, height) => new uPlot(plot_options(drawing, readout, width, height), [full.x, full.y], host));
    drawing.plot = made;
    follow_touch(made);
    (host as HTMLElement & { uplot?: uPlot }).uplot = made;
    refresh();
  });
  element.append(
    h('div', { class: 'panel-head' }, h('span', { class: 'panel-label' }, with_unit(figure.y.label, figure.y.unit)), range.element, h('ul', { class: 'legend' }, ...entries.map(({ entry }) => entry.element), ...area_key(figure))),
    host,
    h('div', { class: 'abscissa' }, h('span', {}, with_unit(figure.x.label, figure.x.unit)), readout),
  );
  const picture = () => {
    const { plot, full, look } = drawing;
    const [x, y] = plot ? scales_of(drawing, plot.width, plot.height) : [full.x, full.y];
    const shape = plot ? plot.bbox.height / Math.max(1, plot.bbox.width) : 0.5;
    return xy_picture(figure, visible().map((series) => ({ series, look: look.get(series) as LineLook })), x, y, shape);
  };
  return { element, picture };
}
