import type { Block, Document, Fact, Section, Verdict } from './document';
import { h, icon } from './dom';
import { draw_interval_plot } from './plots/interval_plot';
import { draw_matrix } from './plots/matrix';
import { save_buttons } from './plots/save';
import { draw_scene } from './plots/scene';
import { draw_time_series, type DrawnFigure } from './plots/time_series';
import { draw_xy_plot } from './plots/xy_plot';
import { copy_button, draw_table } from './table';

const kVerdictIcon: Record<Verdict['level'], string> = {
  good: 'M5 12.5l4.5 4.5L19 7.5',
  caution: 'M12 7v6.5M12 17v.2',
  bad: 'M7 7l10 10M17 7L7 17',
};

export function draw_facts(facts: Fact[]): HTMLElement {
  return h('dl', { class: 'facts' }, ...facts.map((fact) => h('div', {}, h('dt', {}, fact.name), h('dd', {}, fact.value))));
}

export function draw_verdict(verdict: Verdict): HTMLElement {
  return h(
    'section',
    { class: `verdict ${verdict.level}`, 'aria-label': 'Verdict' },
    h('div', { class: 'seal' }, icon(kVerdictIcon[verdict.level])),
    h(
      'div',
      {},
      h('p', { class: 'word' }, verdict.word),
      h('h2', {}, verdict.headline),
      ...verdict.lines.map((line) => h('p', {}, line)),
    ),
  );
}

interface Captioned {
  title: string;
  caption: string;
  footnote?: string;
}

function figure(kind: string, block: Captioned, content: HTMLElement, tools?: HTMLElement): HTMLElement {
  const head = block.title === '' && !tools ? null : h('div', { class: 'figure-head' }, h('h3', {}, block.title), tools);
  const has_caption = block.caption !== '' || (block.footnote ?? '') !== '';
  const caption = has_caption
    ? h('figcaption', {}, block.caption, block.footnote ? h('span', { class: 'footnote' }, block.footnote) : null)
    : null;
  return h('figure', { class: kind, 'aria-label': block.title || undefined }, head, content, caption);
}

/** A figure that can be saved as a picture. */
function picture_figure(kind: string, block: Captioned, drawn: DrawnFigure): HTMLElement {
  return figure(kind, block, drawn.element, save_buttons(block.title, drawn.picture));
}

function draw_block(block: Block): HTMLElement {
  switch (block.kind) {
    case 'paragraph':
      return block.tone === 'plain' ? h('p', {}, block.text) : h('p', { class: `callout ${block.tone}` }, block.text);
    case 'list':
      return h('ul', { class: block.tone === 'plain' ? 'plain' : `callout ${block.tone}` }, ...block.items.map((item) => h('li', {}, item)));
    case 'facts':
      return draw_facts(block.facts);
    case 'table':
      return figure(block.rows.length > 16 ? 'table' : 'table short', block, draw_table(block), copy_button(block));
    case 'time_series':
      return picture_figure('series', block, draw_time_series(block));
    case 'xy':
      return picture_figure('xy-figure', block, draw_xy_plot(block));
    case 'intervals':
      return picture_figure('intervals-figure', block, draw_interval_plot(block));
    case 'matrix':
      return picture_figure('matrix-figure', block, draw_matrix(block));
    case 'scene':
      return picture_figure('scene-figure', block, draw_scene(block));
  }
}

/**
 * Blocks in their order; plots over a free abscissa that follow each other stand side by side where there is room, and
 * so do a scene and the time series after it.
 */
function draw_blocks(blocks: Block[]): HTMLElement[] {
  const elements: HTMLElement[] = [];
  let grid: HTMLElement | null = null;
  blocks.forEach((block, k) => {
    const element = draw_block(block);
    if (block.kind === 'time_series' && blocks[k - 1]?.kind === 'scene') {
      elements.push(h('div', { class: 'beside' }, elements.pop(), element));
      grid = null;
      return;
    }
    const beside = block.kind === 'xy' && (blocks[k - 1]?.kind === 'xy' || blocks[k + 1]?.kind === 'xy');
    if (!beside) {
      grid = null;
      elements.push(element);
      return;
    }
    if (!grid) elements.push((grid = h('div', { class: 'grid' })));
    grid.append(element);
  });
  return elements;
}

/** "2 tables, 1 figure": what a folded section holds. */
function summary_of(blocks: Block[]): string {
  const tables = blocks.filter((block) => block.kind === 'table').length;
  const figures = blocks.filter((block) => ['time_series', 'xy', 'intervals', 'matrix', 'scene'].includes(block.kind)).length;
  const counted = (count: number, word: string) => (count === 0 ? [] : [`${count} ${word}${count === 1 ? '' : 's'}`]);
  return [...counted(tables, 'table'), ...counted(figures, 'figure')].join(', ');
}

/** A section that folds: open at first unless the report folds it. */
export function draw_section(section: Section): HTMLElement {
  const summary = h('summary', {}, h('h2', {}, section.title), h('span', { class: 'inside' }, section.inside || summary_of(section.blocks)));
  return h('section', { id: section.id }, h('details', { class: 'section', open: !section.folded }, summary, ...draw_blocks(section.blocks)));
}

/** What an engineer of the field looks at first: figures side by side where there is room. */
export function draw_lead(blocks: Block[]): HTMLElement | null {
  return blocks.length === 0 ? null : h('section', { class: 'lead', 'aria-label': 'Measured and model' }, ...blocks.map(draw_block));
}

export function draw_contents(report: Document): HTMLElement {
  return h(
    'nav',
    { class: 'contents', 'aria-label': 'Contents' },
    h('ol', {}, ...report.sections.map((section) => h('li', {}, h('a', { href: `#${section.id}` }, section.title)))),
  );
}
