const kMinus = '\u2212';

/** Text with true minus signs in front of its numbers. */
export function with_minus(text: string): string {
  return text.replace(/(^|[\s([])-(?=[\d.])/g, `$1${kMinus}`);
}

/** A number with `digits` significant digits and a true minus sign, for legends and labels. */
export function format_number(value: number | null | undefined, digits = 4): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  const text =
    exponent < -4 || exponent > 6
      ? value.toExponential(digits - 1).replace('e+', 'e')
      : value.toFixed(Math.max(0, digits - 1 - exponent));
  return text.replace(/-/g, kMinus);
}

/** Tick labels: as many decimals as the step between ticks needs, no more. */
export function format_ticks(ticks: number[], step: number): string[] {
  const largest = ticks.reduce((most, tick) => Math.max(most, Math.abs(tick)), 0);
  if (largest >= 1e6 || (largest > 0 && largest < 1e-4)) {
    const digits = Math.max(0, Math.ceil(Math.log10(largest / step)));
    return ticks.map((tick) => (tick === 0 ? '0' : tick.toExponential(Math.min(digits, 3)).replace('e+', 'e').replace(/-/g, kMinus)));
  }
  const decimals = Math.min(8, Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)));
  const extra = Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6 ? 1 : 0;
  return ticks.map((tick) => (Math.abs(tick) < step * 1e-6 ? 0 : tick).toFixed(decimals + extra).replace('-', kMinus));
}

/** "airspeed [m/s]"; without a unit the label alone. */
export function with_unit(label: string, unit: string): string {
  return unit === '' ? label : `${label} [${unit}]`;
}

/** Ticks at 1, 2 or 5 times a power of ten, about `count` of them, inside [low, high]. */
export function nice_ticks(low: number, high: number, count: number): { ticks: number[]; step: number } {
  const rough = (high - low) / Math.max(1, count);
  if (!(rough > 0)) return { ticks: [low], step: 1 };
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999) ?? 10);
  const ticks: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; ++k) ticks.push(k * step);
  return { ticks, step };
}

/** Ticks of an axis of decades, by their logarithms: the decades, and 2 and 5 between them where these are few. */
export function decade_ticks(low: number, high: number, count: number): { positions: number[]; labels: string[] } {
  const decades: number[] = [];
  const wide = Math.max(1, Math.ceil((high - low) / Math.max(1, count)));
  for (let k = Math.ceil(low - 1e-9); k <= high + 1e-9; k += wide) decades.push(k);
  const fine: number[] = [];
  for (let k = Math.floor(low); k <= high; ++k) for (const each of [1, 2, 5]) fine.push(k + Math.log10(each));
  const within = fine.filter((each) => each >= low - 1e-9 && each <= high + 1e-9);
  const positions = within.length <= Math.max(count, 3) ? within : decades;
  if (positions.length < 2) {
    const { ticks, step } = nice_ticks(10 ** low, 10 ** high, count);
    const above = ticks.filter((tick) => tick > 0);
    return { positions: above.map(Math.log10), labels: format_ticks(above, step) };
  }
  return { positions, labels: positions.map((each) => String(Number((10 ** each).toPrecision(3)))) };
}
