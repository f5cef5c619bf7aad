import type { Samples, TimeSeries, Window } from '../document';
import { format_ticks, nice_ticks } from '../numbers';
import { lower_bound } from './gaps';
import type { Range } from './ordinate';

/** More windows in one row are slivers again; on a phone sooner. */
const kMostInRow = 6;
const kMostOnPhone = 2;
const kPhoneWidth = 640;
/** Room between neighbours, as a share of the row. */
const kBetween = 0.025;
/** The least share of a row that a window takes, in shares of the average. */
const kLeastShare = 0.5;

interface Placed extends Window {
  /** Where the window lies on the row's own abscissa. */
  begin: number;
  end: number;
}

/** Several windows of time beside one another: what lies between them takes no room. */
export class WindowAxis {
  constructor(readonly placed: Placed[]) {}

  private find(position: number): Placed | undefined {
    return this.placed.find((each) => position >= each.begin && position <= each.end);
  }

  /** The moment at a place of the row; null between windows. */
  moment(position: number): number | null {
    const found = this.find(position);
    return found ? found.from + ((position - found.begin) / (found.end - found.begin)) * (found.to - found.from) : null;
  }

  /** Ticks of every window in sight, about one per `spacing` of `width` pixels. */
  ticks(low: number, high: number, width: number, spacing: number): { positions: number[]; labels: string[] } {
    const positions: number[] = [];
    const labels: string[] = [];
    for (const each of this.placed) {
      const from = Math.max(low, each.begin);
      const to = Math.min(high, each.end);
      if (!(to > from)) continue;
      const scale = (each.to - each.from) / (each.end - each.begin);
      const time = (position: number) => each.from + (position - each.begin) * scale;
      const count = Math.max(1, (((to - from) / (high - low)) * width) / spacing);
      // No window without a time.
      let { ticks, step } = nice_ticks(time(from), time(to), count);
      for (let more = 2; ticks.length === 0 && more < 10; ++more) ({ ticks, step } = nice_ticks(time(from), time(to), more * count));
      const texts = format_ticks(ticks, step);
      ticks.forEach((tick, k) => {
        positions.push(each.begin + (tick - each.from) / scale);
        labels.push(texts[k] ?? '');
      });
    }
    return { positions, labels };
  }

  /** What lies between the windows. */
  breaks(): Range[] {
    return this.placed.slice(1).map((each, k) => [(this.placed[k] as Placed).end, each.begin]);
  }
}

function place(windows: Window[]): Placed[] {
  const lengths = windows.map((each) => each.to - each.from);
  const average = lengths.reduce((sum, length) => sum + length, 0) / lengths.length;
  const widths = lengths.map((length) => Math.max(length, kLeastShare * average));
  const between = kBetween * widths.reduce((sum, width) => sum + width, 0);
  let at = 0;
  return windows.map((each, k) => {
    const begin = at;
    const end = begin + (widths[k] as number);
    at = end + between;
    return { ...each, begin, end };
  });
}

/** What of a line lies in the windows, on the row's abscissa, with a break between windows. */
function cut(x: number[], columns: Samples[], placed: Placed[]): { x: number[]; columns: Samples[] } {
  const result = { x: [] as number[], columns: columns.map(() => [] as Samples) };
  placed.forEach((each, index) => {
    if (index > 0) {
      result.x.push(0.5 * ((placed[index - 1] as Placed).end + each.begin));
      result.columns.forEach((column) => column.push(null));
    }
    const last = lower_bound(x, each.to + 1e-9 * Math.max(1, Math.abs(each.to)));
    const scale = (each.end - each.begin) / (each.to - each.from);
    for (let k = lower_bound(x, each.from); k < last; ++k) {
      result.x.push(each.begin + ((x[k] as number) - each.from) * scale);
      columns.forEach((column, c) => (result.columns[c] as Samples).push(column[k] ?? null));
    }
  });
  return result;
}

/** A row of windows as a figure over the row's abscissa. */
function row_figure(figure: TimeSeries, placed: Placed[], key: string): TimeSeries {
  const xs: number[][] = [];
  const known = new Map<number, number>();
  const abscissa = (x: number): number => {
    const found = known.get(x);
    if (found !== undefined) return found;
    xs.push(cut(figure.xs[x] ?? [], [], placed).x);
    known.set(x, xs.length - 1);
    return xs.length - 1;
  };
  const values = (x: number, column: Samples) => cut(figure.xs[x] ?? [], [column], placed).columns[0] as Samples;
  return {
    ...figure,
    axis: key,
    spans: [],
    panels: figure.panels.map((panel) => ({
      ...panel,
      lines: panel.lines.map((line) => ({
        ...line,
        x: abscissa(line.x),
        y: values(line.x, line.y),
        ...(line.band ? { band: { x: abscissa(line.band.x), low: values(line.band.x, line.band.low), high: values(line.band.x, line.band.high) } } : {}),
      })),
    })),
    xs,
  };
}

let count = 0;

/** The rows in which a figure's windows stand side by side. */
export function window_rows(figure: TimeSeries): { figure: TimeSeries; axis: WindowAxis }[] {
  const windows = (figure.windows ?? []).filter((each) => each.to > each.from);
  const rows = Math.ceil(windows.length / (innerWidth <= kPhoneWidth ? kMostOnPhone : kMostInRow));
  const per_row = Math.ceil(windows.length / Math.max(1, rows));
  return Array.from({ length: rows }, (_, row) => {
    const placed = place(windows.slice(row * per_row, (row + 1) * per_row));
    return { figure: row_figure(figure, placed, `${figure.axis}/windows/${++count}`), axis: new WindowAxis(placed) };
  });
}
