import '../pixel_ratio';
import uPlot from 'uplot';
import { format_ticks } from '../numbers';
import { is_printing, on_theme_change, palette, type Palette } from '../theme';
import type { Role } from '../document';

export const kFont = '12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';

/** Width of the plots on paper: A4 and Letter between the margins of the print style sheet [CSS px]. */
const kPaperWidth = 680;
const kHalfPaperWidth = 328;

export interface LineLook {
  colour: (colours: Palette) => string;
  width: number;
  dash: number[];
}

/** Looks of the lines of one figure: equal names look equal in all of its panels. */
export class Looks {
  private readonly known = new Map<string, LineLook>();
  private estimates = 0;

  of(name: string, role: Role): LineLook {
    const key = `${role}/${name}`;
    const found = this.known.get(key);
    if (found) return found;
    const look = this.next(role);
    this.known.set(key, look);
    return look;
  }

  private next(role: Role): LineLook {
    if (role === 'measured') return { colour: (colours) => colours.measured, width: 1, dash: [] };
    if (role === 'reference') return { colour: (colours) => colours.reference, width: 1.4, dash: [6, 4] };
    const index = this.estimates++;
    // Colours come again after the last one: dotted then, so that no two lines look alike.
    const dotted = index >= palette().lines.length;
    return { colour: (colours) => colours.lines[index % colours.lines.length] ?? colours.ink, width: dotted ? 2 : 1.7, dash: dotted ? [2, 2.5] : [] };
  }
}

export function translucent(colour: string, percent: number): string {
  return `color-mix(in srgb, ${colour} ${percent}%, transparent)`;
}

interface Mounted {
  host: HTMLElement;
  plot: uPlot;
  height: (width: number) => number;
}

const mounted = new Set<Mounted>();

const observer = new ResizeObserver((entries) => {
  if (is_printing()) return;
  for (const entry of entries) for (const each of mounted) if (each.host === entry.target) fit(each);
});

function fit(each: Mounted): void {
  const width = is_printing()
    ? each.host.closest('.grid')
      ? kHalfPaperWidth
      : kPaperWidth
    : Math.floor(each.host.clientWidth);
  const height = each.height(width);
  if (width > 0 && (width !== each.plot.width || height !== each.plot.height)) each.plot.setSize({ width, height });
}

/** Puts a plot into `host` and keeps it as wide as that, in the colours of the theme. */
export function mount(host: HTMLElement, height: (width: number) => number, make: (width: number, height: number) => uPlot): uPlot {
  const width = Math.max(200, Math.floor(host.clientWidth));
  const each = { host, plot: make(width, height(width)), height };
  mounted.add(each);
  observer.observe(host);
  return each.plot;
}

export function fit_all(): void {
  for (const each of mounted) fit(each);
}

on_theme_change(() => {
  for (const each of mounted) each.plot.redraw(false, true);
});

/** Room beside the labels of an ordinate: tick, gap and a pixel for rounding [CSS px]. */
const kOrdinateMargin = 13;
const kLeastOrdinate = 34;

const measuring = document.createElement('canvas').getContext('2d');

export function text_width(text: string): number {
  if (!measuring) return 7 * text.length;
  measuring.font = kFont;
  return measuring.measureText(text).width;
}

/** The width of the ordinates of one figure: as wide as the longest label of its panels, which thus stay in line. */
export class OrdinateWidth {
  private readonly wanted = new Map<uPlot, number>();
  private shared = kLeastOrdinate;

  constructor(
    private readonly on_change: (width: number) => void,
    /** Never narrower again: for plots whose range depends on the width. */
    private readonly only_grows = false,
  ) {}

  get width(): number {
    return this.shared;
  }

  readonly size = (plot: uPlot, labels: string[] | null): number => {
    if (labels === null) return this.shared;
    const longest = labels.reduce((most, label) => Math.max(most, text_width(label ?? '')), 0);
    this.wanted.set(plot, Math.max(kLeastOrdinate, Math.ceil(longest) + kOrdinateMargin));
    const most = Math.max(...this.wanted.values(), this.only_grows ? this.shared : 0);
    if (most !== this.shared) {
      this.shared = most;
      // Later: a plot that is being laid out takes no other layout.
      queueMicrotask(() => {
        for (const other of this.wanted.keys()) if (other !== plot) other.redraw(true, true);
        this.on_change(this.shared);
      });
    }
    return this.shared;
  };
}

interface AxisOptions {
  size: uPlot.Axis['size'];
  labels?: boolean;
  ticks?: (plot: uPlot, low: number, high: number) => { positions: number[]; labels: string[] };
}

/** An axis in the page's style; `labels` false keeps grid lines only, `ticks` puts them where it likes. */
export function axis(side: 'x' | 'y', options: AxisOptions): uPlot.Axis {
  const labels = options.labels ?? true;
  const { ticks } = options;
  return {
    side: side === 'x' ? 2 : 3,
    size: options.size,
    gap: 6,
    space: (plot) => (side === 'y' ? (plot.height < 110 ? 18 : 30) : plot.width < 420 ? 48 : 70),
    font: kFont,
    stroke: () => palette().soft_ink,
    grid: { stroke: () => palette().grid, width: 1 },
    ticks: { show: labels, stroke: () => palette().grid, width: 1, size: 5 },
    ...(ticks ? { splits: (plot, _axis, low, high) => ticks(plot, low, high).positions } : {}),
    values: (plot, positions, _axis, _space, step) => {
      if (!labels) return positions.map(() => '');
      if (!ticks) return format_ticks(positions, step);
      const { min, max } = plot.scales.x ?? {};
      return ticks(plot, min ?? 0, max ?? 1).labels;
    },
  };
}

/** Runs `draw` clipped to the plotting area, in canvas pixels. */
export function clipped(plot: uPlot, draw: (context: CanvasRenderingContext2D) => void): void {
  const { ctx: context, bbox } = plot;
  context.save();
  context.beginPath();
  context.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  context.clip();
  draw(context);
  context.restore();
}

export { uPlot };
