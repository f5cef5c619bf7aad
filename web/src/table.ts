import type { Cell, Column, Table } from './document';
import { h, icon, scroller } from './dom';
import { with_minus } from './numbers';
import { badge, status_label, status_tone } from './status';

const kCopyIcon = 'M9 9h11v11H9zM5 15H4V4h11v1';

/** Characters of a sentence, which gets its share of the width beside columns of words. */
const kLongText = 60;

type Row = Table['rows'][number];

function sort_value(cell: Cell | undefined): number | string {
  if (cell?.v !== undefined && cell.v !== null) return cell.v;
  return cell?.t ?? (cell?.s === undefined ? '' : status_label(cell.s));
}

function compare(a: Cell | undefined, b: Cell | undefined): number {
  const left = sort_value(a);
  const right = sort_value(b);
  if (typeof left === 'number' && typeof right === 'number') return left - right;
  // Numbers before words, and what is missing last.
  if (typeof left === 'number') return -1;
  if (typeof right === 'number') return 1;
  if (left === '' || right === '') return left === right ? 0 : left === '' ? 1 : -1;
  return left.localeCompare(right, 'en', { numeric: true });
}

function draw_cell(cell: Cell, column: Column | undefined): HTMLElement {
  const text = cell.t === undefined ? undefined : with_minus(cell.t);
  const content = cell.s === undefined || cell.s === '' ? (text ?? '') : badge(cell.s, text);
  const long = (text?.length ?? 0) > kLongText ? ' long' : '';
  return h('td', { class: (column?.align ?? 'left') + long }, content);
}

function draw_row(table: Table, row: Row): HTMLTableRowElement {
  const element = h('tr', row.status === '' ? {} : { class: `tone-${status_tone(row.status)}` });
  row.cells.forEach((cell, k) => element.append(draw_cell(cell, table.columns[k])));
  return element;
}

/** The table for a spreadsheet: tabs, plain numbers with all their digits. */
function as_text(table: Table): string {
  const clean = (text: string) => text.replace(/[\t\r\n]+/g, ' ');
  const head = table.columns.map((column) => clean([column.group, column.name, column.unit && `[${column.unit}]`].filter(Boolean).join(' ')));
  const rows = table.rows.map((row) => row.cells.map((cell) => clean(cell.v === undefined || cell.v === null ? String(cell.t ?? cell.s ?? '') : String(cell.v))));
  return [head, ...rows].map((cells) => cells.join('\t')).join('\n');
}

async function copy(text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Some browsers deny the clipboard to files; the old way still works there.
    const area = h('textarea', { style: 'position: fixed; opacity: 0' });
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
}

export function copy_button(table: Table): HTMLElement {
  const label = h('span', {}, 'Copy');
  return h(
    'button',
    {
      type: 'button',
      class: 'quiet',
      title: 'Copy the table for a spreadsheet',
      click: () => {
        void copy(as_text(table)).then(() => {
          label.textContent = 'Copied';
          setTimeout(() => (label.textContent = 'Copy'), 1500);
        });
      },
    },
    icon(kCopyIcon),
    label,
  );
}

function group_row(columns: Column[]): HTMLTableRowElement | null {
  if (columns.every((column) => column.group === '')) return null;
  const row = h('tr', { class: 'groups' });
  for (let k = 0; k < columns.length; ) {
    const group = (columns[k] as Column).group;
    let end = k + 1;
    while (end < columns.length && (columns[end] as Column).group === group) ++end;
    row.append(group === '' ? h('td', { colspan: end - k }) : h('th', { colspan: end - k, scope: 'colgroup' }, group));
    k = end;
  }
  return row;
}

/** A table: numbers to the right, units in the head, a click on a head sorts (a third one restores the order). */
export function draw_table(table: Table): HTMLElement {
  const body = h('tbody');
  const rows = table.rows.map((row) => ({ row, element: draw_row(table, row) }));
  body.append(...rows.map((each) => each.element));

  let sorted = -1;
  let direction: 1 | -1 = 1;
  const heads = table.columns.map((column, k) => {
    const unit = column.unit === '' ? null : h('span', { class: 'unit' }, `[${column.unit}]`);
    const cell = h('th', { scope: 'col', class: column.align });
    if (!table.sortable || table.rows.length < 2) {
      cell.append(h('span', { class: 'label' }, column.name), unit ?? '');
      return cell;
    }
    cell.append(h('button', { type: 'button', class: 'sort', click: () => sort(k) }, h('span', { class: 'label' }, column.name), unit));
    return cell;
  });
  function sort(k: number): void {
    if (sorted !== k) [sorted, direction] = [k, 1];
    else if (direction === 1) direction = -1;
    else sorted = -1;
    const order = [...rows];
    if (sorted >= 0) order.sort((a, b) => direction * compare(a.row.cells[sorted], b.row.cells[sorted]));
    body.append(...order.map((each) => each.element));
    heads.forEach((head, j) => {
      if (j === sorted) head.setAttribute('aria-sort', direction === 1 ? 'ascending' : 'descending');
      else head.removeAttribute('aria-sort');
    });
  }

  const head = h('thead', {}, group_row(table.columns), h('tr', {}, ...heads));
  return scroller(table.title || 'Table', h('table', { class: 'data' }, head, body));
}
