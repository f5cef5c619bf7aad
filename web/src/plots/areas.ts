import type { XYPlot } from '../document';
import type { Range } from './ordinate';

/** Where an area is: its upper edge, and its lower one back, an end that is missing at `low` or `high`. */
export function area_outline(area: NonNullable<XYPlot['areas']>[number], [low, high]: Range): Range[] {
  const upper: Range[] = [];
  const lower: Range[] = [];
  area.x.forEach((x, k) => {
    if (x === null) return;
    upper.push([x, area.high[k] ?? high]);
    lower.unshift([x, area.low[k] ?? low]);
  });
  return [...upper, ...lower];
}
