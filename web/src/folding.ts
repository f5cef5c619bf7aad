import { h } from './dom';

function sections(): HTMLDetailsElement[] {
  return [...document.querySelectorAll<HTMLDetailsElement>('details.section')];
}

/** Opens the section that a link leads to, and goes there. */
function open_target(hash: string): void {
  const id = decodeURIComponent(hash.replace(/^#/, ''));
  const target = id === '' ? null : document.getElementById(id);
  if (!target) return;
  const inside = target.querySelector<HTMLDetailsElement>(':scope > details');
  if (inside) inside.open = true;
  for (let each = target.closest('details'); each; each = each.parentElement?.closest('details') ?? null) each.open = true;
  target.scrollIntoView();
}

/** A link opens its section: one of the table of contents, one from elsewhere, and the address of the page. */
export function follow_links(): void {
  document.addEventListener('click', (event) => {
    const link = event.target instanceof Element ? event.target.closest<HTMLAnchorElement>('a[href^="#"]') : null;
    // The same address again changes nothing, but its section may have been folded.
    if (link && link.hash === location.hash) open_target(link.hash);
  });
  addEventListener('hashchange', () => open_target(location.hash));
  if (location.hash !== '') open_target(location.hash);
}

/** Opens all sections, or folds them when all are open. */
export function expand_button(): HTMLElement {
  const all_open = () => sections().every((each) => each.open);
  const button = h('button', {
    type: 'button',
    class: 'quiet expand',
    id: 'expand-all',
    click: () => {
      const open = !all_open();
      for (const each of sections()) each.open = open;
    },
  }, 'Expand all');
  // "toggle" does not bubble.
  document.addEventListener('toggle', () => (button.textContent = all_open() ? 'Fold all' : 'Expand all'), true);
  return button;
}

/** Opens what is folded until the page has been printed; the function that folds it again. */
export function unfold_for_print(): () => void {
  const unfolded = [...document.querySelectorAll<HTMLDetailsElement>('details:not([open])')];
  for (const details of unfolded) details.open = true;
  return () => {
    for (const details of unfolded) details.open = false;
  };
}
