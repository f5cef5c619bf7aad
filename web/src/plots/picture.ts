import type { Panel, TimeSeries, XYPlot, XYSeries } from '../document';
import { svg } from '../dom';
import { decade_ticks, format_ticks, nice_ticks, with_unit } from '../numbers';
import { palette } from '../theme';
import { text_width, type LineLook } from './frame';
import { lower_bound } from './gaps';
import type { Drawn, Range } from './ordinate';
import type { WindowAxis } from './windows';
import { area_outline } from './areas';

const kWidth = 960;
const kMargin = 14;
const kHead = 24;
const kAbscissa = 24;
export const kPictureFont = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';

/** A plain colour and its opacity: drawing programs read neither color-mix nor alpha. */
function paint(colour: string): { colour: string; opacity: number } {
  const context = document.createElement('canvas').getContext('2d');
  if (!context) return { colour, opacity: 1 };
  context.fillStyle = colour;
  context.fillRect(0, 0, 1, 1);
  const [r = 0, g = 0, b = 0, a = 255] = context.getImageData(0, 0, 1, 1).data;
  return { colour: `rgb(${r},${g},${b})`, opacity: Math.round((a / 255) * 1000) / 1000 };
}

export function fill(colour: string): Record<string, string | number> {
  const plain = paint(colour);
  return { fill: plain.colour, 'fill-opacity': plain.opacity };
}

export function stroke(colour: string, width: number): Record<string, string | number> {
  const plain = paint(colour);
  return { stroke: plain.colour, 'stroke-opacity': plain.opacity, 'stroke-width': width, fill: 'none' };
}

/** An empty picture in the colours of the page. */
export function blank(width: number, height: number): SVGSVGElement {
  const picture = svg('svg', { width, height, viewBox: `0 0 ${width} ${height}`, 'font-family': kPictureFont, 'font-size': 12 });
  picture.append(svg('rect', { width, height, ...fill(palette().surface) }));
  return picture;
}

/** Pictures above each other. */
export function stacked(pictures: SVGSVGElement[]): SVGSVGElement {
  const size = (each: SVGSVGElement, side: string) => Number(each.getAttribute(side));
  const picture = blank(Math.max(...pictures.map((each) => size(each, 'width'))), pictures.reduce((sum, each) => sum + size(each, 'height'), 0));
  let top = 0;
  for (const each of pictures) {
    each.setAttribute('y', String(top));
    top += size(each, 'height');
    picture.append(each);
  }
  return picture;
}

interface Ticks {
  positions: number[];
  labels: string[];
}

function plain_ticks([low, high]: Range, length: number, spacing: number): Ticks {
  const { ticks, step } = nice_ticks(low, high, length / spacing);
  return { positions: ticks, labels: format_ticks(ticks, step) };
}

let clips = 0;

/** A plotting area within a picture: maps numbers to places and clips what is drawn. */
class Area {
  readonly inside: SVGGElement;

  constructor(
    private readonly picture: SVGSVGElement,
    readonly left: number,
    readonly top: number,
    readonly width: number,
    readonly height: number,
    private readonly x_range: Range,
    private readonly y_range: Range,
  ) {
    const id = `clip-${++clips}`;
    picture.append(svg('clipPath', { id }, svg('rect', { x: left, y: top, width, height })));
    this.inside = svg('g', { 'clip-path': `url(#${id})` });
  }

  x(value: number): number {
    return this.left + ((value - this.x_range[0]) / (this.x_range[1] - this.x_range[0])) * this.width;
  }

  y(value: number): number {
    return this.top + (1 - (value - this.y_range[0]) / (this.y_range[1] - this.y_range[0])) * this.height;
  }

  grid(across: Ticks, up: Ticks, with_labels: boolean): void {
    const { grid, soft_ink } = palette();
    across.positions.forEach((tick, k) => {
      const x = this.x(tick);
      this.picture.append(svg('line', { x1: x, x2: x, y1: this.top, y2: this.top + this.height, ...stroke(grid, 1) }));
      if (with_labels) this.picture.append(svg('text', { x, y: this.top + this.height + 16, 'text-anchor': 'middle', ...fill(soft_ink) }, across.labels[k]));
    });
    up.positions.forEach((tick, k) => {
      const y = this.y(tick);
      this.picture.append(svg('line', { x1: this.left, x2: this.left + this.width, y1: y, y2: y, ...stroke(grid, 1) }));
      this.picture.append(svg('text', { x: this.left - 8, y: y + 4, 'text-anchor': 'end', ...fill(soft_ink) }, up.labels[k]));
    });
    this.picture.append(this.inside);
  }

  /** The path of a line through the given points; a missing one interrupts it. */
  path(points: ([number, number] | null)[]): string {
    let d = '';
    let pen_down = false;
    for (const point of points) {
      if (!point) {
        pen_down = false;
        continue;
      }
      d += `${pen_down ? 'L' : 'M'}${this.x(point[0]).toFixed(2)} ${this.y(point[1]).toFixed(2)}`;
      pen_down = true;
    }
    return d;
  }
}

/** Label of an ordinate at the left, the key of the series at the right; their baseline at `y`. */
function head(picture: SVGSVGElement, label: string, series: { name: string; look: LineLook }[], y: number): void {
  const colours = palette();
  picture.append(svg('text', { x: kMargin, y, 'font-weight': 600, ...fill(colours.ink) }, label));
  let right = kWidth - kMargin;
  for (const { name, look } of [...series].reverse()) {
    right -= text_width(name);
    picture.append(svg('text', { x: right, y, ...fill(colours.soft_ink) }, name));
    picture.append(svg('line', { x1: right - 26, x2: right - 6, y1: y - 4, y2: y - 4, ...stroke(look.colour(colours), 2), 'stroke-dasharray': look.dash.join(' ') || 'none' }));
    right -= 40;
  }
}

function ordinate_room(ticks: Ticks[]): number {
  return kMargin + 14 + Math.max(...ticks.flatMap((each) => each.labels.map(text_width)), 20);
}

/** What a panel shows at the moment. */
export interface PanelPicture {
  panel: Panel;
  drawn: Drawn[];
  y: Range;
}

function draw_line(area: Area, { line, x, look }: Drawn, [from, to]: Range): void {
  const colour = look.colour(palette());
  const points: ([number, number] | null)[] = [];
  for (let k = Math.max(0, lower_bound(x, from) - 1); k < Math.min(x.length, lower_bound(x, to) + 1); ++k) {
    const value = line.y[k];
    points.push(value === null || value === undefined ? null : [x[k] as number, value]);
  }
  if (line.style === 'markers') {
    for (const point of points) if (point) area.inside.append(svg('circle', { cx: area.x(point[0]).toFixed(2), cy: area.y(point[1]).toFixed(2), r: 2.2, ...fill(colour) }));
  } else {
    area.inside.append(svg('path', { d: area.path(points), ...stroke(colour, look.width), 'stroke-dasharray': look.dash.join(' ') || 'none' }));
  }
}

function draw_band(area: Area, { band, look }: Drawn): void {
  if (!band) return;
  let upper: [number, number][] = [];
  let lower: [number, number][] = [];
  const flush = () => {
    if (upper.length > 1) area.inside.append(svg('path', { d: `${area.path([...upper, ...lower.reverse()])}Z`, ...fill(look.colour(palette())), 'fill-opacity': 0.24 }));
    upper = [];
    lower = [];
  };
  band.at.forEach((x, k) => {
    const low = band.low[k];
    const high = band.high[k];
    if (low === null || low === undefined || high === null || high === undefined) return flush();
    upper.push([x, high]);
    lower.push([x, low]);
  });
  flush();
}

/** The panels of a figure as they stand: what is zoomed away or switched off is not in the picture. */
export function time_series_picture(figure: TimeSeries, panels: PanelPicture[], window: Range, windows: WindowAxis | null): SVGSVGElement {
  const colours = palette();
  const up = panels.map(({ panel, y }) => plain_ticks(y, panel.height, 34));
  const left = ordinate_room(up);
  const width = kWidth - kMargin - left;
  const height = panels.reduce((sum, { panel }) => sum + kHead + panel.height + 6, 0) + kAbscissa + 2 * kMargin + 8;
  const picture = blank(kWidth, height);
  const across = windows ? windows.ticks(window[0], window[1], width, 70) : plain_ticks(window, width, 90);
  let top = kMargin;
  panels.forEach(({ panel, drawn, y }, k) => {
    head(picture, with_unit(panel.label, panel.unit), drawn.map(({ line, look }) => ({ name: line.name, look })), top + 12);
    const area = new Area(picture, left, top + kHead - 4, width, panel.height, window, y);
    area.grid(across, up[k] as Ticks, k === panels.length - 1);
    const shade = (from: number, to: number, colour: string) =>
      area.inside.append(svg('rect', { x: area.x(from), y: area.top, width: Math.max(0, area.x(to) - area.x(from)), height: area.height, ...fill(colour) }));
    for (const span of figure.spans) shade(span.from, span.to, colours.spans[span.tone]);
    for (const [from, to] of windows?.breaks() ?? []) shade(from, to, colours.grid);
    for (const each of drawn) draw_band(area, each);
    for (const each of drawn) draw_line(area, each, window);
    top += kHead + panel.height + 6;
  });
  picture.append(svg('text', { x: left, y: height - kMargin, ...fill(colours.soft_ink) }, with_unit(figure.x.label, figure.x.unit)));
  return picture;
}

function draw_xy_series(area: Area, series: XYSeries, look: LineLook): void {
  const colour = look.colour(palette());
  const width = series.width > 0 ? series.width : look.width;
  const points = series.x.map((x, k): [number, number] | null => {
    const y = series.y[k];
    return x === null || y === null || y === undefined ? null : [x, y];
  });
  if (series.style === 'line') {
    area.inside.append(svg('path', { d: area.path(points), ...stroke(colour, width), 'stroke-opacity': series.opacity, 'stroke-dasharray': look.dash.join(' ') || 'none' }));
    return;
  }
  const radius = series.style === 'stems' ? 2 : series.width > 0 ? 0.5 * series.width : points.length > 600 ? 1.7 : 2.6;
  for (const point of points) {
    if (!point) continue;
    const [x, y] = [area.x(point[0]).toFixed(2), area.y(point[1]).toFixed(2)];
    if (series.style === 'stems') area.inside.append(svg('line', { x1: x, x2: x, y1: area.y(0).toFixed(2), y2: y, ...stroke(colour, width) }));
    area.inside.append(svg('circle', { cx: x, cy: y, r: radius, ...fill(colour), 'fill-opacity': series.opacity * (points.length > 600 ? 0.6 : 1) }));
  }
}

/** A plot over a free abscissa as it stands; `shape` is the height of its plotting area over its width. */
export function xy_picture(figure: XYPlot, series: { series: XYSeries; look: LineLook }[], x: Range, y: Range, shape: number): SVGSVGElement {
  const colours = palette();
  const high = Math.min(900, Math.max(240, shape * (kWidth - 90)));
  const up = plain_ticks(y, high, 40);
  const left = ordinate_room([up]);
  const width = kWidth - kMargin - left;
  const picture = blank(kWidth, high + kHead + kAbscissa + 2 * kMargin + 8);
  const unique = new Map(series.map((each) => [each.series.name, { name: each.series.name, look: each.look }]));
  head(picture, with_unit(figure.y.label, figure.y.unit), [...unique.values()], kMargin + 12);
  const area = new Area(picture, left, kMargin + kHead - 4, width, high, x, y);
  area.grid(figure.log_x ? decade_ticks(...x, width / 60) : plain_ticks(x, width, 90), up, true);
  for (const each of figure.areas ?? []) {
    const points = area_outline(each, y).map(([px, py]) => `${area.x(px).toFixed(2)},${area.y(py).toFixed(2)}`);
    area.inside.append(svg('polygon', { points: points.join(' '), ...fill(colours.spans.primary) }));
  }
  for (const guide of figure.guides) {
    const level = guide.direction === 'horizontal';
    const [gx, gy] = [area.x(guide.value), area.y(guide.value)];
    area.inside.append(
      svg('line', { x1: level ? area.left : gx, x2: level ? area.left + width : gx, y1: level ? gy : area.top, y2: level ? gy : area.top + high, ...stroke(colours.reference, 1.2), 'stroke-dasharray': '6 4' }),
      svg('text', { x: level ? area.left + width - 4 : gx + 4, y: level ? gy - 4 : area.top + 14, 'text-anchor': level ? 'end' : 'start', ...fill(colours.soft_ink) }, guide.label),
    );
  }
  for (const each of series) draw_xy_series(area, each.series, each.look);
  picture.append(svg('text', { x: left, y: high + kHead + kAbscissa + kMargin + 8, ...fill(colours.soft_ink) }, with_unit(figure.x.label, figure.x.unit)));
  return picture;
}


