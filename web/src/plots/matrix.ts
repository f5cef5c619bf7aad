import type { Matrix } from '../document';
import { h, scroller } from '../dom';

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

/** A small matrix as a heat map: a table whose cells are coloured, so that it reads without colours too. */
export function draw_matrix(matrix: Matrix): HTMLElement {
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
      const rounded = value.toFixed(matrix.decimals);
      const text = (Number(rounded) === 0 ? rounded.replace('-', '') : rounded).replace('-', kMinus);
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
  return scroller(matrix.title, h('table', { class: 'matrix' }, head, body));
}
