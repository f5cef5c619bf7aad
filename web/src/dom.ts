type Child = Node | string | null | undefined | false;

type Attributes = Record<string, string | number | boolean | undefined | ((event: Event) => void)>;

function fill(element: Element, attributes: Attributes, children: Child[]): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (typeof value === 'function') element.addEventListener(name, value);
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  // Strings become text nodes: whatever a log holds is shown, never interpreted.
  for (const child of children) if (child !== null && child !== undefined && child !== false) element.append(child);
}

/** An HTML element; a function among the attributes is an event listener. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  fill(element, attributes, children);
  return element;
}

/** An SVG element. */
export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  fill(element, attributes, children);
  return element;
}

/** An icon drawn in the current text colour: outlines on a 24 x 24 grid. */
export function icon(path: string): SVGSVGElement {
  return svg('svg', { viewBox: '0 0 24 24', class: 'icon', 'aria-hidden': 'true' }, svg('path', { d: path }));
}

/** A frame in which something wide scrolls sideways; its right edge is shaded while there is more. */
export function scroller(label: string, content: HTMLElement): HTMLElement {
  const inner = h('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': label }, content);
  const shell = h('div', { class: 'scroll-shell' }, inner);
  const update = () => shell.classList.toggle('more', inner.scrollLeft + inner.clientWidth < inner.scrollWidth - 2);
  inner.addEventListener('scroll', update, { passive: true });
  new ResizeObserver(update).observe(inner);
  return shell;
}
