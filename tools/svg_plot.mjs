// Small plots as SVG: panels below each other, on white, readable at the width of a text column.
//   plot(panels): the text of an SVG file. A panel has a `kind`:
//     lines      over x: {x, y, name, style} each, style "line", "truth", "dots" or "band" (then y is the lower end, high the upper)
//     intervals  a row each: {label, value, low, high}; `truth` is a vertical line
//     bars       a row each: {label, value, note}
//   and texts: `title`, `xLabel`, `yLabel`. `equal` gives both axes of lines the same scale.
const width = 760, left = 70, right = 16;
const colours = ['#1f5fbf', '#c2570c', '#3f7d3a', '#7a4fa3'];
const grey = '#8a8f98', dark = '#22262b';

const escaped = (text) => String(text).replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');
const px = (value) => String(Math.round(value * 10) / 10);
const text = (x, y, content, more = '') => `<text x="${px(x)}" y="${px(y)}" ${more}>${escaped(content)}</text>`;
const line = (x1, y1, x2, y2, colour, more = '') =>
  `<line x1="${px(x1)}" y1="${px(y1)}" x2="${px(x2)}" y2="${px(y2)}" stroke="${colour}" ${more}/>`;

// Round numbers from `low` to `high`, about `count` of them, with as many decimals as they need.
function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const at = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) at.push(k * step);
  return at.map((value) => ({ value, label: (Math.abs(value) < 1e-12 ? 0 : value).toFixed(decimals).replace('-', '\u2212') }));
}

function extent(values) {
  const finite = values.filter(Number.isFinite);
  if (finite.length === 0) throw new Error('nothing to draw: no finite value');
  return [Math.min(...finite), Math.max(...finite)];
}
const widened = ([low, high], share = 0.06) => {
  const margin = share * (high - low || Math.abs(high) || 1);
  return [low - margin, high + margin];
};
const scale = ([low, high], from, to) => (value) => from + ((value - low) / (high - low)) * (to - from);

// What a panel's lines stand for, in a row above it.
function legend(series, top) {
  let x = left;
  let out = '';
  for (const s of series.filter((each) => each.name)) {
    if (s.style === 'band') out += `<rect x="${px(x)}" y="${px(top - 9)}" width="22" height="9" fill="${s.colour}" opacity="0.25"/>`;
    else if (s.style === 'dots') out += `<circle cx="${px(x + 11)}" cy="${px(top - 4)}" r="2.5" fill="${s.colour}"/>`;
    else out += line(x, top - 4, x + 22, top - 4, s.colour, s.style === 'truth' ? 'stroke-width="1.4" stroke-dasharray="5 3"' : 'stroke-width="2"');
    out += text(x + 28, top, s.name);
    x += 28 + 6.9 * s.name.length + 18;
  }
  return out;
}

function points(s, sx, sy) {
  const at = s.x.map((x, k) => `${px(sx(x))},${px(sy(s.y[k]))}`);
  if (s.style === 'band') {
    const back = s.x.map((x, k) => `${px(sx(x))},${px(sy(s.high[k]))}`).reverse();
    return `<polygon points="${at.concat(back).join(' ')}" fill="${s.colour}" opacity="0.25"/>`;
  }
  if (s.style === 'dots') return s.x.map((x, k) => `<circle cx="${px(sx(x))}" cy="${px(sy(s.y[k]))}" r="1.8" fill="${s.colour}"/>`).join('');
  const dashes = s.style === 'truth' ? 'stroke-width="1.4" stroke-dasharray="5 3"' : 'stroke-width="1.6"';
  return `<polyline points="${at.join(' ')}" fill="none" stroke="${s.colour}" stroke-linejoin="round" ${dashes}/>`;
}

function linesPanel(panel, top) {
  let next = 0;
  const series = panel.series.map((s) => ({ ...s, colour: s.style === 'truth' ? dark : (s.colour ?? colours[next++]) }));
  const xs = extent(series.flatMap((s) => s.x));
  let ys = widened(extent(series.flatMap((s) => s.y.concat(s.high ?? []))));
  let xRange = xs, plotRight = width - right, height = panel.height ?? 170;
  if (panel.equal) {
    xRange = widened(xs, 0.04);
    height = ((plotRight - left) * (ys[1] - ys[0])) / (xRange[1] - xRange[0]);
  }
  const low = top + (series.some((s) => s.name) ? 26 : 12), bottom = low + height;
  const sx = scale(xRange, left, plotRight), sy = scale(ys, bottom, low);
  let out = legend(series, top + 14);
  for (const t of ticks(...ys, 5)) out += line(left, sy(t.value), plotRight, sy(t.value), '#e3e6ea') + text(left - 8, sy(t.value) + 4, t.label, 'text-anchor="end"');
  for (const t of ticks(...xRange, 8)) out += line(sx(t.value), bottom, sx(t.value), bottom + 4, grey) + text(sx(t.value), bottom + 18, t.label, 'text-anchor="middle"');
  out += line(left, bottom, plotRight, bottom, grey);
  for (const s of series) out += points(s, sx, sy);
  out += `<text transform="translate(16 ${px((low + bottom) / 2)}) rotate(-90)" text-anchor="middle">${escaped(panel.yLabel)}</text>`;
  if (panel.xLabel) out += text((left + plotRight) / 2, bottom + 36, panel.xLabel, 'text-anchor="middle"');
  return { out, bottom: bottom + (panel.xLabel ? 48 : 28) };
}

function rowsPanel(panel, top) {
  const labelWidth = 16 + 7.9 * Math.max(...panel.rows.map((row) => row.label.length));
  const from = Math.max(left, labelWidth), to = width - right - 40, rowHeight = 20;
  const ends = panel.rows.flatMap((row) => [row.value, row.low ?? 0, row.high ?? row.value]);
  const range = panel.range ?? widened(extent(panel.truth === undefined ? ends : ends.concat(panel.truth)));
  const sx = scale(range, from, to), inside = (x) => Math.min(Math.max(x, range[0]), range[1]);
  const bottom = top + 12 + rowHeight * panel.rows.length;
  let out = '';
  for (const t of ticks(...range, 6)) out += line(sx(t.value), top + 6, sx(t.value), bottom, '#e3e6ea') + text(sx(t.value), bottom + 16, t.label, 'text-anchor="middle"');
  out += line(from, bottom, to, bottom, grey);
  if (panel.truth !== undefined) out += line(sx(panel.truth), top + 2, sx(panel.truth), bottom, dark, 'stroke-width="1.4" stroke-dasharray="5 3"');
  if (panel.kind === 'bars') out += line(sx(0), top + 6, sx(0), bottom, grey);
  panel.rows.forEach((row, k) => {
    const y = top + 12 + rowHeight * (k + 0.5), colour = row.faint ? grey : colours[0];
    out += text(from - 10, y + 4, row.label, 'text-anchor="end"');
    if (panel.kind === 'bars') {
      const [a, b] = [sx(Math.min(0, row.value)), sx(Math.max(0, row.value))];
      out += `<rect x="${px(a)}" y="${px(y - 6)}" width="${px(b - a)}" height="12" fill="${colour}"/>` + text(b + 6, y + 4, row.note);
    } else {
      out += line(sx(inside(row.low)), y, sx(inside(row.high)), y, colour, 'stroke-width="2"');
      for (const end of [row.low, row.high]) if (end === inside(end)) out += line(sx(end), y - 4, sx(end), y + 4, colour, 'stroke-width="2"');
      if (row.value === inside(row.value)) out += `<circle cx="${px(sx(row.value))}" cy="${px(y)}" r="4" fill="${colour}"/>`;
    }
  });
  out += text((from + to) / 2, bottom + 34, panel.xLabel, 'text-anchor="middle"');
  return { out, bottom: bottom + 46 };
}

export function plot(panels) {
  let top = 8, body = '';
  for (const panel of panels) {
    if (panel.title) body += text(left, (top += 16), panel.title, 'font-weight="600"');
    const { out, bottom } = panel.kind === 'lines' ? linesPanel(panel, top) : rowsPanel(panel, top);
    body += out;
    top = bottom;
  }
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${px(top)}" width="${width}" height="${px(top)}" ` +
    `font-family="Helvetica, Arial, sans-serif" font-size="13" fill="${dark}"><rect width="100%" height="100%" fill="#fff"/>${body}</svg>\n`;
}
