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
    return { colour: (colours) => colours.lines[index % colours.lines.length] ?? colours.ink, width: 1.7, dash: [] };
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

/** Room for the labels of an ordinate: every pixel counts on a phone. */
export function y_axis_size(width: number): number {
  return width < 420 ? 44 : 54;
}

/** An axis in the page's style; `labels` false keeps grid lines only. */
export function axis(side: 'x' | 'y', options: { size: number; labels?: boolean }): uPlot.Axis {
  const labels = options.labels ?? true;
  return {
    side: side === 'x' ? 2 : 3,
    size: options.size,
    gap: 6,
    space: (plot) => (side === 'y' ? 30 : plot.width < 420 ? 48 : 70),
    font: kFont,
    stroke: () => palette().soft_ink,
    grid: { stroke: () => palette().grid, width: 1 },
    ticks: { show: labels, stroke: () => palette().grid, width: 1, size: 5 },
    values: (_plot, ticks, _axis, _space, step) => (labels ? format_ticks(ticks, step) : ticks.map(() => '')),
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
