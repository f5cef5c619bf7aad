import './pixel_ratio';
import 'uplot/dist/uPlot.min.css';
import './style.css';
import type { Document } from './document';
import { draw_contents, draw_facts, draw_lead, draw_section, draw_verdict } from './blocks';
import { h, icon } from './dom';
import { expand_button, follow_links, unfold_for_print } from './folding';
import { fit_all } from './plots/frame';
import { any_zoomed, on_zoom_change, reset_zoom } from './plots/zoom';
import { on_theme_change, set_printing, theme, toggle_theme } from './theme';

const kSun = 'M12 8a4 4 0 1 0 0 8a4 4 0 1 0 0-8M12 2v2M12 20v2M2 12h2M20 12h2M4.9 4.9l1.4 1.4M17.7 17.7l1.4 1.4M4.9 19.1l1.4-1.4M17.7 6.3l1.4-1.4';
const kMoon = 'M20 14.5A8.5 8.5 0 1 1 9.5 4a6.6 6.6 0 0 0 10.5 10.5z';

function theme_button(): HTMLElement {
  const button = h('button', { type: 'button', class: 'theme', id: 'theme', click: toggle_theme });
  const update = () => {
    const other = theme() === 'dark' ? 'light' : 'dark';
    button.replaceChildren(icon(other === 'dark' ? kMoon : kSun));
    button.title = `Switch to ${other} colours`;
    button.setAttribute('aria-label', button.title);
  };
  on_theme_change(update);
  update();
  return button;
}

function zoom_button(): HTMLElement {
  const button = h('button', { type: 'button', class: 'reset-zoom', id: 'reset-zoom', hidden: true, click: reset_zoom }, 'Show everything');
  on_zoom_change(() => {
    button.hidden = !any_zoomed();
  });
  return button;
}

/** Marks in the table of contents where the reader is. */
function follow_reading(sections: HTMLElement[], contents: HTMLElement): void {
  const update = () => {
    let current = sections[0];
    for (const section of sections) if (section.getBoundingClientRect().top < innerHeight * 0.3) current = section;
    for (const link of contents.querySelectorAll('a')) {
      if (current && link.getAttribute('href') === `#${current.id}`) link.setAttribute('aria-current', 'true');
      else link.removeAttribute('aria-current');
    }
  };
  addEventListener('scroll', update, { passive: true });
  update();
}

/** On paper: light colours, the width of the page, everything unfolded. */
function follow_printing(): void {
  let fold = () => {};
  const begin = () => {
    fold = unfold_for_print();
    set_printing(true);
    fit_all();
  };
  const end = () => {
    fold();
    fold = () => {};
    set_printing(false);
    fit_all();
  };
  addEventListener('beforeprint', begin);
  addEventListener('afterprint', end);
}

function draw(report: Document, root: HTMLElement): void {
  const contents = draw_contents(report);
  const sections = report.sections.map(draw_section);
  root.replaceChildren(
    h('header', { class: 'top' }, h('span', { class: 'brand' }, 'Veridyn'), h('span', { class: 'where' }, report.title), expand_button(), theme_button()),
    h(
      'div',
      { class: 'page' },
      contents,
      h(
        'main',
        {},
        h('div', { class: 'title' }, h('h1', {}, report.title), report.subtitle === '' ? null : h('p', { class: 'subtitle' }, report.subtitle)),
        draw_verdict(report.verdict),
        draw_lead(report.lead),
        report.facts.length === 0 ? null : draw_facts(report.facts),
        ...sections,
        h('footer', {}, report.generator),
      ),
    ),
    zoom_button(),
  );
  root.classList.add('live');
  follow_reading(sections, contents);
  follow_printing();
  follow_links();
}

const source = document.getElementById('veridyn-document');
const root = document.getElementById('report');
if (source && root) draw(JSON.parse(source.textContent ?? '{}') as Document, root);
