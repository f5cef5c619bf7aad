import type { XYPlot, XYSeries } from '../document';
import { h } from '../dom';
import { format_number, with_unit } from '../numbers';
import { palette } from '../theme';
import { axis, clipped, Looks, mount, translucent, uPlot, y_axis_size, type LineLook } from './frame';
import { swatch } from './time_series';

type Range = [number, number];

/** Room around the plotting area [CSS px]. */
const kTopPadding = 8;
const kRightPadding = 12;
const kAbscissaSize = 26;

function span_of(values: (number | null)[][]): Range {
  let low = Infinity;
  let high = -Infinity;
  for (const series of values) {
    for (const value of series) {
      if (value === null) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low <= high ? [low, high] : [0, 1];
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

/** The point nearest to the pointer, within 24 px. */
function find_point(plot: uPlot, figure: XYPlot, left: number, top: number): { series: XYSeries; k: number } | null {
  let best: { series: XYSeries; k: number } | null = null;
  let distance = 24 * 24;
  for (const series of figure.series) {
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

/** Markers, lines and stems over a free abscissa. */
export function draw_xy_plot(figure: XYPlot): HTMLElement {
  const looks = new Looks();
  const look = figure.series.map((series) => looks.of(series.name, series.role));
  let x_range = span_of([...figure.series.map((each) => each.x), figure.guides.filter((each) => each.direction === 'vertical').map((each) => each.value)]);
  let y_range = span_of([...figure.series.map((each) => each.y), figure.guides.filter((each) => each.direction === 'horizontal').map((each) => each.value)]);
  if (figure.series.some((each) => each.style === 'stems')) y_range = [Math.min(0, y_range[0]), Math.max(0, y_range[1])];
  if (figure.equal_axes) x_range = y_range = [Math.min(x_range[0], y_range[0]), Math.max(x_range[1], y_range[1])];
  const x_full = padded(x_range, 0.04);
  const y_full = padded(y_range, 0.07);

  // One length of a unit for both axes: the range that has more room is made longer.
  const scaled = (plot_width: number, plot_height: number): [Range, Range] => {
    if (!figure.equal_scale) return [x_full, y_full];
    const width = Math.max(1, plot_width - y_axis_size(plot_width) - kRightPadding);
    const height = Math.max(1, plot_height - kAbscissaSize - kTopPadding);
    const unit = Math.max((x_full[1] - x_full[0]) / width, (y_full[1] - y_full[0]) / height);
    return [stretched(x_full, unit * width), stretched(y_full, unit * height)];
  };

  const readout = h('span', { class: 'clock' });
  const host = h('div', { class: 'plot' });
  queueMicrotask(() => {
    const plot = mount(host, () => figure.height, (width, height) =>
      new uPlot(
        {
          width,
          height,
          legend: { show: false },
          padding: [kTopPadding, kRightPadding, 0, 0],
          scales: {
            // The plot does not know its size yet when it asks for the first time.
            x: { time: false, range: (each) => scaled(each.width || width, each.height || height)[0] },
            y: { range: (each) => scaled(each.width || width, each.height || height)[1] },
          },
          axes: [axis('x', { size: kAbscissaSize }), axis('y', { size: y_axis_size(width) })],
          series: [{}, { stroke: 'transparent', points: { show: false } }],
          cursor: { drag: { x: false, y: false }, points: { show: false }, bind: { dblclick: () => () => null } },
          hooks: {
            draw: [
              (each) => {
                draw_guides(each, figure);
                figure.series.forEach((series, k) => draw_series(each, series, look[k] as LineLook));
              },
            ],
            setSize: [
              (each) => {
                if (!figure.equal_scale) return;
                // Later: a plot that is being laid out takes no scales.
                queueMicrotask(() => {
                  const [x, y] = scaled(each.width, each.height);
                  if (each.scales.x?.min === x[0] && each.scales.y?.min === y[0]) return;
                  each.batch(() => {
                    each.setScale('x', { min: x[0], max: x[1] });
                    each.setScale('y', { min: y[0], max: y[1] });
                  });
                });
              },
            ],
            setCursor: [
              (each) => {
                const { left = -1, top = -1 } = each.cursor;
                const found = left >= 0 ? find_point(each, figure, left, top) : null;
                readout.textContent = found ? `${found.series.name}: ${format_number(found.series.x[found.k])}, ${format_number(found.series.y[found.k])}` : '';
              },
            ],
          },
        },
        [x_full, y_full],
        host,
      ),
    );
    plot.over.style.touchAction = 'pan-y';
    (host as HTMLElement & { uplot?: uPlot }).uplot = plot;
  });
  return h(
    'div',
    { class: 'xy' },
    h(
      'div',
      { class: 'panel-head' },
      h('span', { class: 'panel-label' }, with_unit(figure.y.label, figure.y.unit)),
      h(
        'ul',
        { class: 'legend' },
        ...figure.series.map((series, k) =>
          h('li', {}, swatch(look[k] as LineLook, series.style === 'line' ? 'line' : 'markers', false), h('span', { class: 'name' }, series.name)),
        ),
      ),
    ),
    host,
    h('div', { class: 'abscissa' }, h('span', {}, with_unit(figure.x.label, figure.x.unit)), readout),
  );
}
