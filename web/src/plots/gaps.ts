import type { Samples, TimeSeries } from '../document';

/** Samples further apart than this many median spacings have a gap between them. */
const kGapSpacings = 10;
/** Fewer samples say nothing about a usual spacing. */
const kFewest = 8;

/** Index of the first abscissa not below `value`. */
export function lower_bound(x: number[], value: number): number {
  let low = 0;
  let high = x.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((x[middle] as number) < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The median distance of neighbours; 0 for fewer than two samples. */
export function median_spacing(x: number[]): number {
  const steps: number[] = [];
  for (let k = 1; k < x.length; ++k) steps.push((x[k] as number) - (x[k - 1] as number));
  steps.sort((a, b) => a - b);
  return steps[steps.length >> 1] ?? 0;
}

/** Indices before which samples are missing. */
function gap_positions(x: number[]): number[] {
  const limit = kGapSpacings * median_spacing(x);
  const found: number[] = [];
  if (x.length < kFewest || !(limit > 0)) return found;
  for (let k = 1; k < x.length; ++k) if ((x[k] as number) - (x[k - 1] as number) > limit) found.push(k);
  return found;
}

function with_inserted<T>(values: T[], at: number[], make: (k: number) => T): T[] {
  const result: T[] = [];
  let from = 0;
  for (const k of at) {
    for (; from < k; ++from) result.push(values[from] as T);
    result.push(make(k));
  }
  for (; from < values.length; ++from) result.push(values[from] as T);
  return result;
}

/** The figure with a missing sample wherever a recording paused: a line is not drawn, and not read, across a pause. */
export function with_gaps(figure: TimeSeries): TimeSeries {
  const gaps = figure.xs.map(gap_positions);
  if (gaps.every((each) => each.length === 0)) return figure;
  const broken = (values: Samples, x: number): Samples => with_inserted<number | null>(values, gaps[x] ?? [], () => null);
  return {
    ...figure,
    xs: figure.xs.map((x, i) => with_inserted(x, gaps[i] ?? [], (k) => 0.5 * ((x[k - 1] as number) + (x[k] as number)))),
    panels: figure.panels.map((panel) => ({
      ...panel,
      lines: panel.lines.map((line) => ({
        ...line,
        y: broken(line.y, line.x),
        ...(line.band ? { band: { x: line.band.x, low: broken(line.band.low, line.band.x), high: broken(line.band.high, line.band.x) } } : {}),
      })),
    })),
  };
}

/** The sample to be read at an abscissa; null in a gap, and before and after the data. */
export function sample_at(x: number[], y: Samples, at: number, spacing: number): number | null {
  const holds = (k: number) => k >= 0 && k < x.length && y[k] !== null && y[k] !== undefined;
  const after = lower_bound(x, at);
  if (x[after] === at) return holds(after) ? after : null;
  const before = after - 1;
  const to_before = holds(before) ? at - (x[before] as number) : Infinity;
  const to_after = holds(after) ? (x[after] as number) - at : Infinity;
  const nearest = to_before < to_after ? before : after;
  const distance = Math.min(to_before, to_after);
  if (Number.isFinite(to_before) && Number.isFinite(to_after)) return nearest;
  return distance <= spacing ? nearest : null;
}
