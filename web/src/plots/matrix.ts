import type { Matrix } from '../document';
import { h, scroller, svg } from '../dom';
import { palette } from '../theme';
import { text_width } from './frame';
import { blank, fill } from './picture';
import type { DrawnFigure } from './time_series';

const kMinus = '\u2212';

/** Share of the strongest colour, and which of the two. */
function shade(matrix: Matrix, value: number): { share: number; side: 'low' | 'high' } {
  const diverging = matrix.low < 0 && matrix.high > 0;
  if (!diverging) {
    const share = (value - matrix.low) / (matrix.high - matrix.low || 1);
    return { share: Math.min(1, Math.max(0, share)), side: 'high' };
  }
  return value < 0 ? { share: Math.min(1, value / matrix.low), side: 'low' } : { share: Math.min(1, value / matrix.high), side: 'high' };
}

function cell_text(matrix: Matrix, value: number): string {
  const rounded = value.toFixed(matrix.decimals);
  return (Number(rounded) === 0 ? rounded.replace('-', '') : rounded).replace('-', kMinus);
}

/** The heat map with its names, as a drawing. */
function matrix_picture(matrix: Matrix): SVGSVGElement {
  const style = getComputedStyle(document.documentElement);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  const colours = palette();
  const [cell, high] = [58, 30];
  const room = (names: string[]) => 24 + Math.max(...names.map(text_width), 0);
  const [left, top] = [room(matrix.rows), room(matrix.columns)];
  const picture = blank(left + matrix.columns.length * cell + 14, top + matrix.rows.length * high + 14);
  matrix.columns.forEach((name, j) => {
    const x = left + (j + 0.5) * cell + 4;
    picture.append(svg('text', { x, y: top - 6, transform: `rotate(-90 ${x} ${top - 6})`, ...fill(colours.soft_ink) }, name));
  });
  matrix.rows.forEach((name, i) => {
    const y = top + i * high;
    picture.append(svg('text', { x: left - 8, y: y + 19, 'text-anchor': 'end', ...fill(colours.soft_ink) }, name));
    matrix.columns.forEach((_, j) => {
      const value = matrix.values[i]?.[j] ?? null;
      const { share, side } = shade(matrix, value ?? 0);
      const heat = `color-mix(in srgb, ${colour(`--heat-${side}`)} calc(${share} * ${colour('--heat')}), ${colour('--muted-soft')})`;
      picture.append(
        svg('rect', { x: left + j * cell, y, width: cell - 2, height: high - 2, rx: 4, ...fill(heat) }),
        svg('text', { x: left + (j + 0.5) * cell, y: y + 19, 'text-anchor': 'middle', ...fill(colours.ink) }, value === null ? '–' : cell_text(matrix, value)),
      );
    });
  });
  return picture;
}

/** A small matrix as a heat map: a table whose cells are coloured, so that it reads without colours too. */
export function draw_matrix(matrix: Matrix): DrawnFigure {
  const head = h('thead', {}, h('tr', {}, h('td', {}), ...matrix.columns.map((name) => h('th', { scope: 'col' }, h('span', {}, name)))));
  const body = h('tbody');
  matrix.rows.forEach((name, i) => {
    const row = h('tr', {}, h('th', { scope: 'row' }, name));
    matrix.columns.forEach((column, j) => {
      const value = matrix.values[i]?.[j] ?? null;
      if (value === null) {
        row.append(h('td', { class: 'cell missing' }, '–'));
        return;
      }
      const { share, side } = shade(matrix, value);
      const text = cell_text(matrix, value);
      row.append(
        h(
          'td',
          { class: `cell ${side}`, style: `--share: ${share.toFixed(2)}`, title: `${name}, ${column}: ${text}` },
          text,
        ),
      );
    });
    body.append(row);
  });
  return { element: scroller(matrix.title, h('table', { class: 'matrix' }, head, body)), picture: () => matrix_picture(matrix) };
}
